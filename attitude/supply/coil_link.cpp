#include "attitude/supply/coil_link.h"

#include <cmath>
#include <complex>

#include "attitude/disturbances/fields/current_loop.h"
#include "core/constants.h"

namespace photorque {
namespace {

// Annealed copper at 20 °C: resistivity (International Annealed Copper Standard, IEC 60028) and
// density.
constexpr double copper_ohm_m = 1.7241e-8;
constexpr double copper_kg_m3 = 8960.0;
constexpr double strands_fill = 0.5;

double turn_radius_m(const SpiralCoil& coil, int turn) {
  if (coil.turns == 1) return 0.5 * (coil.inner_radius_m + coil.outer_radius_m);
  return coil.inner_radius_m +
         (coil.outer_radius_m - coil.inner_radius_m) * turn / (coil.turns - 1.0);
}

}  // namespace

double SpiralCoil::wire_length_m() const {
  return pi * (inner_radius_m + outer_radius_m) * turns;
}

double SpiralCoil::copper_mass_kg() const {
  return copper_kg_m3 * copper_area_m2 * wire_length_m();
}

std::vector<CircularFilament> turns_of(const SpiralCoil& coil, const Vec3& centre_m,
                                       const Vec3& normal) {
  std::vector<CircularFilament> all;
  all.reserve(static_cast<size_t>(coil.turns));
  for (int i = 0; i < coil.turns; ++i) all.push_back({centre_m, normal, turn_radius_m(coil, i)});
  return all;
}

double self_inductance_H(const SpiralCoil& coil) {
  const double wire_radius_m = std::sqrt(coil.copper_area_m2 / (pi * strands_fill));
  double sum_H = 0.0;
  for (int i = 0; i < coil.turns; ++i) {
    const double r = turn_radius_m(coil, i);
    sum_H += vacuum_permeability_N_A2 * r * (std::log(8.0 * r / wire_radius_m) - 1.75);
    for (int j = 0; j < i; ++j) {
      sum_H += 2.0 * coaxial_inductance_H(r, turn_radius_m(coil, j), 0.0);
    }
  }
  return sum_H;
}

double resistance_ohm(const SpiralCoil& coil) {
  return coil.ac_factor * copper_ohm_m * coil.wire_length_m() / coil.copper_area_m2;
}

double mutual_inductance_H(const std::vector<CircularFilament>& a,
                           const std::vector<CircularFilament>& b) {
  double sum_H = 0.0;
  for (const CircularFilament& one : a) {
    for (const CircularFilament& other : b) sum_H += mutual_inductance_H(one, other);
  }
  return sum_H;
}

FilamentForce coil_force(const std::vector<CircularFilament>& source,
                         const std::vector<CircularFilament>& target, const Vec3& about_m) {
  FilamentForce sum;
  for (const CircularFilament& one : source) {
    for (const CircularFilament& other : target) {
      const FilamentForce pair = filament_force(one, other, about_m);
      sum.force_N_A2 += pair.force_N_A2;
      sum.torque_N_m_A2 += pair.torque_N_m_A2;
    }
  }
  return sum;
}

namespace {

double coupling2(const CoilCircuit& circuit) {
  const double induced_ohm = circuit.angular_frequency_rad_s * circuit.mutual_H;
  return induced_ohm * induced_ohm / (circuit.resistance_1_ohm * circuit.resistance_2_ohm);
}

}  // namespace

double best_load_ohm(const CoilCircuit& circuit) {
  return circuit.resistance_2_ohm * std::sqrt(1.0 + coupling2(circuit));
}

double best_link_efficiency(const CoilCircuit& circuit) {
  const double x2 = coupling2(circuit), sum = 1.0 + std::sqrt(1.0 + x2);
  return x2 / (sum * sum);
}

// −jωM I₁ = (R₂ + R_L + jX) I₂. What the first coil takes is R₁ |I₁|²/2 and what the second does.
CoilCurrents currents_for(const CoilCircuit& circuit, double load_ohm, double power_W) {
  const std::complex<double> loop(circuit.resistance_2_ohm + load_ohm, circuit.reactance_2_ohm);
  const std::complex<double> induced(0.0, -circuit.angular_frequency_rad_s * circuit.mutual_H);
  CoilCurrents currents;
  currents.second_A = std::sqrt(2.0 * power_W / load_ohm);
  const std::complex<double> second = currents.second_A;
  const std::complex<double> first = loop * second / induced;
  currents.first_A = std::abs(first);
  currents.mean_product_A2 = 0.5 * std::real(first * std::conj(second));
  const double taken_W =
      0.5 * (circuit.resistance_1_ohm * std::norm(first) + loop.real() * std::norm(second));
  currents.efficiency = power_W / taken_W;
  return currents;
}

}  // namespace photorque
