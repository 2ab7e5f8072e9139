// Power through two resonant coils: inductances, the best efficiency, the currents it needs.
#pragma once

#include <vector>

#include "attitude/supply/filaments.h"

namespace photorque {

// A flat spiral of stranded wire, its turns as circles evenly between two radii.
struct SpiralCoil {
  double inner_radius_m = 0.05;
  double outer_radius_m = 0.06;
  int turns = 10;
  double copper_area_m2 = 1e-6;  // of the wire
  // Resistance over that of direct current, by skin and proximity; stranded wire: 1.1 to 2.
  double ac_factor = 1.3;
  double copper_mass_kg() const;
  double wire_length_m() const;
};

// Its turns at a place, with one normal.
std::vector<CircularFilament> turns_of(const SpiralCoil& coil, const Vec3& centre_m,
                                       const Vec3& normal);

// Sum over the pairs of turns, and of each turn with itself: μ₀ r (ln(8 r/a) − 7/4) for a wire of
// radius a with its current spread over the section (J. C. Maxwell, Treatise, art. 704; E. B. Rosa
// and F. W. Grover, Bull. Bur. Stand. 8 (1912) 1, eq. 58). Strands fill half of the section.
double self_inductance_H(const SpiralCoil& coil);
double resistance_ohm(const SpiralCoil& coil);

// Sums over all pairs of turns, per ampere squared in both coils.
double mutual_inductance_H(const std::vector<CircularFilament>& a,
                           const std::vector<CircularFilament>& b);
FilamentForce coil_force(const std::vector<CircularFilament>& source,
                         const std::vector<CircularFilament>& target, const Vec3& about_m);

// Two coils in series resonance with their capacitors at one frequency, a voltage in the first, a
// resistance in the second.
struct CoilCircuit {
  double angular_frequency_rad_s = 0.0;
  double mutual_H = 0.0;
  double resistance_1_ohm = 0.0, resistance_2_ohm = 0.0;
  // Left uncompensated in the second coil; 0 at resonance. Positive: inductive.
  double reactance_2_ohm = 0.0;
};

// The load at which the largest fraction of the power arrives at resonance, R₂ √(1 + x²), and that
// fraction, x²/(1 + √(1 + x²))², with x² = (ω M)²/(R₁ R₂) = k² Q₁ Q₂.
// Source: A. Kurs and others, Science 317 (2007) 83, in the form of K. Van Schuylenbergh and
// R. Puers, Inductive Powering (2009), sec. 4.2.
double best_load_ohm(const CoilCircuit& circuit);
double best_link_efficiency(const CoilCircuit& circuit);

// By Kirchhoff's laws, for a power in the load.
struct CoilCurrents {
  double first_A = 0.0, second_A = 0.0;  // amplitudes
  // Mean of the product of the currents: half the amplitudes' product times the cosine of the phase
  // between them. Zero at resonance, where they are a quarter of a period apart.
  double mean_product_A2 = 0.0;
  double efficiency = 0.0;
};
CoilCurrents currents_for(const CoilCircuit& circuit, double load_ohm, double power_W);

}  // namespace photorque
