#include "raytrace/direct/irradiance_table.h"

#include <algorithm>
#include <cmath>

#include "core/numerics/chebyshev.h"
#include "core/parallel.h"

namespace photorque {
namespace {

constexpr double root_half = 0.70710678118654752440;

double factor_a(const DiscLight& light, double distance_m, double height_m) {
  return light.irradiance_W_m2({distance_m, 0.0, height_m}, -Vec3::UnitZ());
}
double factor_b(const DiscLight& light, double distance_m, double height_m) {
  return light.irradiance_W_m2({distance_m, 0.0, height_m}, -Vec3::UnitX());
}

}  // namespace

IrradianceTable::IrradianceTable(double low_m, double high_m, std::vector<Kink> kinks)
    : middle_m_(0.5 * (low_m + high_m)),
      half_range_m_(0.5 * (high_m - low_m)),
      degrees_(half_range_m_ > 1e-9 * middle_m_ ? max_degrees : 1),
      kinks_(std::move(kinks)),
      nodes_(2 * (kinks_.size() - 1) * (steps + 1)) {}

std::optional<IrradianceTable> IrradianceTable::make(const DiscLight& light, double low_m,
                                                     double high_m, int threads) {
  if (light.parallel() || !(low_m > 0.0) || light.edge_slopes().empty()) return std::nullopt;
  const double radius_m = light.radius_m(), last_slope = light.edge_slopes().back();
  if (!(last_slope < 10.0)) return std::nullopt;
  std::vector<Kink> kinks = {{0.0, 0.0}, {radius_m, last_slope}};
  if (!light.fades_out()) {
    for (const double slope : light.edge_slopes()) {
      const double sign = radius_m > slope * low_m ? 1.0 : -1.0;
      kinks.push_back({sign * radius_m, -sign * slope});
      if (slope < last_slope) kinks.push_back({radius_m, slope});
    }
  }
  const double middle_m = 0.5 * (low_m + high_m);
  std::sort(kinks.begin(), kinks.end(),
            [&](const Kink& a, const Kink& b) { return a.at(middle_m) < b.at(middle_m); });
  for (size_t k = 1; k < kinks.size(); ++k) {
    for (const double height_m : {low_m, high_m}) {
      const double min_m = 1e-6 * kinks.back().at(height_m);
      if (!(kinks[k].at(height_m) - kinks[k - 1].at(height_m) > min_m)) return std::nullopt;
    }
  }
  IrradianceTable table(low_m, high_m, std::move(kinks));
  table.fill(light, threads);
  if (!table.agrees_with(light)) return std::nullopt;
  return table;
}

double IrradianceTable::distance_m(size_t half, double place, double height_m) const {
  const double from = kinks_[half / 2].at(height_m), to = kinks_[half / 2 + 1].at(height_m);
  const double root = root_half * place / static_cast<double>(steps);
  return half % 2 == 0 ? from + root * root * (to - from) : to - root * root * (to - from);
}

void IrradianceTable::fill(const DiscLight& light, int threads) {
  parallel_for(nodes_.size(), threads, [&](size_t n) {
    Node& node = nodes_[n];
    node.setZero();
    for (size_t j = 0; j < degrees_; ++j) {
      const double x = chebyshev_point(degrees_, j);
      const double h = middle_m_ + half_range_m_ * x;
      const double d = distance_m(n / (steps + 1), static_cast<double>(n % (steps + 1)), h);
      const std::array<double, 2> value = {factor_a(light, d, h), factor_b(light, d, h)};
      for (size_t k = 0; k < degrees_; ++k) {
        const double weight = chebyshev_weight(degrees_, k, std::acos(x));
        for (size_t f = 0; f < 2; ++f) {
          node(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(f)) += weight * value[f];
        }
      }
    }
  });
}

bool IrradianceTable::agrees_with(const DiscLight& light) const {
  constexpr size_t stride = 7;  // intervals between two that are looked at
  double largest = 0.0, worst = 0.0;
  for (const double x : {-0.97, 0.31}) {
    const double h = middle_m_ + half_range_m_ * x;
    for (size_t half = 0; half < 2 * (kinks_.size() - 1); ++half) {
      for (size_t step = 0; step < steps; step += stride) {
        const double d = distance_m(half, static_cast<double>(step) + 0.5, h);
        const double a = factor_a(light, d, h), b = factor_b(light, d, h);
        largest = std::max(largest, a);
        worst = std::max({worst, std::abs(irradiance_W_m2({d, 0.0, h}, -Vec3::UnitZ()) - a),
                          std::abs(irradiance_W_m2({d, 0.0, h}, -Vec3::UnitX()) - b)});
      }
    }
  }
  return worst <= tolerance * largest;
}

double IrradianceTable::irradiance_W_m2(const Vec3& point_m, const Vec3& normal) const {
  const double h = point_m.z();
  const double d = std::sqrt(point_m.x() * point_m.x() + point_m.y() * point_m.y());
  if (d >= kinks_.back().at(h)) return 0.0;
  size_t piece = 0;
  while (d >= kinks_[piece + 1].at(h)) ++piece;
  const double from = kinks_[piece].at(h), to = kinks_[piece + 1].at(h);
  const double along = (d - from) / (to - from);
  const bool near = along < 0.5;
  const double place = std::sqrt(2.0 * (near ? along : 1.0 - along)) * static_cast<double>(steps);

  // The cubic through four neighbours.
  const auto first = std::min(static_cast<size_t>(std::max(place - 1.0, 0.0)), steps - 3);
  const double t = place - static_cast<double>(first) - 1.0;
  const double left = t + 1.0, right = t - 1.0, far = t - 2.0;
  const std::array<double, 4> weight = {-t * right * far / 6.0, left * right * far / 2.0,
                                        -left * t * far / 2.0, left * t * right / 6.0};
  const Node* node = &nodes_[(2 * piece + (near ? 0 : 1)) * (steps + 1) + first];
  const Node series =
      weight[0] * node[0] + weight[1] * node[1] + weight[2] * node[2] + weight[3] * node[3];
  const double x = degrees_ > 1 ? (h - middle_m_) / half_range_m_ : 0.0;
  std::array<double, 2> factor{};
  double term = 1.0, next = x;
  for (Eigen::Index k = 0; k < static_cast<Eigen::Index>(degrees_); ++k) {
    factor[0] += term * series(k, 0);
    factor[1] += term * series(k, 1);
    const double after = 2.0 * x * next - term;
    term = next;
    next = after;
  }
  const double away = d > 0.0 ? (normal.x() * point_m.x() + normal.y() * point_m.y()) / d : 0.0;
  return -normal.z() * factor[0] - away * factor[1];
}

}  // namespace photorque
