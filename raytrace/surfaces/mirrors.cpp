#include "raytrace/surfaces/mirrors.h"

#include <cmath>
#include <optional>

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

  Vec3 direction(const Arrival& light, const Draw& draw) const override {
    if (draw.extra(0) >= once_(light.cosine)[0]) return rest_direction(draw);
    const Vec3 in = direction_at(light.cosine);
    constexpr uint64_t most = 256;  // the acceptance is at least 1/3
    for (uint64_t attempt = 0; attempt < most; ++attempt) {
      const Draw now = draw.attempt(attempt);
      const Vec3 normal = facets_.visible_normal(in, now.u, now.v);
      const Vec3 out = 2.0 * in.dot(normal) * normal - in;
      if (now.extra(3 * attempt + 2) < facets_.leaves(light.cosine, out.z())) return out;
    }
    return rest_direction(draw);
  }

  Vec3 mean_direction(const Arrival& light) const override {
    const auto [power, x_by_sine, z] = once_(light.cosine);
    return {direction_at(light.cosine).x() * x_by_sine, 0.0, z + (1.0 - power) * rest_z_};
  }

  double density(const Arrival& light, const Vec3& out) const override {
    const double rest = (1.0 - once_(light.cosine)[0]) * (1.0 - once_(out.z())[0]);
    return facets_.once_reflected_1_sr(direction_at(light.cosine), out) +
           (rest_ > 0.0 ? rest * out.z() / (pi * rest_) : 0.0);
  }

 private:
  double lost(double cosine) const { return std::max(0.0, 1.0 - once_(cosine)[0]); }

  // Cumulative distribution of the cosine of light that needs several reflections.
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
  CosineTable<3> once_;  // of light reflected once: power, sums of o_x over sin θ and of o_z
  std::vector<double> cumulated_;
  double rest_ = 0.0;    // 1 − Ē
  double rest_z_ = 0.0;  // mean o_z of light reflected more than once
};

}  // namespace

std::shared_ptr<const Lobe> rough_mirror(double alpha) {
  return std::make_shared<RoughMirror>(alpha);
}

namespace {

class SlopeError final : public Lobe {
 public:
  SlopeError(double first_rad, double second_rad, SlopeShape shape)
      : first_rad_(first_rad),
        second_rad_(second_rad),
        shape_(shape),
        even_([this](double cosine) -> std::array<double, 2> {
          const Vec3 mean = mean_of(cosine);
          return {mean.x() / direction_at(cosine).x(), mean.z()};
        }) {
    if (first_rad != second_rad) {
      turned_.emplace([this](double cosine) { return harmonics(cosine); });
    }
  }

  Vec3 direction(const Arrival& light, const Draw& draw) const override {
    const double size = size_within(draw.u);
    const double first = first_rad_ * size * std::cos(2.0 * pi * draw.v);
    const double second = second_rad_ * size * std::sin(2.0 * pi * draw.v);
    const Slope slope = slope_in(light, first, second);
    const Vec3 in = direction_at(light.cosine);
    // The slope or its opposite, each with the probability of its visible area.
    const double sign = draw.extra(0) * 2.0 < shows(in, slope.along) ? 1.0 : -1.0;
    return reflect(in, sign * slope.along, sign * slope.across);
  }

  // z and x are even functions of the angle of the axis, y is an odd one; all have a period of half
  // a turn.
  Vec3 mean_direction(const Arrival& light) const override {
    const double in_sine = direction_at(light.cosine).x();
    if (!turned_) {
      const auto [x_by_sine, z] = even_(light.cosine);
      return {in_sine * x_by_sine, 0.0, z};
    }
    const Harmonics mean = (*turned_)(light.cosine);
    // cos 2kφ and sin 2kφ by the addition theorem.
    const double cosine_2 =
        light.axis_cosine * light.axis_cosine - light.axis_sine * light.axis_sine;
    const double sine_2 = 2.0 * light.axis_cosine * light.axis_sine;
    double cosine = 1.0, sine = 0.0;
    Vec3 sum = Vec3::Zero();
    for (size_t k = 0; k < harmonic_count; ++k) {
      sum += Vec3(cosine * mean[3 * k], sine * mean[3 * k + 1], cosine * mean[3 * k + 2]);
      const double next = cosine * cosine_2 - sine * sine_2;
      sine = sine * cosine_2 + cosine * sine_2;
      cosine = next;
    }
    return {in_sine * sum.x(), in_sine * sum.y(), sum.z()};
  }

