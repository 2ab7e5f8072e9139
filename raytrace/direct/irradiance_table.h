// The irradiance of a disc_light.h for many points, from a table (factor_table.h).
//
// On a surface of normal n at height h above the aperture and distance d from its axis
//   E = −n_z A(h, d) − n·p̂ B(h, d),
// p̂ pointing away from the axis.
#pragma once

#include <cmath>
#include <optional>

#include "raytrace/direct/factor_table.h"

namespace photorque {

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

// The same for irradiance and momentum together.
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
