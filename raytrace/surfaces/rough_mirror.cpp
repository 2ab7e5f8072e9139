#include "raytrace/surfaces/rough_mirror.h"

#include <cmath>

#include "core/constants.h"
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

}  // namespace photorque
