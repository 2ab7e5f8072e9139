// The irradiance of a disc_light.h for many points, from a table.
//
// On a surface of normal n at height h above the aperture and distance d from its axis
//   E = −n_z A(h, d) − n·p̂ B(h, d),
// p̂ pointing away from the axis. A and B have kinks only where the circle that an edge of the beam
// draws touches the rim of the aperture, at d = |R ± h tan θ|. Between two of these, powers of half
// integers of the distance to them remain, which its square root makes smooth: cubics in the root
// over even steps, with coefficients that are Chebyshev series in h.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "raytrace/direct/disc_light.h"

namespace photorque {

class IrradianceTable {
 public:
  // For heights in [low_m, high_m], low_m > 0. Nothing where no such table agrees with `light` to
  // `tolerance` of its largest value everywhere that is looked at: kinks that cross each other
  // within these heights, or light all the way to the side. The same bits at any `threads`.
  static std::optional<IrradianceTable> make(const DiscLight& light, double low_m, double high_m,
                                             int threads);
  static constexpr double tolerance = 1e-7;

  static constexpr int max_degrees = 8;  // of the series in h

  // Largest difference from the light that was found, half-way between steps [W/m²].
  double error_W_m2() const { return error_W_m2_; }

  // As DiscLight::irradiance_W_m2(), for points of these heights.
  double irradiance_W_m2(const Vec3& point_m, const Vec3& normal) const;

 private:
  static constexpr size_t fewest_steps = 128, most_steps = 512;  // per half of a piece

  // A distance from the axis that moves with the height.
  struct Kink {
    double at_zero_m, slope;
    double at(double height_m) const { return at_zero_m + slope * height_m; }
  };
  using Node = Eigen::Array<double, max_degrees, 2>;  // coefficients of A and of B

  IrradianceTable(double low_m, double high_m, std::vector<Kink> kinks, size_t steps);
  // `coarser` has half as many steps, or is null.
  void fill(const DiscLight& light, const IrradianceTable* coarser, int threads);
  bool agrees_with(const DiscLight& light);
  // The distance of a place in the table: node `place` (may be between two) of half 2 · piece or
  // 2 · piece + 1.
  double distance_m(size_t half, double place, double height_m) const;

  double middle_m_, half_range_m_;  // of the heights
  size_t degrees_, steps_;
  double error_W_m2_ = 0.0;
  std::vector<Kink> kinks_;  // rising, from the axis to where the light ends
  std::vector<Node> nodes_;  // half by half, steps_ + 1 each
};

}  // namespace photorque
