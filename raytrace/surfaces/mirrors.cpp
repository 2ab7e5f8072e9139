#include "raytrace/surfaces/mirrors.h"

#include <cmath>

#include "core/constants.h"
#include "core/numerics/quadrature.h"
#include "raytrace/surfaces/cosine_table.h"
#include "raytrace/surfaces/ggx.h"

namespace photorque {
namespace {

class RoughMirror final : public Lobe {
 public:
  explicit RoughMirror(double alpha)
      : facets_{alpha}, once_([this](double cosine) {
          return facets_.moments(cosine, [](double) { return 1.0; });
        }) {
    tabulate_rest();
  }

  Vec3 direction(double cosine, const Draw& draw) const override {
    if (draw.extra(0) >= once_(cosine)[0]) return rest_direction(draw);
    const Vec3 in = direction_at(cosine);
    constexpr uint64_t most = 256;  // at worst one in three is kept
    for (uint64_t attempt = 0; attempt < most; ++attempt) {
      const Draw now = draw.attempt(attempt);
      const Vec3 normal = facets_.visible_normal(in, now.u, now.v);
      const Vec3 out = 2.0 * in.dot(normal) * normal - in;
      if (now.extra(3 * attempt + 2) < facets_.leaves(cosine, out.z())) return out;
    }
    return rest_direction(draw);
  }

  Vec3 mean_direction(double cosine) const override {
    const auto [power, x, z] = once_(cosine);
    return {x, 0.0, z + (1.0 - power) * rest_z_};
  }

  double density(double cosine, const Vec3& out) const override {
    const double rest = (1.0 - once_(cosine)[0]) * (1.0 - once_(out.z())[0]);
    return facets_.once_reflected_1_sr(direction_at(cosine), out) +
           (rest_ > 0.0 ? rest * out.z() / (pi * rest_) : 0.0);
  }

 private:
  double lost(double cosine) const { return std::max(0.0, 1.0 - once_(cosine)[0]); }

  // The cumulated distribution of the cosine of what needs several reflections.
  void tabulate_rest() {
    constexpr size_t steps = 512;
    double sum = 0.0, along = 0.0, before = 0.0;
    cumulated_.push_back(0.0);
    for (size_t i = 1; i <= steps; ++i) {
      const double cosine = static_cast<double>(i) / steps;
      const double now = 2.0 * cosine * lost(cosine);
      sum += 0.5 * (before + now) / steps;
      along += 0.5 * (before * (cosine - 1.0 / steps) + now * cosine) / steps;
      cumulated_.push_back(sum);
      before = now;
    }
    rest_ = even_mean([this](double cosine) { return lost(cosine); });
    rest_z_ = sum > 0.0 ? along / sum : 0.0;
  }

  Vec3 rest_direction(const Draw& draw) const {
    const double wanted = draw.u * cumulated_.back();
    const auto above = std::upper_bound(cumulated_.begin() + 1, cumulated_.end() - 1, wanted);
    const auto i = static_cast<double>(above - cumulated_.begin());
    const double low = *(above - 1), step = *above - low;
    const double cosine = std::clamp((i - 1.0 + (step > 0.0 ? (wanted - low) / step : 0.5)) /
                                         static_cast<double>(cumulated_.size() - 1),
                                     1e-6, 1.0);
    const double radius = std::sqrt(1.0 - cosine * cosine), angle = 2.0 * pi * draw.v;
    return {radius * std::cos(angle), radius * std::sin(angle), cosine};
  }

  Ggx facets_;
  CosineTable<3> once_;  // of light reflected once: power, sums of o_x and o_z
  std::vector<double> cumulated_;
  double rest_ = 0.0;    // 1 − Ē
  double rest_z_ = 0.0;  // mean o_z of light reflected more often
};

}  // namespace

std::shared_ptr<const Lobe> rough_mirror(double alpha) {
  return std::make_shared<RoughMirror>(alpha);
}

namespace {

class SlopeError final : public Lobe {
 public:
  explicit SlopeError(double slope_rad)
      : slope_rad_(slope_rad), mean_([this](double cosine) { return mean_of(cosine); }) {}

  Vec3 direction(double cosine, const Draw& draw) const override {
    const double size = slope_rad_ * std::sqrt(-2.0 * std::log(draw.u));
    const double along = size * std::cos(2.0 * pi * draw.v);
    const double side = size * std::sin(2.0 * pi * draw.v);
    const Vec3 in = direction_at(cosine);
    // `along` or its opposite, each as often as it shows.
    const double turned = draw.extra(0) * 2.0 < shows(in, along) ? along : -along;
    return reflect(in, turned, side);
  }

  Vec3 mean_direction(double cosine) const override {
    const auto [x, z] = mean_(cosine);
    return {x, 0.0, z};
  }

  double density(double cosine, const Vec3& out) const override {
    const Vec3 in = direction_at(cosine);
    const Vec3 normal = (in + out).normalized();
    const double along = normal.x() / normal.z(), side = normal.y() / normal.z();
    const double variance = slope_rad_ * slope_rad_;
    const double spread =
        std::exp(-(along * along + side * side) / (2.0 * variance)) / (2.0 * pi * variance);
    const double normal_z3 = normal.z() * normal.z() * normal.z();
    return spread * shows(in, along) / (normal_z3 * 4.0 * in.dot(normal));
  }

 private:
  // The part of the surface that leans by `along` towards the light, as it shows.
  static double shows(const Vec3& in, double along) {
    return std::clamp(1.0 + along * in.x() / in.z(), 0.0, 2.0);
  }

  // Light that would go below the surface meets it again.
  static Vec3 reflect(const Vec3& in, double along, double side) {
    const Vec3 normal = Vec3(along, side, 1.0).normalized();
    Vec3 out = 2.0 * in.dot(normal) * normal - in;
    out.z() = std::max(1e-9, std::abs(out.z()));
    return out;
  }

  // The expectation of direction(), over slopes up to 7 σ.
  std::array<double, 2> mean_of(double cosine) const {
    constexpr double reach = 7.0;
    constexpr size_t sizes = 40, angles = 48;
    const Vec3 in = direction_at(cosine);
    double x = 0.0, z = 0.0, sum = 0.0;
    for (const auto& [node, node_weight] : gauss_legendre(sizes)) {
      const double size = 0.5 * reach * (1.0 + node);
      const double ring = node_weight * size * std::exp(-0.5 * size * size);
      for (size_t k = 0; k < angles; ++k) {
        const double angle = 2.0 * pi * (static_cast<double>(k) + 0.5) / angles;
        const double along = slope_rad_ * size * std::cos(angle);
        const double weight = ring * shows(in, along);
        const Vec3 out = reflect(in, along, slope_rad_ * size * std::sin(angle));
        x += weight * out.x();
        z += weight * out.z();
        sum += weight;
      }
    }
    return {x / sum, z / sum};
  }

  double slope_rad_;
  CosineTable<2> mean_;
};

}  // namespace

std::shared_ptr<const Lobe> slope_error(double slope_rad) {
  return std::make_shared<SlopeError>(slope_rad);
}

}  // namespace photorque
