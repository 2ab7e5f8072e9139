#include "raytrace/direct/disc_light.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/constants.h"
#include "core/numerics/quadrature.h"

namespace photorque {
namespace {

constexpr size_t segment_steps = 4096;

double rise_of(double angle_rad) {
  const double sine = std::sin(0.5 * angle_rad);
  return 2.0 * sine * sine;
}

double angle_of(double rise) {
  return 2.0 * std::asin(std::sqrt(std::clamp(0.5 * rise, 0.0, 1.0)));
}

}  // namespace

DiscLight::DiscLight(const Emitter& emitter, UniformAperture aperture)
    : emitter_(emitter), aperture_(std::move(aperture)) {
  if (aperture_.edges_rad.back() > 0.0) {
    tabulate();
    find_angles();
  } else {
    parallel_irradiance_W_m2_ = aperture_.exitance_W_m2;
  }
}

bool DiscLight::parallel() const {
  return std::isinf(aperture_.radius_m);
}

void DiscLight::tabulate() {
  constexpr double inside = 1.0 - 1e-14;  // a profile may end at the edge itself
  double low_rad = 0.0, flux = 0.0;
  for (const double high_rad : aperture_.edges_rad) {
    Segment segment{rise_of(low_rad), rise_of(high_rad), 0.0, {}};
    const double step = (segment.high - segment.low) / static_cast<double>(segment_steps);
    segment.per_step = 1.0 / step;
    for (size_t i = 0; i <= segment_steps; ++i) {
      const double angle = angle_of(segment.low + step * static_cast<double>(i));
      const double within = std::clamp(angle, low_rad * (2.0 - inside), high_rad * inside);
      segment.value.push_back(emitter_.relative_intensity(within));
    }
    for (size_t i = 0; i < segment_steps; i += 2) {  // Simpson
      flux += 2.0 * pi * step / 3.0 *
              (segment.value[i] + 4.0 * segment.value[i + 1] + segment.value[i + 2]);
    }
    segments_.push_back(std::move(segment));
    low_rad = high_rad;
  }
  double jump = segments_.back().value.back();
  for (size_t i = 0; i + 1 < segments_.size(); ++i) {
    jump = std::max(jump, std::abs(segments_[i].value.back() - segments_[i + 1].value.front()));
  }
  fades_out_ = jump < 1e-9 * segments_.front().value.front();
  for (Segment& segment : segments_) {
    for (double& value : segment.value) value /= flux;
  }
}

// Sums the table from the edge inwards: what lies outside an angle is then small and exact.
void DiscLight::find_angles() {
  constexpr double negligible = 1e-9;
  double outside = 0.0, projected = 0.0;
  reach_rad_ = aperture_.edges_rad.back();
  for (size_t s = segments_.size(); s-- > 0;) {
    const Segment& segment = segments_[s];
    const double step = 1.0 / segment.per_step;
    for (size_t i = segment_steps; i-- > 0;) {
      const double ring = pi * step * (segment.value[i] + segment.value[i + 1]);
      const double rise = segment.low + step * static_cast<double>(i);
      projected += ring * (1.0 - rise - 0.5 * step);
      if (outside < negligible) reach_rad_ = angle_of(rise + step);
      if (outside < 0.5 && outside + ring >= 0.5) {
        half_flux_rad_ = angle_of(rise + step * (outside + ring - 0.5) / ring);
      }
      outside += ring;
    }
  }
  parallel_irradiance_W_m2_ = aperture_.exitance_W_m2 * projected / outside;
  half_flux_slope_ = std::tan(std::min(half_flux_rad_, 1.5));
  // The edge of all light is taken where hardly any is left.
  for (const double edge_rad : aperture_.edges_rad) {
    const double end_rad = std::min(edge_rad, reach_rad_);
    edge_slopes_.push_back(end_rad < 1.57 ? std::tan(end_rad)
                                          : std::numeric_limits<double>::infinity());
  }
}

bool DiscLight::lights_front(const Vec3& normal) const {
  const double tilt = std::acos(std::clamp(-normal.z(), -1.0, 1.0));
  return tilt + aperture_.edges_rad.back() < 0.5 * pi;
}

// Per du, over the exitance.
double DiscLight::integrand(double u_m, double height_m, double half_arc, double sine_arc,
                            double normal_axis, double normal_away) const {
  const double u2 = u_m * u_m;
  const double distance = std::sqrt(height_m * height_m + u2);
  const double cosine = height_m / distance, sine = u_m / distance;
  const double rise = sine * sine / (1.0 + cosine);
  const double facing = -normal_axis * cosine * half_arc - normal_away * sine * sine_arc;
  return 2.0 * facing * intensity_per_flux(rise) * u_m / (distance * distance);
}

// The mean over the disc by the rule of degree 7 with 12 points.
// Source: A. H. Stroud, Approximate Calculation of Multiple Integrals (1971), S2: 7-1.
double DiscLight::from_small_disc(const Vec3& point_m, const Vec3& normal) const {
  constexpr double a = 0.86602540378443864676, a_weight = 2.0 / 27.0;  // a² = 3/4
  constexpr double b = 0.3229149920674005;                             // b² = (27 − 3 √29)/104
  constexpr double b_weight = 0.12321068919101448;                     // (551 + 41 √29)/6264
  constexpr double c = 0.6441713103894645;                             // c² = (27 + 3 √29)/104
  constexpr double c_weight = 0.05271523673491145;                     // (551 − 41 √29)/6264
  constexpr double node[12][3] = {{a, 0, a_weight},  {-a, 0, a_weight},  {0, a, a_weight},
                                  {0, -a, a_weight}, {b, b, b_weight},   {b, -b, b_weight},
                                  {-b, b, b_weight}, {-b, -b, b_weight}, {c, c, c_weight},
                                  {c, -c, c_weight}, {-c, c, c_weight},  {-c, -c, c_weight}};
  const double z = point_m.z(), radius = aperture_.radius_m;
  double sum = 0.0;
  for (const auto& [node_x, node_y, weight] : node) {
    const double x = point_m.x() - radius * node_x, y = point_m.y() - radius * node_y;
    const double across2 = x * x + y * y, distance2 = across2 + z * z;
    const double distance = std::sqrt(distance2);
    const double facing = -(normal.x() * x + normal.y() * y + normal.z() * z);
    const double rise = across2 / (distance * (distance + z));
    sum += weight * intensity_per_flux(rise) * facing / (distance2 * distance);
  }
  return pi * radius * radius * aperture_.exitance_W_m2 * sum;
}

double DiscLight::irradiance_W_m2(const Vec3& point_m, const Vec3& normal) const {
  if (parallel()) return -normal.z() * parallel_irradiance_W_m2_;
  const double h = point_m.z();
  if (!(h > 0.0)) return 0.0;
  const double radius = aperture_.radius_m;
  const double half_flux = h * half_flux_slope_;
  const bool small = radius < std::min(0.6 * half_flux, 0.35 * h);
  if (fades_out_ && small) return from_small_disc(point_m, normal);
  const double d = std::hypot(point_m.x(), point_m.y());
  const double away = d > 0.0 ? (normal.x() * point_m.x() + normal.y() * point_m.y()) / d : 0.0;
  const auto rule_for = [&](double range, size_t least) {
    const double wanted = 3.0 + 6.0 * range / half_flux;
    return gauss_legendre(std::max(least, static_cast<size_t>(std::min(wanted, 64.0))));
  };

  double sum = 0.0, low = 0.0;
  for (const double slope : edge_slopes_) {
    const double from_m = low, high = std::min(h * slope, radius + d);
    low = high;
    // Whole circles on the disc.
    const double whole = std::min(high, radius - d);
    if (whole > from_m) {
      const double half = 0.5 * (whole - from_m);
      for (const auto& [x, w] : rule_for(whole - from_m, 6)) {
        sum += w * half * integrand(from_m + half * (1.0 + x), h, pi, 0.0, normal.z(), away);
      }
    }
    // Arcs.
    const double inner = std::max(from_m, std::abs(radius - d)), outer = std::min(high, radius + d);
    if (outer <= inner || d <= 0.0) continue;
    const double middle = std::max(radius, d), width = std::min(radius, d);
    const auto turn = [&](double u) {
      return std::acos(std::clamp((middle - u) / width, -1.0, 1.0));
    };
    const double from = turn(inner), half = 0.5 * (turn(outer) - from);
    for (const auto& [x, w] : rule_for(outer - inner, 10)) {
      const double psi = from + half * (1.0 + x);
      const double u = middle - width * std::cos(psi);
      const double cosine =
          std::clamp((u * u + d * d - radius * radius) / (2.0 * u * d), -1.0, 1.0);
      sum += w * half * width * std::sin(psi) *
             integrand(u, h, std::acos(cosine), std::sqrt(1.0 - cosine * cosine), normal.z(), away);
    }
  }
  return aperture_.exitance_W_m2 * sum;
}

}  // namespace photorque
