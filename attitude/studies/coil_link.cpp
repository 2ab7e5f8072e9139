#include "attitude/studies/coil_link.h"

#include <cmath>
#include <complex>

#include "attitude/disturbances/fields/coil_cage.h"
#include "core/constants.h"
#include "core/errors.h"
#include "core/numerics/quadrature.h"

namespace photorque {

namespace {

// A point in the cylindrical coordinates of a circular filament, with z along its axis.
struct FromFilament {
  double z = 0.0, rho = 0.0;
  Vec3 outward = Vec3::Zero();  // component perpendicular to the axis, of length rho
  double q = 0.0;               // square of the largest distance to the wire, m²
  EllipticIntegrals elliptic;
};

FromFilament seen_from(const CircularFilament& filament, const Vec3& at_m) {
  FromFilament seen;
  const Vec3 r_m = at_m - filament.centre_m;
  seen.z = r_m.dot(filament.normal);
  seen.outward = r_m - seen.z * filament.normal;
  seen.rho = seen.outward.norm();
  const double radius_m = filament.radius_m;
  seen.q = (radius_m + seen.rho) * (radius_m + seen.rho) + seen.z * seen.z;
  const double nearest2 = (radius_m - seen.rho) * (radius_m - seen.rho) + seen.z * seen.z;
  seen.elliptic = complete_elliptic(4.0 * radius_m * seen.rho / seen.q, nearest2 / seen.q);
  return seen;
}

// Whether the point is so close to the axis that the limit for rho → 0 is exact to rounding errors.
bool on_axis(const FromFilament& seen, double radius_m) {
  return seen.rho < 1e-8 * radius_m;
}

constexpr double scale_T_m_A = vacuum_permeability_N_A2 / (2.0 * pi);

// A point of a circle, and its derivative with respect to the angle (a tangent of length radius).
struct OnCircle {
  Vec3 point_m, tangent_m;  // d point / d angle
};

class Circle {
 public:
  explicit Circle(const CircularFilament& filament)
      : filament_(filament), u_(filament.normal.unitOrthogonal()), v_(filament.normal.cross(u_)) {}
  OnCircle at(double angle_rad) const {
    const double r = filament_.radius_m, c = std::cos(angle_rad), s = std::sin(angle_rad);
    return {filament_.centre_m + r * (c * u_ + s * v_), r * (c * v_ - s * u_)};
  }

