#include "sources/profiles/angular_profile.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/constants.h"

namespace photorque {
namespace {

// Profiles without an edge are cut where the intensity is exp(−this) of the maximum: the flux
// beyond is below the resolution of a 32-bit random number by a factor of 1e7.
constexpr double negligible_exponent = 40.0;

// ln cos θ with its relative precision near the axis, where cos θ has lost it.
double log_cosine(double angle_rad) {
  if (angle_rad > 0.25 * pi) return std::log(std::cos(angle_rad));
  const double sine = std::sin(angle_rad);
  return 0.5 * std::log1p(-sine * sine);
}

}  // namespace

AngularProfile gaussian_profile(double fwhm_rad) {
  return super_gaussian_profile(fwhm_rad, 2.0);
}

AngularProfile super_gaussian_profile(double fwhm_rad, double order) {
  const double reach = std::pow(negligible_exponent / std::numbers::ln2, 1.0 / order);
  return {[fwhm_rad, order](double angle_rad) {
            return std::exp2(-std::pow(2.0 * angle_rad / fwhm_rad, order));
          },
          std::min(0.5 * pi, 0.5 * fwhm_rad * reach)};
}

AngularProfile pillbox_profile(double half_angle_rad, PillboxMeasure measure) {
  switch (measure) {
    case PillboxMeasure::angle:
      return {
          [](double angle_rad) { return angle_rad > 0.0 ? angle_rad / std::sin(angle_rad) : 1.0; },
          half_angle_rad};
    case PillboxMeasure::projected:
      return {[](double angle_rad) { return std::cos(angle_rad); }, half_angle_rad};
    case PillboxMeasure::solid_angle:
      break;
  }
  return {[](double) { return 1.0; }, half_angle_rad};
}

AngularProfile cosine_power_profile(double exponent) {
  const double rise = exponent == 0.0 ? 1.0 : -std::expm1(-negligible_exponent / exponent);
  const double end_rad = 2.0 * std::asin(std::sqrt(0.5 * rise));
  return {[exponent](double angle_rad) {
            return exponent == 0.0 ? 1.0 : std::exp(exponent * log_cosine(angle_rad));
          },
          end_rad};
}

}  // namespace photorque
