#include "raytrace/direct/disc_light.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/constants.h"
#include "core/numerics/divide_convex.h"
#include "core/numerics/quadrature.h"

namespace photorque {
namespace {

// ∫ sin²ω/u² dω from ω to π, with sin(ω/2) = `half_sine`, u² = R² + d² − 2Rd cos ω.
// Source: I. S. Gradshteyn, I. M. Ryzhik, Table of Integrals, 2.553 and 2.555.
double tail_integral(double radius_m, double distance_m, double half_sine) {
  const double a = radius_m * radius_m + distance_m * distance_m;
  const double b = 2.0 * radius_m * distance_m;
  const double half_turn = std::asin(half_sine), turn = 2.0 * half_turn;
  // Below this ratio u is nearly constant and the closed form loses digits.
  constexpr double flat = 0.05;
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

double DiscLight::typical_per_exitance(double height_m) const {
  const double foot_m = height_m * std::tan(std::min(half_flux_rad(), 1.4));
  const double area_m2 = pi * (radius_m() * radius_m() + foot_m * foot_m);
  return 0.5 * pi * radius_m() * radius_m() / area_m2;
}

double DiscLight::typical_W_m2(double height_m) const {
  return exitance_W_m2() * typical_per_exitance(height_m);
}

double DiscLight::irradiance_W_m2(const Vec3& point_m, const Vec3& normal) const {
  if (parallel()) return -normal.z() * parallel_irradiance_W_m2_;
  if (!(point_m.z() > 0.0)) return 0.0;
  const double d = std::hypot(point_m.x(), point_m.y());
  const double away = d > 0.0 ? (normal.x() * point_m.x() + normal.y() * point_m.y()) / d : 0.0;
  const Eigen::Array2d factors = factors_W_m2(d, point_m.z());
  return -normal.z() * factors[0] - away * factors[1];
}

// The arc on the aperture of the circle about a point's foot that the point sees under one angle.
struct DiscLight::Arc {
  double cosine, sine;         // of the angle θ from the axis
  double half_rad, half_sine;  // half of the arc's angle α about the foot; sin α
};

// Integral over the aperture of `density` (per solid angle and flux), times the exitance.
template <typename Density>
auto DiscLight::over_aperture(double distance_m, double height_m, const Density& density) const {
  using Value = std::decay_t<decltype(density(Arc{}))>;
  const double h = height_m, d = distance_m, radius = aperture_.radius_m;
  const auto ring = [&](double u, double half_rad, double half_sine) -> Value {
    const double distance2 = h * h + u * u, distance = std::sqrt(distance2);
    const double rise = u * u / (distance * (distance + h));
    const double weight = angles_->intensity_per_flux(rise) * u / distance2;
    return weight * density(Arc{h / distance, u / distance, half_rad, half_sine});
  };
  const auto whole_circle = [&](double u) { return ring(u, pi, 0.0); };
  const double middle = std::max(radius, d), width = std::min(radius, d);
  const auto arc = [&](double psi) -> Value {
    const double half_sine = std::sin(0.5 * psi);
    const double half_cosine = std::sqrt(std::max(0.0, 1.0 - half_sine * half_sine));
    const double sine = 2.0 * half_sine * half_cosine;
    const double u = middle - width + 2.0 * width * half_sine * half_sine;
    if (!(u > 0.0)) return Value::Zero();
    // Half of α from its sine or its cosine. Neither form loses digits by cancellation.
    const double part =
        std::min(1.0, d > radius ? radius * sine / std::sqrt(4.0 * u * d)
                                 : half_sine * std::sqrt((u + d + radius) / (2.0 * u)));
    const double half = std::asin(part);
    return width * sine *
           ring(u, d > radius ? 2.0 * half : pi - 2.0 * half,
                2.0 * part * std::sqrt(1.0 - part * part));
  };
  const auto turn = [&](double u) {
    return std::acos(std::clamp((middle - u) / width, -1.0, 1.0));
  };

  constexpr double relative = 2e-8;
  const double tolerance = relative * typical_per_exitance(h);
  Value sum = Value::Zero();
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
  return Value(aperture_.exitance_W_m2 * sum);
}

Eigen::Array2d DiscLight::factors_W_m2(double distance_m, double height_m) const {
  return over_aperture(distance_m, height_m, [](const Arc& arc) -> Eigen::Array2d {
    return {2.0 * arc.cosine * arc.half_rad, 2.0 * arc.sine * arc.half_sine};
  });
}

DiscLight::Flow DiscLight::flow_W_m2(double distance_m, double height_m) const {
  return over_aperture(distance_m, height_m, [](const Arc& arc) -> Flow {
    const double half_cosine_part =
        arc.half_sine * std::copysign(std::sqrt(std::max(0.0, 1.0 - arc.half_sine * arc.half_sine)),
                                      0.5 * pi - arc.half_rad);
    Flow all;
    all << 2.0 * arc.cosine * arc.half_rad, 2.0 * arc.sine * arc.half_sine,
        2.0 * arc.cosine * arc.cosine * arc.half_rad, 2.0 * arc.cosine * arc.sine * arc.half_sine,
        arc.sine * arc.sine * (arc.half_rad + half_cosine_part),
        arc.sine * arc.sine * (arc.half_rad - half_cosine_part);
    return all;
  });
}

ArrivingLight DiscLight::arriving(const Vec3& point_m, const Vec3& normal) const {
  if (parallel()) {
    const double square = angles_ ? angles_->mean_square_cosine() : 1.0;
    const double across = 0.5 * (1.0 - square);
    Flow flow;
    flow << parallel_irradiance_W_m2_, 0.0,
        Eigen::Array4d(square, 0.0, across, across) * aperture_.exitance_W_m2;
    return arriving_of(flow, Vec3::Zero(), normal);
  }
  if (!(point_m.z() > 0.0)) return {};
  const double d = std::hypot(point_m.x(), point_m.y());
  return arriving_of(flow_W_m2(d, point_m.z()), point_m, normal);
}

ArrivingLight DiscLight::arriving_of(const Flow& flow, const Vec3& point_m, const Vec3& normal) {
  // The momentum flow is a symmetric tensor. It has components along the axis, away from the axis
  // and around it.
  const double d = std::hypot(point_m.x(), point_m.y());
  const Vec3 axis = Vec3::UnitZ();
  const Vec3 away = d > 0.0 ? Vec3(point_m.x() / d, point_m.y() / d, 0.0) : Vec3(Vec3::UnitX());
  const Vec3 around = axis.cross(away);
  const double n_axis = -normal.z(), n_away = -normal.dot(away), n_around = -normal.dot(around);
  return {n_axis * flow[0] + n_away * flow[1], (n_axis * flow[2] + n_away * flow[3]) * axis +
                                                   (n_axis * flow[3] + n_away * flow[4]) * away +
                                                   n_around * flow[5] * around};
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
  // sin(ω/2) for a given u.
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

std::vector<double> DiscLight::hard_slopes() const {
  if (angles_->fades_out()) return {};
  std::vector<double> slopes = angles_->edge_slopes();
  std::erase_if(slopes, [](double slope) { return std::isinf(slope); });
  return slopes;
}

std::vector<double> DiscLight::all_slopes() const {
  std::vector<double> slopes = hard_slopes();
  const double half = std::tan(std::min(half_flux_rad(), 1.4));
  const double reach = std::tan(std::min(reach_rad(), 1.4));
  for (const double slope : {0.5 * half, half, std::sqrt(half * reach), reach}) {
    slopes.push_back(slope);
  }
  return slopes;
}

namespace {

// a s² + 2 b s + c = d² − (R ± h tan θ)² along a line; `slope` carries the sign.
struct Quadratic {
  double a, b, c;

  Quadratic(const Vec3& from_m, const Vec3& way_m, double radius_m, double slope) {
    const double start = radius_m + slope * from_m.z(), change = slope * way_m.z();
    a = way_m.head<2>().squaredNorm() - change * change;
    b = from_m.head<2>().dot(way_m.head<2>()) - start * change;
    c = from_m.head<2>().squaredNorm() - start * start;
  }
  Quadratic(double a_, double b_, double c_) : a(a_), b(b_), c(c_) {}
  double discriminant() const { return b * b - a * c; }
  // Appends the roots in (0, 1).
  void add_roots(std::vector<double>& roots) const {
    if (!(discriminant() > 0.0)) return;
    const double q = -(b + std::copysign(std::sqrt(discriminant()), b));
    for (const double root : {q / a, c / q}) {
      if (root > 0.0 && root < 1.0) roots.push_back(root);
    }
  }
};

}  // namespace

std::vector<double> DiscLight::kinks_at(std::span<const double> slopes, const Vec3& from_m,
                                        const Vec3& to_m) const {
  std::vector<double> kinks;
  for (const double slope : slopes) {
    for (const double side : {-slope, slope}) {
      Quadratic(from_m, to_m - from_m, radius_m(), side).add_roots(kinks);
    }
  }
  std::sort(kinks.begin(), kinks.end());
  return kinks;
}

std::vector<double> DiscLight::kinks_along(const Vec3& from_m, const Vec3& to_m) const {
  return kinks_at(all_slopes(), from_m, to_m);
}

std::vector<double> DiscLight::tangent_lines(const Vec3& corner_m, const Vec3& along_m,
                                             const Vec3& across_m) const {
  std::vector<double> lines;
  for (const double slope : all_slopes()) {
    for (const double side : {-slope, slope}) {
      // Two kinks on a line meet where the discriminant vanishes. It is quadratic in t.
      const auto discriminant = [&](double t) {
        return Quadratic(corner_m + t * across_m, along_m, radius_m(), side).discriminant();
      };
      const double first = discriminant(0.0), middle = discriminant(0.5), last = discriminant(1.0);
      const double square = 2.0 * (first - 2.0 * middle + last);
      Quadratic(square, 0.5 * (last - first - square), first).add_roots(lines);
    }
  }
  std::sort(lines.begin(), lines.end());
  return lines;
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
  std::vector<double> ends = kinks_at(hard_slopes(), from_m, to_m);
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
  // The light exists only in front of the aperture's plane, so the polygon is clipped there.
  std::vector<Vec3> corners;
  divide_convex(
      polygon_m, [&](const Vec3& at) { return at.z() - lowest_m(); },
      [&](const Vec3& at, double side) {
        if (side >= 0.0) corners.push_back(at);
      });
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
