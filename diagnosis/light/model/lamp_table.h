// Tabulated irradiance of a lamp on points, which a diagnosis evaluates millions of times.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "raytrace/direct/disc_light.h"

namespace photorque {

// Let s = d/h be the slope at which a point at distance d from the axis and height h sees the
// middle of the aperture. Then h² times both factors of DiscLight is a smooth function of s that
// hardly depends on (R/h)². It is tabulated by polynomials of degree five in s (even nodes) and in
// (R/h)². They are compared with the quadrature on construction and refined to an error below 1e-6
// of the light on the axis. Beams with edges have kinks and are not tabulated.
class LampTable {
 public:
  // Tabulates heights between these limits; other heights are integrated. Keeps `light`.
  LampTable(std::shared_ptr<const DiscLight> light, double lowest_m, double highest_m);

  // Equals DiscLight::irradiance_W_m2().
  double irradiance_W_m2(const Vec3& point_m, const Vec3& normal) const;
  double radius_m() const { return light_->radius_m(); }

 private:
  static constexpr size_t terms = 6;  // coefficients of the polynomial in (R/h)²
  using Node = std::array<Eigen::Array2d, terms>;

  double place_of(double height_m) const;
  std::vector<Node> nodes_at(double step) const;
  Eigen::Array2d factors(double slope, double height_m) const;
  bool holds() const;

  std::shared_ptr<const DiscLight> light_;
  double lowest_m_, highest_m_;
  double middle_ = 0.0, half_ = 1.0;  // middle and half-width of the range of (R/h)²
  double step_ = 0.0, largest_slope_ = 0.0;
  std::vector<Node> nodes_;  // starts at −2 steps of slope; empty: not tabulated
};

}  // namespace photorque
