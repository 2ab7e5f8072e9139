#include "raytrace/direct/disc_light.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/constants.h"
#include "core/numerics/quadrature.h"

namespace photorque {
namespace {

// ∫ sin²ω/u² dω from ω to π, with sin(ω/2) = `half_sine`, u² = R² + d² − 2Rd cos ω.
// Source: I. S. Gradshteyn, I. M. Ryzhik, Table of Integrals, 2.553 and 2.555.
double tail_integral(double radius_m, double distance_m, double half_sine) {
  const double a = radius_m * radius_m + distance_m * distance_m;
  const double b = 2.0 * radius_m * distance_m;
  const double half_turn = std::asin(half_sine), turn = 2.0 * half_turn;
  constexpr double flat = 0.05;  // the closed form cancels where u hardly changes
  if (b < flat * a) {
    return integrate(
        gauss_8,
        [&](double w) {
          const double sine = std::sin(w);
          return sine * sine / (a - b * std::cos(w));
        },
        turn, pi);
  }
  const double half_cosine = std::sqrt(1.0 - half_sine * half_sine);
  const double gap = std::abs(radius_m - distance_m), sum = radius_m + distance_m;
  return (a * (pi - turn) - 2.0 * b * half_sine * half_cosine -
          2.0 * gap * sum * std::atan2(gap * half_cosine, sum * half_sine)) /
         (b * b);
}

}  // namespace

DiscLight::DiscLight(const Emitter& emitter, UniformAperture aperture)
    : emitter_(emitter), aperture_(std::move(aperture)) {
  parallel_irradiance_W_m2_ = aperture_.exitance_W_m2;
  if (aperture_.edges_rad.back() > 0.0) {
    angles_.emplace(emitter, aperture_.edges_rad);
    parallel_irradiance_W_m2_ *= angles_->mean_cosine();
  }
}

bool DiscLight::parallel() const {
  return std::isinf(aperture_.radius_m);
}

bool DiscLight::lights_front(const Vec3& normal) const {
  const double tilt = std::acos(std::clamp(-normal.z(), -1.0, 1.0));
  return tilt + reach_rad() < 0.5 * pi;
}

double DiscLight::typical_W_m2(double height_m) const {
  const double foot_m = height_m * std::tan(std::min(half_flux_rad(), 1.4));
  const double area_m2 = pi * (radius_m() * radius_m() + foot_m * foot_m);
  return 0.5 * exitance_W_m2() * pi * radius_m() * radius_m() / area_m2;
}

double DiscLight::irradiance_W_m2(const Vec3& point_m, const Vec3& normal) const {
  if (parallel()) return -normal.z() * parallel_irradiance_W_m2_;
  if (!(point_m.z() > 0.0)) return 0.0;
  const double d = std::hypot(point_m.x(), point_m.y());
  const double away = d > 0.0 ? (normal.x() * point_m.x() + normal.y() * point_m.y()) / d : 0.0;
  const Eigen::Array2d factors = factors_W_m2(d, point_m.z());
  return -normal.z() * factors[0] - away * factors[1];
}

Eigen::Array2d DiscLight::factors_W_m2(double distance_m, double height_m) const {
  const double h = height_m, d = distance_m, radius = aperture_.radius_m;
  // Per du, over the exitance.
  const auto density = [&](double u, double half_arc, double sine_arc) -> Eigen::Array2d {
    const double distance2 = h * h + u * u, distance = std::sqrt(distance2);
    const double rise = u * u / (distance * (distance + h));
    const double ring = 2.0 * angles_->intensity_per_flux(rise) * u / (distance2 * distance);
    return {ring * h * half_arc, ring * u * sine_arc};
  };
  const auto whole_circle = [&](double u) { return density(u, pi, 0.0); };
  const double middle = std::max(radius, d), width = std::min(radius, d);
  const auto arc = [&](double psi) -> Eigen::Array2d {
    const double half_sine = std::sin(0.5 * psi);
    const double half_cosine = std::sqrt(std::max(0.0, 1.0 - half_sine * half_sine));
    const double sine = 2.0 * half_sine * half_cosine;
    const double u = middle - width + 2.0 * width * half_sine * half_sine;
    if (!(u > 0.0)) return Eigen::Array2d::Zero();
    // Half of α by its sine or cosine, neither of which cancels.
    const double part =
        std::min(1.0, d > radius ? radius * sine / std::sqrt(4.0 * u * d)
                                 : half_sine * std::sqrt((u + d + radius) / (2.0 * u)));
    const double half = std::asin(part);
    return width * sine *
           density(u, d > radius ? 2.0 * half : pi - 2.0 * half,
                   2.0 * part * std::sqrt(1.0 - part * part));
  };
  const auto turn = [&](double u) {
    return std::acos(std::clamp((middle - u) / width, -1.0, 1.0));
  };

  constexpr double relative = 2e-8;
  const double tolerance = relative * typical_W_m2(h) / aperture_.exitance_W_m2;
  Eigen::Array2d sum = Eigen::Array2d::Zero();
  double low = 0.0;
  for (const double slope : angles_->edge_slopes()) {
    const double from = low, to = std::min(h * slope, radius + d);
    low = to;
    const double whole = std::min(to, radius - d);
    if (whole > from) sum += integrate_adaptively(whole_circle, from, whole, tolerance).value;
    const double inner = std::max(from, std::abs(radius - d));
    if (to <= inner || d <= 0.0) continue;
    const bool all = d > radius && inner == d - radius && to == d + radius;
    sum += all ? integrate_half_turn(arc, tolerance).value
               : integrate_adaptively(arc, turn(inner), turn(to), tolerance).value;
  }
  return aperture_.exitance_W_m2 * sum;
}

Integral<double> DiscLight::mean_within_W_m2(double distance_m, double height_m,
                                             double tolerance_W_m2) const {
  const double radius = aperture_.radius_m, h = height_m;
  const double d = std::max(distance_m, 1e-7 * radius);  // M is even and smooth at the axis
  const double gap = std::abs(radius - d), product = 4.0 * radius * d;
  const double per_integral = 2.0 / pi * aperture_.exitance_W_m2 * radius * radius;  // 2Φ/π²
  const auto density = [&](double w) {
    const double half_sine = std::sin(0.5 * w), half_cosine2 = 1.0 - half_sine * half_sine;
    const double u2 = gap * gap + product * half_sine * half_sine;
    const double sine2 = 4.0 * half_sine * half_sine * half_cosine2;
    return angles_->flux_within(rise_at_slope(u2 / (h * h))) * sine2 / u2;
  };
  // ω where u is this.
  const auto half_sine_at = [&](double u) {
    return std::sqrt(std::clamp((u - gap) * (u + gap) / product, 0.0, 1.0));
  };
  Integral<double> sum{0.0, 0.0};
  double low = 0.0, low_turn = 0.0;
  for (const double slope : angles_->edge_slopes()) {
    const double half_sine = std::isfinite(slope) ? half_sine_at(h * slope) : 1.0;
    if (half_sine <= low) continue;
    const double turn = half_sine < 1.0 ? 2.0 * std::asin(half_sine) : pi;
    const double aim = tolerance_W_m2 / per_integral;
    const auto piece = low_turn == 0.0 && turn == pi
                           ? integrate_half_turn(density, aim)
                           : integrate_adaptively(density, low_turn, turn, aim);
    sum = {sum.value + piece.value, sum.error + piece.error};
    low = half_sine;
    low_turn = turn;
  }
  if (low < 1.0) sum.value += tail_integral(radius, d, low);
  return {per_integral * sum.value, per_integral * sum.error};
}

// Fractions of the way between two points at which the circle about the axis touches the rim of
// the light of an edge: d = |R ± h tan θ|; rising, in (0, 1).
std::vector<double> DiscLight::kinks_along(const Vec3& from_m, const Vec3& to_m) const {
  std::vector<double> kinks;
  if (angles_->fades_out()) return kinks;
  const Vec3 way = to_m - from_m;
  for (const double slope : angles_->edge_slopes()) {
    if (!std::isfinite(slope)) continue;
    for (const double side : {-slope, slope}) {
      const double start = radius_m() + side * from_m.z(), change = side * way.z();
      const double a = way.head<2>().squaredNorm() - change * change;
      const double b = from_m.head<2>().dot(way.head<2>()) - start * change;
      const double c = from_m.head<2>().squaredNorm() - start * start;
      const double discriminant = b * b - a * c;
      if (!(discriminant > 0.0)) continue;
      const double q = -(b + std::copysign(std::sqrt(discriminant), b));
      for (const double root : {q / a, c / q}) {
        if (root > 0.0 && root < 1.0) kinks.push_back(root);
      }
    }
  }
  std::sort(kinks.begin(), kinks.end());
  return kinks;
}

// ½ ∫ M (x dy − y dx) along a straight line.
Integral<double> DiscLight::along_edge_W(const Vec3& from_m, const Vec3& to_m,
                                         double tolerance_W) const {
  const double twice_area_m2 = from_m.x() * to_m.y() - from_m.y() * to_m.x();
  Integral<double> sum{0.0, 0.0};
  if (twice_area_m2 == 0.0) return sum;
  const double half = 0.5 * twice_area_m2, tolerance_W_m2 = 0.5 * tolerance_W / std::abs(half);
  double worst_W_m2 = 0.0;
  const auto mean_within = [&](double s) {
    const Vec3 at = from_m + s * (to_m - from_m);
    const auto mean = mean_within_W_m2(at.head<2>().norm(), at.z(), tolerance_W_m2);
    worst_W_m2 = std::max(worst_W_m2, mean.error);
    return mean.value;
  };
  std::vector<double> ends = kinks_along(from_m, to_m);
  ends.push_back(1.0);
  double low = 0.0;
  for (const double high : ends) {
    const double part = high - low;
    const auto piece =
        integrate_adaptively(mean_within, low, high, std::max(part, 1e-3) * tolerance_W_m2);
    sum = {sum.value + half * piece.value, sum.error + std::abs(half) * piece.error};
    low = high;
  }
  sum.error += std::abs(half) * worst_W_m2;
  return sum;
}

Integral<double> DiscLight::power_through_W(std::span<const Vec3> polygon_m,
                                            double tolerance_W) const {
  // Light is in front of the aperture's plane only.
  std::vector<Vec3> corners;
  for (size_t i = 0; i < polygon_m.size(); ++i) {
    const Vec3 &from = polygon_m[i], &to = polygon_m[(i + 1) % polygon_m.size()];
    if (from.z() >= lowest_m()) corners.push_back(from);
    if ((from.z() >= lowest_m()) != (to.z() >= lowest_m())) {
      corners.push_back(from + (lowest_m() - from.z()) / (to.z() - from.z()) * (to - from));
    }
  }
  Integral<double> sum{0.0, 0.0};
  double twice_area_m2 = 0.0;
  for (size_t i = 0; i < corners.size(); ++i) {
    const Vec3 &from = corners[i], &to = corners[(i + 1) % corners.size()];
    const auto side = along_edge_W(from, to, tolerance_W / static_cast<double>(corners.size()));
    sum = {sum.value + side.value, sum.error + side.error};
    twice_area_m2 += from.x() * to.y() - from.y() * to.x();
  }
  if (twice_area_m2 < 0.0) sum.value = -sum.value;
  return sum;
}

}  // namespace photorque
