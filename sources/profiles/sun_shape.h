// Sun shapes: how radiance falls from the middle of the Sun outwards, aureole included.
#pragma once

#include <functional>
#include <vector>

#include "sources/profiles/sampling.h"

namespace photorque {

// Radiance about an axis, of any scale, in pieces within each of which it is smooth; between them
// it may jump. Directions are drawn from an inverse table of the encircled flux, to 1e-8 of it.
class SunShape {
 public:
  // Pieces rise from the axis and join; at least one radiance is positive.
  explicit SunShape(std::vector<RadialPiece> pieces);

  // Over the largest; 0 beyond the last piece.
  double radiance(double angle_rad) const;
  // The mean of cos θ over the light.
  double mean_cosine() const { return mean_cosine_; }
  // 1 − cos θ of the cone about the middle that holds `fraction` ∈ (0, 1) of the light.
  double rise_within(double fraction) const { return sampler_.rise(fraction); }
  // Where pieces end, rising.
  std::vector<double> edges_rad() const;

 private:
  std::vector<RadialPiece> pieces_;
  PlaneSampler sampler_;
  double largest_ = 0.0;
  double mean_cosine_ = 1.0;
};

// A disc in the sky that is brighter in its middle than at its edge, as stars are.
//
// Radiance L(μ)/L(1) = 1 − u₁ (1 − μ) − u₂ (1 − μ)², μ the cosine between the line of sight and the
// normal of the star's surface: μ² = 1 − (sin θ/sin α)² at an angle θ from the middle of a disc of
// angular radius α ∈ (0, π/4]. u₁ ≥ 0, u₁ + 2 u₂ ≥ 0, u₁ + u₂ ≤ 1: falls to no less than 0. The Sun
// in visible light has about u₁ = 0.47, u₂ = 0.23 (550 nm).
// Source of the law: A. N. Cox, ed., Allen's Astrophysical Quantities, 4th ed., section 14.7.
SunShape limb_darkened_disc(double angular_radius_rad, double u1, double u2);

// exp(−θ²/2σ²), σ ∈ (0, π/24]: the angles along each of two axes have the standard deviation σ.
// Cut at 6 σ, where 2e-8 of the light is outside.
SunShape gaussian_sun(double sigma_rad);

// A disc of 4.65 mrad with an aureole out to 43.6 mrad, θ in mrad:
//   cos 0.326 θ/cos 0.308 θ   within the disc,
//   e^κ θ^γ                   in the aureole, κ = 0.9 ln(13.5 χ) χ^−0.3,
//                             γ = 2.2 ln(0.52 χ) χ^0.43 − 0.1.
// The circumsolar ratio is the flux of the aureole over that of disc and aureole together. With χ
// equal to the ratio the law gives another ratio (0.0058 for 0.02, 0.373 for 0.4). Here χ is the
// root for which it gives `circumsolar_ratio` ∈ [0.0001, 0.84] to 1e-9.
// Source: D. Buie, A. G. Monger, C. J. Dey, Sunshape distributions for terrestrial solar
// simulations, Solar Energy 74 (2003) 113, equations 1 and 4 to 6.
SunShape buie_sun(double circumsolar_ratio);

// Linear in θ between measured radiances ≥ 0 at angles that rise from 0 to at most π/4, at least
// two; no light beyond.
SunShape tabulated_sun(const std::vector<double>& angle_rad, const std::vector<double>& radiance);

}  // namespace photorque