 private:
  CircularFilament filament_;
  Vec3 u_, v_;
};

// The mean of a periodic function over one turn by the trapezoidal rule. The error of this rule
// decreases exponentially with the number of nodes. The number is doubled until the mean has
// converged. `size` is a norm of Value, and `scale` a typical size of the function.
template <class Value, class Function, class Size>
Value mean_over_turn(const Function& f, const Size& size, double scale) {
  constexpr int most = 1 << 15;
  constexpr double settled = 1e-14;
  int count = 16;
  Value sum = f(0.0);
  for (int i = 1; i < count; ++i) sum += f(2.0 * pi * i / count);
  for (;;) {
    Value between = f(pi / count);
    for (int i = 1; i < count; ++i) between += f(2.0 * pi * (i + 0.5) / count);
    const double change = size(Value(sum - between)) / count;
    sum += between;
    count *= 2;
    // The change estimates the error of the previous mean. Doubling the nodes of a rule with
    // exponential convergence squares the relative error.
    if (change <= 1e-7 * scale && change * change <= settled * scale * scale) return sum / count;
    if (count >= most) throw NumericalError("two coils touch");
  }
}

}  // namespace

Vec3 filament_field_T_A(const CircularFilament& filament, const Vec3& at_m) {
  const FromFilament seen = seen_from(filament, at_m);
  const double r = filament.radius_m, root = std::sqrt(seen.q);
  const double nearest2 = (r - seen.rho) * (r - seen.rho) + seen.z * seen.z;
  const double along = (seen.elliptic.first + (r * r - seen.rho * seen.rho - seen.z * seen.z) /
                                                  nearest2 * seen.elliptic.second) /
                       root;
  const double across_per_m = on_axis(seen, r)
                                  ? 1.5 * pi * r * r * seen.z / (seen.q * seen.q * root)
                                  : seen.z * seen.elliptic.radial / (seen.rho * seen.rho * root);
  return scale_T_m_A * (along * filament.normal + across_per_m * seen.outward);
}

Vec3 filament_potential_T_m_A(const CircularFilament& filament, const Vec3& at_m) {
  const FromFilament seen = seen_from(filament, at_m);
  const double r = filament.radius_m, root = std::sqrt(seen.q);
  const double per_m = on_axis(seen, r) ? 0.5 * pi * r * r / (seen.q * root)
                                        : root * seen.elliptic.potential / (seen.rho * seen.rho);
  return scale_T_m_A * per_m * filament.normal.cross(seen.outward);
}

double mutual_inductance_H(const CircularFilament& a, const CircularFilament& b) {
  const Circle circle(b);
  const auto circulation = [&](double angle_rad) {
    const OnCircle here = circle.at(angle_rad);
    return filament_potential_T_m_A(a, here.point_m).dot(here.tangent_m);
  };
  // The inductance of strongly coupled coils. If the coupling is much weaker, the result has
  // correspondingly fewer correct digits.
  const double distance_m = (a.centre_m - b.centre_m).norm() + a.radius_m + b.radius_m;
  const double scale = scale_T_m_A * a.radius_m * a.radius_m * b.radius_m * b.radius_m /
                       (distance_m * distance_m * distance_m);
  return 2.0 * pi *
         mean_over_turn<double>(
             circulation, [](double x) { return std::abs(x); }, scale);
}

double coaxial_inductance_H(double radius_a_m, double radius_b_m, double distance_m) {
  const double sum2 =
      (radius_a_m + radius_b_m) * (radius_a_m + radius_b_m) + distance_m * distance_m;
  const double difference2 =
      (radius_a_m - radius_b_m) * (radius_a_m - radius_b_m) + distance_m * distance_m;
  const EllipticIntegrals elliptic =
      complete_elliptic(4.0 * radius_a_m * radius_b_m / sum2, difference2 / sum2);
  return vacuum_permeability_N_A2 * std::sqrt(sum2) * elliptic.potential;
}

FilamentForce filament_force(const CircularFilament& source, const CircularFilament& target,
                             const Vec3& about_m) {
  using Six = Eigen::Matrix<double, 6, 1>;
  const Circle circle(target);
  const auto density = [&](double angle_rad) {
    const OnCircle here = circle.at(angle_rad);
    const Vec3 force = here.tangent_m.cross(filament_field_T_A(source, here.point_m));
    Six both;
    both << force, (here.point_m - about_m).cross(force) / target.radius_m;
    return both;
  };
  const double distance_m =
      (source.centre_m - target.centre_m).norm() + source.radius_m + target.radius_m;
  const double scale = scale_T_m_A * source.radius_m * source.radius_m * target.radius_m /
                       (distance_m * distance_m * distance_m);
  const Six mean = mean_over_turn<Six>(
      density, [](const Six& x) { return x.norm(); }, scale);
  return {2.0 * pi * mean.head<3>(), 2.0 * pi * target.radius_m * mean.tail<3>()};
}

namespace {

constexpr std::complex<double> imaginary(0.0, 1.0);

// cot z for Im z ≥ 0, without overflow.
std::complex<double> cotangent(std::complex<double> z) {
  const std::complex<double> turned = std::exp(2.0 * imaginary * z);
  return imaginary * (turned + 1.0) / (turned - 1.0);
}

}  // namespace

// α = −3/2 [1 − 3/x² + (3/x) cot x], x = (1 + i) a/δ. For small x the bracket is −x²/15 − 2 x⁴/315.
std::complex<double> sphere_polarisability(double radius_m, double conductivity_S_m,
                                           double angular_frequency_rad_s) {
  const double skin_m =
      std::sqrt(2.0 / (vacuum_permeability_N_A2 * conductivity_S_m * angular_frequency_rad_s));
  const std::complex<double> x = (1.0 + imaginary) * (radius_m / skin_m);
  const std::complex<double> x2 = x * x;
  constexpr double small = 1e-2;
  if (std::abs(x) < small) return 1.5 * x2 / 15.0 * (1.0 + 2.0 / 21.0 * x2);
  return -1.5 * (1.0 - 3.0 / x2 + 3.0 / x * cotangent(x));
}

double sphere_eddy_loss_W(double radius_m, double conductivity_S_m, double angular_frequency_rad_s,
                          double field_T) {
  const double volume_m3 = 4.0 / 3.0 * pi * radius_m * radius_m * radius_m;
  const double alpha =
      sphere_polarisability(radius_m, conductivity_S_m, angular_frequency_rad_s).imag();
  return 0.5 * angular_frequency_rad_s * volume_m3 * alpha * field_T * field_T /
         vacuum_permeability_N_A2;
}

namespace {

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
  return copper_density_kg_m3 * copper_area_m2 * wire_length_m();
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
  return coil.ac_factor * copper_resistivity_ohm_m * coil.wire_length_m() / coil.copper_area_m2;
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

// Kirchhoff's law of the second coil: −jωM I₁ = (R₂ + R_L + jX) I₂. The source supplies the losses
// R₁ |I₁|²/2 of the first coil and the power (R₂ + R_L) |I₂|²/2 of the second one.
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
