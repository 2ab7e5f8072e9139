// Wireless power transfer between coils: fields of circular filaments, eddy currents, two resonant
// coils.
#pragma once

#include <complex>
#include <vector>

#include "core/transform.h"

namespace photorque {

// Circular current filaments anywhere in space: field, mutual inductance, force and torque.
// Complete elliptic integrals are used for one circle and a quadrature for the other.
//
// Source of the field and the vector potential: W. R. Smythe, Static and Dynamic Electricity, 3rd
// ed. (1968), sec. 7.10. The mutual inductance is the circulation of the potential. It is the
// single integral of S. Babic and others, "Mutual inductance calculation between circular filaments
// arbitrarily positioned in space: alternative to Grover's formula", IEEE Trans. Magn. 46 (2010)
// 3591. Coaxial circles have Maxwell's closed form (Treatise, art. 701). Thin wires in vacuum.

struct CircularFilament {
  Vec3 centre_m = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();  // unit; the current circulates by the right-hand rule
  double radius_m = 1.0;        // > 0
};

// Magnetic field and vector potential of 1 A in the filament, at a point outside the wire.
Vec3 filament_field_T_A(const CircularFilament& filament, const Vec3& at_m);
Vec3 filament_potential_T_m_A(const CircularFilament& filament, const Vec3& at_m);

// Mutual inductance of two filaments that do not touch. The relative error is about 1e-13 if their
// distance is above a hundredth of their radii. NumericalError if the quadrature does not converge.
double mutual_inductance_H(const CircularFilament& a, const CircularFilament& b);
// Maxwell's closed form: coaxial circles at an axial distance.
double coaxial_inductance_H(double radius_a_m, double radius_b_m, double distance_m);

// Force and torque that a current of 1 A in `source` exerts on a current of 1 A in `target`. The
// torque is about the point `about_m`.
struct FilamentForce {
  Vec3 force_N_A2 = Vec3::Zero();
  Vec3 torque_N_m_A2 = Vec3::Zero();
};
FilamentForce filament_force(const CircularFilament& source, const CircularFilament& target,
                             const Vec3& about_m);

// A conducting, non-magnetic sphere in an alternating field: the ball of an air bearing between
// coils.

// The polarisability α: the magnetic moment of the sphere is α V B/μ₀. It is −3/2 for a perfect
// conductor and 0 for an insulator. The time dependence is exp(−iωt), so that the imaginary part of
// α gives the loss.
// Source: L. D. Landau, E. M. Lifshitz, Electrodynamics of Continuous Media, § 59, in SI.
std::complex<double> sphere_polarisability(double radius_m, double conductivity_S_m,
                                           double angular_frequency_rad_s);

// Eddy current loss of the sphere in a uniform field of amplitude `field_T` [W].
double sphere_eddy_loss_W(double radius_m, double conductivity_S_m, double angular_frequency_rad_s,
                          double field_T);

// Two resonant coils: inductances, maximum link efficiency, currents.

// A flat spiral of stranded wire; its turns are circles at equal distances between two radii.
struct SpiralCoil {
  double inner_radius_m = 0.05;
  double outer_radius_m = 0.06;
  int turns = 10;
  double copper_area_m2 = 1e-6;  // cross-section of the copper in the wire
  // AC resistance divided by DC resistance (skin and proximity effect); stranded wire: 1.1 to 2.
  double ac_factor = 1.3;
  double copper_mass_kg() const;
  double wire_length_m() const;
};

// The turns of the coil as circles with this centre and normal.
std::vector<CircularFilament> turns_of(const SpiralCoil& coil, const Vec3& centre_m,
                                       const Vec3& normal);

// Inductance of the coil: the mutual inductances of all pairs of turns and the self-inductance of
// each turn, μ₀ r (ln(8 r/a) − 7/4), for a wire of radius a with a uniform current density (J. C.
// Maxwell, Treatise, art. 704; E. B. Rosa and F. W. Grover, Bull. Bur. Stand. 8 (1912) 1, eq. 58).
// Strands fill half of the cross-section.
double self_inductance_H(const SpiralCoil& coil);
double resistance_ohm(const SpiralCoil& coil);

// Mutual inductance and force of two coils, summed over all pairs of turns, for 1 A in each coil.
double mutual_inductance_H(const std::vector<CircularFilament>& a,
                           const std::vector<CircularFilament>& b);
FilamentForce coil_force(const std::vector<CircularFilament>& source,
                         const std::vector<CircularFilament>& target, const Vec3& about_m);

// Two coils, each in series resonance with a capacitor at the same frequency. A voltage source
// drives the first coil; a resistance loads the second.
struct CoilCircuit {
  double angular_frequency_rad_s = 0.0;
  double mutual_H = 0.0;
  double resistance_1_ohm = 0.0, resistance_2_ohm = 0.0;
  // Uncompensated reactance of the second coil; 0 at resonance. Positive: inductive.
  double reactance_2_ohm = 0.0;
};

// The load of maximum efficiency at resonance, R₂ √(1 + x²), and the maximum efficiency,
// x²/(1 + √(1 + x²))², with x² = (ω M)²/(R₁ R₂) = k² Q₁ Q₂.
// Source: A. Kurs and others, Science 317 (2007) 83, in the form of K. Van Schuylenbergh and
// R. Puers, Inductive Powering (2009), sec. 4.2.
double best_load_ohm(const CoilCircuit& circuit);
double best_link_efficiency(const CoilCircuit& circuit);

// Currents that deliver a given power to the load, by Kirchhoff's laws.
struct CoilCurrents {
  double first_A = 0.0, second_A = 0.0;  // amplitudes
  // Mean of the product of the currents: half the amplitudes' product times the cosine of the phase
  // between them. Zero at resonance, where they are a quarter of a period apart.
  double mean_product_A2 = 0.0;
  double efficiency = 0.0;
};
CoilCurrents currents_for(const CoilCircuit& circuit, double load_ohm, double power_W);

}  // namespace photorque
