#include "attitude/supply/filaments.h"

#include <cmath>

#include "attitude/disturbances/fields/current_loop.h"
#include "core/constants.h"
#include "core/errors.h"
#include "core/numerics/quadrature.h"

namespace photorque {
namespace {

// A point in the cylindrical coordinates of a filament.
struct FromFilament {
  double z = 0.0, rho = 0.0;
  Vec3 outward = Vec3::Zero();  // the part across the axis, not normalised: length rho
  double q = 0.0;               // square of the largest distance to the wire
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

// So near the axis that the limit is right to rounding.
bool on_axis(const FromFilament& seen, double radius_m) {
  return seen.rho < 1e-8 * radius_m;
}

constexpr double scale_T_m_A = vacuum_permeability_N_A2 / (2.0 * pi);

// The circle as points and tangents, of unit length round the whole circle.
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

// The mean of a periodic function over a turn, by the trapezoidal rule, whose error falls
// exponentially: nodes are doubled until the mean has settled. `size` is a norm.
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
    // The change is the error of half as many nodes, whose square the error now is of.
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
  // Of coils that couple fully; what is orders below it is right to as many digits less.
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

}  // namespace photorque
