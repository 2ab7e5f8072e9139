// A cable to the platform: stiffness, resistance and mass.
#pragma once

namespace photorque {

// Two or more equal stranded wires side by side that slide freely on each other.
struct PowerCable {
  double length_m = 0.5;  // free length, between platform and fixed end
  int wires = 2;
  int strands = 40;  // of copper, in each wire
  double strand_diameter_m = 5e-5;
  double insulation_diameter_m = 8e-4;  // outer, of one wire
  double insulation_modulus_Pa = 1e6;   // silicone rubber 1e6, PVC 1e7
};

// Stiffness about a horizontal axis of a cable that is clamped at both ends, one of which rotates
// in place: 4 E I/L (Euler and Bernoulli). Strands slide on each other, so their stiffnesses add.
double bending_stiffness_N_m_rad(const PowerCable& cable);
// Stiffness about the axis of the cable, of wires side by side: the sum of G J/L. The insulation
// has a constant volume (G = E/3), copper a Poisson's ratio of 0.34.
double twisting_stiffness_N_m_rad(const PowerCable& cable);
double cable_mass_kg(const PowerCable& cable);
// Resistance of both directions.
double loop_resistance_ohm(const PowerCable& cable);

}  // namespace photorque
