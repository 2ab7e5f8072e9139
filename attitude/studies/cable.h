// A cable to the platform: stiffness, losses, weight.
#pragma once

namespace photorque {

// Two or more equal stranded wires side by side, free to slide.
struct PowerCable {
  double length_m = 0.5;  // free, from the platform to where it is fixed
  int wires = 2;
  int strands = 40;  // of copper, in each wire
  double strand_diameter_m = 5e-5;
  double insulation_diameter_m = 8e-4;  // outer, of one wire
  double insulation_modulus_Pa = 1e6;   // silicone rubber 1e6, PVC 1e7
};

// About a level axis, of a cable that is built in at both ends, one of which turns on its place: 4
// E I/L (Euler and Bernoulli); strands slide on each other, so that their stiffness adds.
double bending_stiffness_N_m_rad(const PowerCable& cable);
// About its own axis, of wires side by side: G J/L of each; the insulation does not change its
// volume (G = E/3), copper has Poisson's ratio 0.34.
double twisting_stiffness_N_m_rad(const PowerCable& cable);
double cable_mass_kg(const PowerCable& cable);
// There and back.
double loop_resistance_ohm(const PowerCable& cable);

}  // namespace photorque
