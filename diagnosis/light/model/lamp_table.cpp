#include "diagnosis/light/model/lab.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/constants.h"

namespace photorque {
namespace {

constexpr int mirrored = 2;           // nodes at negative slopes
constexpr double steepest_rad = 1.4;  // limit of the table

// Lagrange weights of six evenly spaced nodes −2 … 3 at a position t in [0, 1].
std::array<double, 6> lagrange_weights(double t) {
  const double a = t + 2.0, b = t + 1.0, c = t, d = t - 1.0, e = t - 2.0, f = t - 3.0;
  return {-b * c * d * e * f / 120.0, a * c * d * e * f / 24.0,  -a * b * d * e * f / 12.0,
          a * b * c * e * f / 12.0,   -a * b * c * d * f / 24.0, a * b * c * d * e / 120.0};
}

}  // namespace

LampTable::LampTable(std::shared_ptr<const DiscLight> light, double lowest_m, double highest_m)
    : light_(std::move(light)), lowest_m_(lowest_m), highest_m_(highest_m) {
  if (light_->parallel() || light_->collimated() || !light_->fades_out()) return;
  const double R = light_->radius_m();
  const double low = R * R / (highest_m * highest_m), high = R * R / (lowest_m * lowest_m);
  middle_ = 0.5 * (low + high);
  half_ = std::max(0.5 * (high - low), 1e-12);
  largest_slope_ = std::tan(std::min(light_->reach_rad(), steepest_rad)) + R / lowest_m;
  constexpr double of_half_flux = 0.1;
  constexpr size_t most = 4000;
  step_ = of_half_flux * std::tan(std::min(light_->half_flux_rad(), steepest_rad));
  for (; largest_slope_ / step_ < most; step_ *= 0.5) {
    nodes_ = nodes_at(step_);
    if (holds()) return;
  }
  nodes_.clear();
}

double LampTable::place_of(double height_m) const {
  const double part = light_->radius_m() / height_m;
  return (part * part - middle_) / half_;
}

std::vector<LampTable::Node> LampTable::nodes_at(double step) const {
  // Polynomial coefficients from the values at Chebyshev points.
  Eigen::Matrix<double, terms, terms> powers;
  std::array<double, terms> height_m;
  for (size_t k = 0; k < terms; ++k) {
    const double at = std::cos(pi * (static_cast<double>(k) + 0.5) / static_cast<double>(terms));
    height_m[k] = light_->radius_m() / std::sqrt(middle_ + half_ * at);
    for (size_t p = 0; p < terms; ++p) {
      powers(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(p)) =
          std::pow(at, static_cast<double>(p));
    }
  }
  const Eigen::Matrix<double, terms, terms> inverse = powers.inverse();
  const auto last = static_cast<int>(std::ceil(largest_slope_ / step)) + 4;
  std::vector<Node> nodes(static_cast<size_t>(last + mirrored + 1));
  for (int i = 0; i <= last; ++i) {
    Node node;
    node.fill(Eigen::Array2d::Zero());
    for (size_t k = 0; k < terms; ++k) {
      const Eigen::Array2d value =
          height_m[k] * height_m[k] * light_->factors_W_m2(i * step * height_m[k], height_m[k]);
      for (size_t p = 0; p < terms; ++p) {
        node[p] += inverse(static_cast<Eigen::Index>(p), static_cast<Eigen::Index>(k)) * value;
      }
    }
    nodes[static_cast<size_t>(i) + mirrored] = node;
    // The light along the axis is an even function of the slope, the light away from it an odd one.
    if (i > 0 && i <= mirrored) {
      for (Eigen::Array2d& c : node) c[1] = -c[1];
      nodes[static_cast<size_t>(mirrored - i)] = node;
    }
  }
  return nodes;
}

Eigen::Array2d LampTable::factors(double slope, double height_m) const {
  const double x = slope / step_, whole = std::floor(x), t = place_of(height_m);
  const auto first = static_cast<size_t>(whole);  // two nodes below the slope
  const std::array<double, 6> weights = lagrange_weights(x - whole);
  // Interpolates all coefficients between the nodes, then evaluates the polynomial.
  using Coefficients = Eigen::Array<double, 2 * terms, 1>;
  Coefficients between = Coefficients::Zero();
  for (size_t k = 0; k < weights.size(); ++k) {
    between += weights[k] * Eigen::Map<const Coefficients>(nodes_[first + k].front().data());
  }
  // Plain numbers are faster: the compiler keeps each sum of an array of two in memory.
  double along = 0.0, away = 0.0;
  for (Eigen::Index p = terms; p-- > 0;) {
    along = between[2 * p] + t * along;
    away = between[2 * p + 1] + t * away;
  }
  const double scale = 1.0 / (height_m * height_m);
  return {scale * along, scale * away};
}

bool LampTable::holds() const {
  constexpr int slopes = 16, heights = 3;
  constexpr double allowed = 1e-6;
  for (int j = 0; j < heights; ++j) {
    const double h = lowest_m_ + (highest_m_ - lowest_m_) * (j + 0.3) / heights;
    const double axis = light_->factors_W_m2(0.0, h)[0];
    for (int i = 0; i < slopes; ++i) {
      // Test points are denser near the axis, and midway between nodes, where the polynomial error
      // is largest.
      const double part = (i + 0.5) / slopes;
      const double s = (std::floor(part * part * largest_slope_ / step_) + 0.5) * step_;
      const Eigen::Array2d off = factors(s, h) - light_->factors_W_m2(s * h, h);
      if (!(off.abs().maxCoeff() < allowed * axis)) return false;
    }
  }
  return true;
}

double LampTable::irradiance_W_m2(const Vec3& point_m, const Vec3& normal) const {
  const double h = point_m.z();
  if (nodes_.empty() || !(h > lowest_m_ && h < highest_m_)) {
    return light_->irradiance_W_m2(point_m, normal);
  }
  const double d = std::sqrt(point_m.x() * point_m.x() + point_m.y() * point_m.y()), slope = d / h;
  if (slope > largest_slope_) {
    return light_->reach_rad() < steepest_rad ? 0.0 : light_->irradiance_W_m2(point_m, normal);
  }
  const double away = d > 0.0 ? (normal.x() * point_m.x() + normal.y() * point_m.y()) / d : 0.0;
  const Eigen::Array2d at = factors(slope, h);
  return -normal.z() * at[0] - away * at[1];
}

}  // namespace photorque