  double density(const Arrival& light, const Vec3& out) const override {
    const Vec3 in = direction_at(light.cosine);
    const Vec3 normal = (in + out).normalized();
    const double along = normal.x() / normal.z(), across = normal.y() / normal.z();
    const double first = (along * light.axis_cosine + across * light.axis_sine) / first_rad_;
    const double second = (across * light.axis_cosine - along * light.axis_sine) / second_rad_;
    const double normal_z3 = normal.z() * normal.z() * normal.z();
    return spread(std::hypot(first, second)) / (first_rad_ * second_rad_) * shows(in, along) /
           (normal_z3 * 4.0 * in.dot(normal));
  }

 private:
  struct Slope {
    double along, across;  // x and y of the frame of the hit
  };
  static Slope slope_in(const Arrival& light, double first, double second) {
    return {first * light.axis_cosine - second * light.axis_sine,
            first * light.axis_sine + second * light.axis_cosine};
  }

  // Slope magnitude, relative to the axes, within which a fraction u of the slopes lies.
  double size_within(double u) const {
    return shape_ == SlopeShape::gaussian ? std::sqrt(-2.0 * std::log(u)) : std::sqrt(u);
  }
  // Density of slopes per area, relative to the axes.
  double spread(double size) const {
    if (shape_ == SlopeShape::gaussian) return std::exp(-0.5 * size * size) / (2.0 * pi);
    return size <= 1.0 ? 1.0 / pi : 0.0;
  }

  // Visible area, relative to a flat surface, of the part of the surface tilted by `along` towards
  // the light; clamped to [0, 2].
  static double shows(const Vec3& in, double along) {
    return std::clamp(1.0 + along * in.x() / in.z(), 0.0, 2.0);
  }

  // Reflects at the facet. A direction below the surface is mirrored to above it, as after a second
  // reflection.
  static Vec3 reflect(const Vec3& in, double along, double across) {
    const Vec3 normal = Vec3(along, across, 1.0).normalized();
    Vec3 out = 2.0 * in.dot(normal) * normal - in;
    out.z() = std::max(1e-9, std::abs(out.z()));
    return out;
  }

  // Expectation of direction(), over slopes up to 7 σ.
  Vec3 mean_of(const Arrival& light) const {
    const double reach = shape_ == SlopeShape::gaussian ? 7.0 : 1.0;
    constexpr size_t sizes = 40, angles = 48;
    const Vec3 in = direction_at(light.cosine);
    Vec3 mean = Vec3::Zero();
    double sum = 0.0;
    for (const auto& [node, node_weight] : gauss_legendre(sizes)) {
      const double size = 0.5 * reach * (1.0 + node);
      const double ring = node_weight * size * spread(size);
      for (size_t k = 0; k < angles; ++k) {
        const double angle = 2.0 * pi * (static_cast<double>(k) + 0.5) / angles;
        const Slope slope = slope_in(light, first_rad_ * size * std::cos(angle),
                                     second_rad_ * size * std::sin(angle));
        const double weight = ring * shows(in, slope.along);
        mean += weight * reflect(in, slope.along, slope.across);
        sum += weight;
      }
    }
    return mean / sum;
  }

  // Coefficients of cos 2kφ (x over sin θ, z) and sin 2kφ (y over sin θ) in the angle φ of the
  // axis, by the trapezoidal rule over half a turn. The k-th coefficient is of the order of the
  // slopes to the power 2k.
  static constexpr size_t harmonic_count = 4;
  using Harmonics = std::array<double, 3 * harmonic_count>;
  Harmonics harmonics(double cosine) const {
    constexpr size_t turns = 2 * harmonic_count;
    Harmonics sum{};
    for (size_t i = 0; i < turns; ++i) {
      const double turn_rad = pi * static_cast<double>(i) / turns;
      Vec3 mean = mean_of({cosine, std::cos(turn_rad), std::sin(turn_rad)});
      mean.head<2>() /= direction_at(cosine).x();
      for (size_t k = 0; k < harmonic_count; ++k) {
        const double even = std::cos(2.0 * static_cast<double>(k) * turn_rad);
        const double odd = std::sin(2.0 * static_cast<double>(k) * turn_rad);
        const double weight = (k == 0 ? 1.0 : 2.0) / turns;
        sum[3 * k] += weight * even * mean.x();
        sum[3 * k + 1] += weight * odd * mean.y();
        sum[3 * k + 2] += weight * even * mean.z();
      }
    }
    return sum;
  }

  double first_rad_, second_rad_;
  SlopeShape shape_;
  CosineTable<2> even_;  // for equal axes
  std::optional<CosineTable<3 * harmonic_count>> turned_;
};

}  // namespace

std::shared_ptr<const Lobe> slope_error(double first_rad, double second_rad, SlopeShape shape) {
  return std::make_shared<SlopeError>(first_rad, second_rad, shape);
}

}  // namespace photorque
