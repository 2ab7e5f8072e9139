// Radiant intensity over the angle from the axis of a beam: profiles of lamps, and sampling of
// directions from one profile or from a core with a halo.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "raytrace/emitter.h"

namespace photorque {

// Radiant intensity I(θ) [W/sr up to a factor] about an axis. Smooth on [0, end_rad], zero beyond.
struct AngularProfile {
  std::function<double(double angle_rad)> intensity;  // > 0 inside, finite; arbitrary scale
  double end_rad = 0.0;                               // ∈ (0, π/2]

  double operator()(double angle_rad) const {
    return angle_rad <= end_rad ? intensity(angle_rad) : 0.0;
  }
};

// I = exp(−ln 2 · (2θ/fwhm)²), fwhm ∈ (0, π). For small angles 50 % of the flux is within
// ±fwhm/2 and 93.75 % within ±fwhm.
AngularProfile gaussian_profile(double fwhm_rad);

// I = exp(−ln 2 · (2θ/fwhm)^order), fwhm ∈ (0, π), order ∈ [2, 100]; 2 is the Gaussian, 100 nearly
// a disc. For small angles the flux within ±θ is the regularised incomplete gamma function
// P(2/order, ln 2 · (2θ/fwhm)^order).
AngularProfile super_gaussian_profile(double fwhm_rad, double order);

// The measure in which the flux of a pillbox is uniform up to its half-angle θ0 ∈ (0, π/2]; u is
// uniform in (0, 1):
enum class PillboxMeasure {
  angle,        // the disc of angles: θ = θ0 √u, I ∝ θ/sin θ (the pillbox of SolTrace)
  solid_angle,  // the sphere: cos θ = 1 − u(1 − cos θ0), I constant
  projected,  // the projected solid angle: sin θ = sin θ0 √u, I ∝ cos θ (constant radiance)
};
AngularProfile pillbox_profile(double half_angle_rad, PillboxMeasure measure);

// I = cos^exponent θ, exponent ∈ [0, 1e9]; 0 is isotropic, 1 is Lambert's law.
AngularProfile cosine_power_profile(double exponent);

// Directions of a lamp: one profile, or a core with a halo.

// A halo of stray light: a fraction of the total flux, in [0, 1), with a separate profile.
struct Halo {
  AngularProfile profile;
  double fraction = 0.0;
};

// Immutable. Directions are sampled with equal weight; the flux within any cone has an error of
// 1e-6.
class AngularDistribution {
 public:
  explicit AngularDistribution(AngularProfile core, std::optional<Halo> halo = std::nullopt);

  // Radiant intensity over its maximum, in [0, 1].
  double relative_intensity(double angle_rad) const;

  // Angles at which profiles end, rising; the last is the end of all light.
  std::vector<double> edges_rad() const;

  // Flux divided by the largest intensity [sr]: the solid angle that a uniform beam of this
  // intensity would fill.
  double effective_solid_angle_sr() const { return 1.0 / brightest_; }

  // Computes 1 − cos θ for each 32-bit fraction. It rises with the fraction within the core and,
  // for the last `halo.fraction` of the fractions, within the halo.
  void rises(const std::array<uint32_t, ray_block>& bits, std::array<float, ray_block>& rise) const;

 private:
  double intensity_per_flux(double angle_rad) const;

  struct Part {
    AngularProfile profile;
    double intensity_factor;  // normalises the profile's flux to its fraction of the total
  };
  std::vector<Part> parts_;
  double halo_fraction_ = 0.0;
  double brightest_ = 0.0;           // largest intensity per flux [1/sr]
  std::vector<float> coefficients_;  // tables of InverseFlux, core before halo
};

}  // namespace photorque
