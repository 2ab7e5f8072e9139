// A disc in the sky that is brighter in its middle than at its edge, as stars are.
//
// Radiance L(μ)/L(1) = 1 − u₁ (1 − μ) − u₂ (1 − μ)², μ the cosine between the line of sight and the
// normal of the star's surface: μ² = 1 − (sin θ/sin α)² at an angle θ from the middle of a disc of
// angular radius α. The Sun in visible light has about u₁ = 0.47, u₂ = 0.23 (550 nm).
// Source of the law: A. N. Cox, ed., Allen's Astrophysical Quantities, 4th ed., section 14.7.
#pragma once

#include <vector>

namespace photorque {

class LimbDarkening {
 public:
  // `angular_radius_rad` ∈ (0, π/4]; u₁ ≥ 0, u₁ + 2 u₂ ≥ 0, u₁ + u₂ ≤ 1: falls to no less than 0.
  LimbDarkening(double angular_radius_rad, double u1, double u2);

  // Over that of the middle; `cosine` is μ.
  double radiance(double cosine) const;
  // μ at θ ≤ α.
  double cosine_at(double angle_rad) const;

  // The mean of cos θ over the light.
  double mean_cosine() const { return mean_cosine_; }
  // 1 − cos θ of the cone about the middle that holds `fraction` ∈ [0, 1] of the light. To 1e-6 of
  // the disc's.
  double rise_within(double fraction) const;

  // Circles about the middle, rising to the disc's edge, between which L is a smooth function of
  // 1 − cos θ: at the edge its slope is infinite, so they crowd there.
  std::vector<double> edges_rad() const;

 private:
  double rise_at(double cosine) const;

  double sine2_;  // sin²α
  double u1_, u2_;
  double mean_cosine_ = 1.0;
  std::vector<double> cosine_of_fraction_;  // μ at even steps of the fraction
};

}  // namespace photorque
