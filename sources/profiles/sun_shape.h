// Sun shapes: radiance of the Sun over the angle from its centre, including the aureole.
#pragma once

#include <vector>

#include "sources/profiles/sampling.h"

namespace photorque {

// Radiance about an axis, of arbitrary scale, in pieces. It is smooth within each piece and may
// jump between them. Directions are drawn from an inverse table of the encircled flux, with an
// error of 1e-8 of the flux.
class SunShape {
 public:
  // Pieces adjoin and rise from the axis; at least one radiance is positive.
  explicit SunShape(std::vector<RadialPiece> pieces);

  // Radiance relative to the largest; 0 beyond the last piece.
  double radiance(double angle_rad) const;
  // Mean of cos θ over the light.
  double mean_cosine() const { return mean_cosine_; }
  // 1 − cos θ of the cone about the centre that contains `fraction` ∈ (0, 1) of the light.
  double rise_within(double fraction) const { return sampler_.rise(fraction); }
  // Angles at which pieces end, rising.
  std::vector<double> edges_rad() const;

 private:
  std::vector<RadialPiece> pieces_;
  PlaneSampler sampler_;
  double largest_ = 0.0;
  double mean_cosine_ = 1.0;
};

// A disc with limb darkening.
//
// Radiance L(μ)/L(1) = 1 − u₁ (1 − μ) − u₂ (1 − μ)². μ is the cosine between the line of sight and
// the normal of the star's surface: μ² = 1 − (sin θ/sin α)² at an angle θ from the centre of a disc
// of angular radius α ∈ (0, π/4]. Required: u₁ ≥ 0, u₁ + 2 u₂ ≥ 0, u₁ + u₂ ≤ 1, so that L falls
// towards the edge and stays ≥ 0. The Sun in visible light has about u₁ = 0.47, u₂ = 0.23 (550 nm).
// Source of the law: A. N. Cox, ed., Allen's Astrophysical Quantities, 4th ed., section 14.7.
SunShape limb_darkened_disc(double angular_radius_rad, double u1, double u2);

// exp(−θ²/2σ²), σ ∈ (0, π/24]: the angles along each of two axes have the standard deviation σ. Cut
// at 6 σ; 2e-8 of the light is outside.
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

// Radiance that is linear in θ between at least two measured values ≥ 0, at angles that rise from 0
// to at most π/4; no light beyond.
SunShape tabulated_sun(const std::vector<double>& angle_rad, const std::vector<double>& radiance);

}  // namespace photorque
