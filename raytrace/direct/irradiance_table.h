// The irradiance of a disc light (disc_light.h) at many places, from tables over height and
// distance from its axis.
//
// Its factors have kinks only where the circle that an edge of the beam draws touches the rim of
// the aperture, at d = |R ± h tan θ|. Between two of these, powers of half integers of the distance
// to them remain, which its square root makes smooth: cubics in the root over even steps, with
// coefficients that are Chebyshev series in h.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "raytrace/direct/disc_light.h"

namespace photorque {

// `Count` factors at a time: 2 or 6.
template <int Count>
class FactorTable {
 public:
  using Factors = Eigen::Array<double, Count, 1>;
  // Arguments: distance from the axis and height [m].
  using Function = std::function<Factors(double, double)>;

  // A table of the `factors` of `light` for heights in [low_m, high_m], low_m > 0. Empty if no
  // table agrees with them to `tolerance` of the largest at all test points, because kinks cross
  // within these heights or light reaches the side. Equal bits with any `threads`.
  static std::optional<FactorTable> make(const DiscLight& light, const Function& factors,
                                         double low_m, double high_m, int threads);
  static constexpr double tolerance = Count == 2 ? 1e-7 : 1e-6;

  static constexpr int max_degrees = 8;  // of the series in h

  // Largest difference that was found, half-way between steps.
  double error() const { return error_; }
  // For these heights; zero where no light comes.
  Factors at(double distance_m, double height_m) const;

 private:
  static constexpr size_t fewest_steps = 128, most_steps = 512;  // per half of a piece

  // A distance from the axis that moves with the height.
  struct Kink {
    double at_zero_m, slope;
    double at(double height_m) const { return at_zero_m + slope * height_m; }
  };
  using Node = Eigen::Array<double, max_degrees, Count>;  // coefficients

  FactorTable(double low_m, double high_m, std::vector<Kink> kinks, size_t steps);
  static std::optional<std::vector<Kink>> kinks_of(const DiscLight& light, double low_m,
                                                   double high_m);
  // `coarser` has half as many steps, or is null.
  void fill(const Function& factors, const FactorTable* coarser, int threads);
  bool agrees_with(const Function& factors);
  // The distance of a place in the table: node `place` (may be between two) of half 2 · piece or
  // 2 · piece + 1.
  double distance_m(size_t half, double place, double height_m) const;

  double middle_m_, half_range_m_;  // of the heights
  size_t degrees_, steps_;
  double error_ = 0.0;
  std::vector<Kink> kinks_;  // rising, from the axis to where the light ends
  std::vector<Node> nodes_;  // half by half, steps_ + 1 each
};

extern template class FactorTable<2>;
extern template class FactorTable<6>;

// The irradiance for many points. On a surface of normal n at height h above the aperture and
// distance d from its axis
//   E = −n_z A(h, d) − n·p̂ B(h, d),
// p̂ pointing away from the axis.
class IrradianceTable {
 public:
  // See FactorTable::make().
  static std::optional<IrradianceTable> make(const DiscLight& light, double low_m, double high_m,
                                             int threads) {
    auto factors = FactorTable<2>::make(
        light, [&](double d, double h) { return light.factors_W_m2(d, h); }, low_m, high_m,
        threads);
    if (!factors) return std::nullopt;
    return IrradianceTable(*std::move(factors));
  }
  static constexpr double tolerance = FactorTable<2>::tolerance;

  // Largest difference from the light that was found, half-way between steps [W/m²].
  double error_W_m2() const { return factors_.error(); }

  // As DiscLight::irradiance_W_m2(), for points of these heights.
  double irradiance_W_m2(const Vec3& point_m, const Vec3& normal) const {
    const double d = std::sqrt(point_m.x() * point_m.x() + point_m.y() * point_m.y());
    const double away = d > 0.0 ? (normal.x() * point_m.x() + normal.y() * point_m.y()) / d : 0.0;
    const Eigen::Array2d factor = factors_.at(d, point_m.z());
    return -normal.z() * factor[0] - away * factor[1];
  }

 private:
  explicit IrradianceTable(FactorTable<2> factors) : factors_(std::move(factors)) {}

  FactorTable<2> factors_;
};

// A table of irradiance and momentum together.
class MomentumTable {
 public:
  static std::optional<MomentumTable> make(const DiscLight& light, double low_m, double high_m,
                                           int threads) {
    auto factors = FactorTable<6>::make(
        light, [&](double d, double h) { return light.flow_W_m2(d, h); }, low_m, high_m, threads);
    if (!factors) return std::nullopt;
    return MomentumTable(*std::move(factors));
  }

  double error_W_m2() const { return factors_.error(); }

  // As DiscLight::arriving(), for points of these heights.
  ArrivingLight arriving(const Vec3& point_m, const Vec3& normal) const {
    const double d = std::sqrt(point_m.x() * point_m.x() + point_m.y() * point_m.y());
    return DiscLight::arriving_of(factors_.at(d, point_m.z()), point_m, normal);
  }

 private:
  explicit MomentumTable(FactorTable<6> factors) : factors_(std::move(factors)) {}

  FactorTable<6> factors_;
};

}  // namespace photorque
