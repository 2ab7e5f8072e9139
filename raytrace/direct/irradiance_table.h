// Irradiance of a disc light (disc_light.h) at many points, interpolated from tables over height
// and distance from its axis.
//
// The factors A and B have kinks only where the circle drawn by an edge of the beam touches the rim
// of the aperture, at d = |R ± h tan θ|. Between two kinks the factors contain half-integer powers
// of the distance to them. They are smooth in the square root of this distance. The table stores
// values at equal steps of this root and of h, and interpolates with cubics. The values come from a
// few of the light's integrals through Chebyshev series in root and height.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "raytrace/direct/disc_light.h"

namespace photorque {

// Table of the two factors of the irradiance, or of the six of irradiance and momentum together. On
// a surface of normal n at height h above the aperture and distance d from its axis, the irradiance
// is
//   E = −n_z A(h, d) − n·p̂ B(h, d),
// with p̂ pointing away from the axis.
template <int Count>
class FactorTable {
 public:
  using Factors = Eigen::Array<double, Count, 1>;

  // Table for heights in [low_m, high_m], low_m > 0. Empty if no table agrees with the light to
  // `tolerance` of the largest value at all test points: kinks cross within these heights, or light
  // reaches the side. The result has the same bits for any `threads`.
  static std::optional<FactorTable> make(const DiscLight& light, double low_m, double high_m,
                                         int threads);
  static constexpr double tolerance = Count == 2 ? 3e-8 : 1e-6;

  // Largest error found at the test points half-way between steps.
  double error_W_m2() const { return error_; }

  // See DiscLight::irradiance_W_m2(); heights within the table's range.
  double irradiance_W_m2(const Vec3& point_m, const Vec3& normal) const requires(Count == 2) {
    const double d = std::sqrt(point_m.x() * point_m.x() + point_m.y() * point_m.y());
    const double away = d > 0.0 ? (normal.x() * point_m.x() + normal.y() * point_m.y()) / d : 0.0;
    const Factors factor = at(d, point_m.z());
    return -normal.z() * factor[0] - away * factor[1];
  }
  // See DiscLight::arriving(); heights within the table's range.
  ArrivingLight arriving(const Vec3& point_m, const Vec3& normal) const requires(Count == 6) {
    const double d = std::sqrt(point_m.x() * point_m.x() + point_m.y() * point_m.y());
    return DiscLight::arriving_of(at(d, point_m.z()), point_m, normal);
  }

 private:
  // The factors that are tabulated, by distance from the axis and height [m].
  static Factors factors_of(const DiscLight& light, double distance_m, double height_m) {
    if constexpr (Count == 2) {
      return light.factors_W_m2(distance_m, height_m);
    } else {
      return light.flow_W_m2(distance_m, height_m);
    }
  }
  // Factors at a height within the table's range; zero outside the beam.
  Factors at(double distance_m, double height_m) const {
    const double h = height_m, d = distance_m;
    if (d >= kinks_.back().at(h)) return Factors::Zero();
    size_t piece = 0;
    while (d >= kinks_[piece + 1].at(h)) ++piece;
    const double from = kinks_[piece].at(h), to = kinks_[piece + 1].at(h);
    const double along = (d - from) / (to - from);
    const bool near = along < 0.5;
    const double place =
        std::sqrt(2.0 * (near ? along : 1.0 - along)) * static_cast<double>(steps_);
    const Cubic across(place, steps_);
    const size_t row = Count * (steps_ + 1);
    const double* first =
        &values_[(2 * piece + (near ? 0 : 1)) * rows_ * row + across.first * Count];
    Four four;
    if (rows_ == 1) {
      four = Eigen::Map<const Four>(first);
    } else {
      const Cubic along_h((h - low_m_) * rows_per_m_, rows_ - 1);
      first += along_h.first * row;
      four = along_h.weight[0] * Eigen::Map<const Four>(first) +
             along_h.weight[1] * Eigen::Map<const Four>(first + row) +
             along_h.weight[2] * Eigen::Map<const Four>(first + 2 * row) +
             along_h.weight[3] * Eigen::Map<const Four>(first + 3 * row);
    }
    return across.weight[0] * four.template segment<Count>(0) +
           across.weight[1] * four.template segment<Count>(Count) +
           across.weight[2] * four.template segment<Count>(2 * Count) +
           across.weight[3] * four.template segment<Count>(3 * Count);
  }

  using Four = Eigen::Array<double, 4 * Count, 1>;  // factors at four neighbours

  // Weights of four neighbouring values, at the places 0 … `last` (≥ 3), of the cubic through them.
  struct Cubic {
    size_t first;
    std::array<double, 4> weight;

    Cubic(double place, size_t last)
        : first(static_cast<size_t>(
              std::clamp(static_cast<int>(place - 1.0), 0, static_cast<int>(last) - 3))) {
      const double t = place - static_cast<double>(first) - 1.0;
      const double left = t + 1.0, right = t - 1.0, far = t - 2.0;
      weight = {-t * right * far / 6.0, left * right * far / 2.0, -left * t * far / 2.0,
                left * t * right / 6.0};
    }
  };
  // A distance from the axis that is linear in the height.
  struct Kink {
    double at_zero_m, slope;
    double at(double height_m) const { return at_zero_m + slope * height_m; }
  };
  // The factors at Chebyshev points of root and height, per half of a piece.
  class Series;

  FactorTable(double low_m, double high_m, std::vector<Kink> kinks)
      : low_m_(low_m), high_m_(high_m), kinks_(std::move(kinks)) {}
  static std::optional<std::vector<Kink>> kinks_of(const DiscLight& light, double low_m,
                                                   double high_m);
  size_t halves() const { return 2 * (kinks_.size() - 1); }
  void fill(const Series& series, size_t steps, size_t rows);
  bool agrees_with(const DiscLight& light);
  // Distance from the axis of a place in the table: a fraction of half 2 · piece or 2 · piece + 1.
  double distance_m(size_t half, double fraction, double height_m) const;

  double low_m_, high_m_;  // range of heights
  size_t steps_ = 0;       // per half of a piece
  size_t rows_ = 1;        // number of heights
  double rows_per_m_ = 0.0;
  double error_ = 0.0;
  std::vector<Kink> kinks_;     // rising, from the axis to the end of the light
  std::vector<double> values_;  // [half][height][place][factor]
};

extern template class FactorTable<2>;
extern template class FactorTable<6>;

using IrradianceTable = FactorTable<2>;
using MomentumTable = FactorTable<6>;

}  // namespace photorque
