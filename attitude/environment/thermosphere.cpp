#include "attitude/environment/thermosphere.h"

#include <algorithm>
#include <cmath>

#include "core/numerics/interpolation.h"

namespace photorque {
namespace {

struct Layer {
  double altitude_m, density_kg_m3;
};
constexpr std::array<Layer, 19> layers = {{{100e3, 5.297e-7},
                                           {110e3, 9.661e-8},
                                           {120e3, 2.438e-8},
                                           {130e3, 8.484e-9},
                                           {140e3, 3.845e-9},
                                           {150e3, 2.070e-9},
                                           {180e3, 5.464e-10},
                                           {200e3, 2.789e-10},
                                           {250e3, 7.248e-11},
                                           {300e3, 2.418e-11},
                                           {350e3, 9.518e-12},
                                           {400e3, 3.725e-12},
                                           {450e3, 1.585e-12},
                                           {500e3, 6.967e-13},
                                           {600e3, 1.454e-13},
                                           {700e3, 3.614e-14},
                                           {800e3, 1.170e-14},
                                           {900e3, 5.245e-15},
                                           {1000e3, 3.019e-15}}};
constexpr double last_scale_height_m = 268e3;

}  // namespace

Thermosphere::Thermosphere() {
  for (const Layer& layer : layers) {
    altitude_m_.push_back(layer.altitude_m);
    log_density_.push_back(std::log(layer.density_kg_m3));
  }
  slope_1_m_ = monotone_slopes(altitude_m_, log_density_);
}

std::array<double, 2> Thermosphere::at(double altitude_m) const {
  if (altitude_m <= altitude_m_.front()) return {layers.front().density_kg_m3, 0.0};
  if (altitude_m >= altitude_m_.back()) {
    const double density_kg_m3 = layers.back().density_kg_m3 *
                                 std::exp((altitude_m_.back() - altitude_m) / last_scale_height_m);
    return {density_kg_m3, -density_kg_m3 / last_scale_height_m};
  }
  const auto above = std::ranges::upper_bound(altitude_m_, altitude_m);
  const auto i = static_cast<size_t>(above - altitude_m_.begin()) - 1;
  const double width_m = altitude_m_[i + 1] - altitude_m_[i];
  const double t = (altitude_m - altitude_m_[i]) / width_m;
  const auto c = hermite_coefficients(log_density_[i], log_density_[i + 1] - log_density_[i],
                                      width_m * slope_1_m_[i], width_m * slope_1_m_[i + 1]);
  const double density_kg_m3 = std::exp(c[0] + t * (c[1] + t * (c[2] + t * c[3])));
  const double rise = (c[1] + t * (2.0 * c[2] + 3.0 * t * c[3])) / width_m;
  return {density_kg_m3, density_kg_m3 * rise};
}

}  // namespace photorque
