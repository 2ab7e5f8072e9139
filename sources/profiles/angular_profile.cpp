#include "sources/profiles/angular_profile.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/constants.h"
#include "core/numerics/transpose.h"
#include "core/numerics/vector_math.h"
#include "sources/profiles/inverse_flux.h"

namespace photorque {
namespace {

// Profiles without an edge are cut where the intensity is exp(−40) of the maximum: the flux beyond
// is below the resolution of a 32-bit random number by a factor of 1e7.
constexpr double negligible_exponent = 40.0;

// ln cos θ with full relative precision near the axis, where cos θ rounds to 1.
double log_cosine(double angle_rad) {
  if (angle_rad > 0.25 * pi) return std::log(std::cos(angle_rad));
  const double sine = std::sin(angle_rad);
  return 0.5 * std::log1p(-sine * sine);
}

}  // namespace

AngularProfile gaussian_profile(double fwhm_rad) {
  const AngularProfile same = super_gaussian_profile(fwhm_rad, 2.0);
  return {[fwhm_rad](double angle_rad) {  // a product, which is faster than a power
            const double x = 2.0 * angle_rad / fwhm_rad;
            return std::exp2(-x * x);
          },
          same.end_rad};
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

AngularDistribution::AngularDistribution(AngularProfile core, std::optional<Halo> halo) {
  halo_fraction_ = halo ? halo->fraction : 0.0;
  const auto add = [this](AngularProfile profile, double fraction) {
    const InverseFlux inverse(profile);
    const auto& table = inverse.coefficients();
    coefficients_.insert(coefficients_.end(), table.begin(), table.end());
    parts_.push_back({std::move(profile), fraction / inverse.flux()});
  };
  add(std::move(core), 1.0 - halo_fraction_);
  if (halo_fraction_ > 0.0) add(std::move(halo->profile), halo_fraction_);

  // Each profile is monotone, so its maximum is on the axis or at an edge. The steps in between are
  // for the maximum of a sum of both profiles.
  constexpr int steps = 256;
  for (const Part& part : parts_) {
    for (int i = 0; i <= steps; ++i) {
      const double angle_rad = part.profile.end_rad * i / steps;
      brightest_ = std::max(brightest_, intensity_per_flux(angle_rad));
    }
  }
}

double AngularDistribution::intensity_per_flux(double angle_rad) const {
  double sum = 0.0;
  for (const Part& part : parts_) sum += part.intensity_factor * part.profile(angle_rad);
  return sum;
}

std::vector<double> AngularDistribution::edges_rad() const {
  std::vector<double> edges;
  for (const Part& part : parts_) edges.push_back(part.profile.end_rad);
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

double AngularDistribution::relative_intensity(double angle_rad) const {
  return std::min(1.0, intensity_per_flux(angle_rad) / brightest_);
}

void AngularDistribution::rises(const std::array<uint32_t, ray_block>& bits,
                                std::array<float, ray_block>& rise) const {
  const auto halo = static_cast<uint32_t>(std::min(std::ldexp(halo_fraction_, 32), 0x1p32 - 1.0));
  const auto per_halo = halo > 0 ? static_cast<float>(0x1p-32 / halo_fraction_) : 0.0f;
  const auto per_core = static_cast<float>(0x1p-32 / (1.0 - halo_fraction_));
  constexpr auto smallest_fraction = static_cast<float>(InverseFlux::smallest_fraction);
  constexpr float largest_fraction = 1.0f - 0x1p-24f;
  std::array<uint32_t, ray_block> interval;
  std::array<float, ray_block> t;
  for (int i = 0; i < ray_block; ++i) {
    const uint32_t outside = ~bits[i];
    const bool in_halo = outside < halo;
    // Maps each part to the whole interval (0, 1); the bounds only correct rounding.
    const float part = single_of(in_halo ? outside : outside - halo) + 0.5f;
    float fraction = part * (in_halo ? per_halo : per_core);
    fraction = fraction < smallest_fraction ? smallest_fraction : fraction;
    fraction = fraction > largest_fraction ? largest_fraction : fraction;
    const auto place = InverseFlux::place(fraction);
    constexpr auto intervals = static_cast<uint32_t>(InverseFlux::intervals);
    interval[i] = place.interval + (in_halo ? intervals : 0);
    t[i] = place.t;
  }
  alignas(32) std::array<std::array<float, ray_block>, 4> c;
  for (int i = 0; i < ray_block; i += 8) {
    std::array<const float*, 8> rows;
    for (int k = 0; k < 8; ++k) rows[static_cast<size_t>(k)] = &coefficients_[4 * interval[i + k]];
    transpose_8x4(rows, &c[0][i], ray_block);
  }
  for (int i = 0; i < ray_block; ++i) {
    const float h = c[0][i] + t[i] * (c[1][i] + t[i] * (c[2][i] + t[i] * c[3][i]));
    rise[i] = h > 0.0f ? h : 0.0f;
  }
}

}  // namespace photorque
