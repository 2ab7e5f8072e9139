// How radiant intensity falls off from the axis of a beam: the profiles that a lamp can have.
#pragma once

#include <functional>

namespace photorque {

// Radiant intensity I(θ) [W/sr up to a factor] about an axis. Smooth on [0, end_rad], nothing is
// emitted beyond.
struct AngularProfile {
  std::function<double(double angle_rad)> intensity;  // > 0 inside, finite; of any scale
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

// What a pillbox fills evenly up to its half-angle θ0 ∈ (0, π/2]; u is uniform in (0, 1):
enum class PillboxMeasure {
  angle,        // the disc of angles: θ = θ0 √u, I ∝ θ/sin θ (the pillbox of SolTrace)
  solid_angle,  // the sphere: cos θ = 1 − u(1 − cos θ0), I constant
  projected,  // the projected solid angle: sin θ = sin θ0 √u, I ∝ cos θ (constant radiance)
};
AngularProfile pillbox_profile(double half_angle_rad, PillboxMeasure measure);

// I = cos^exponent θ, exponent ∈ [0, 1e9]; 0 is isotropic, 1 is Lambert's law.
AngularProfile cosine_power_profile(double exponent);

}  // namespace photorque
