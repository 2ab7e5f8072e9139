// The microfacets of Trowbridge and Reitz ("GGX") with Smith's masking, shared by rough surfaces.
//
// Slopes are spread with D(h) = α²/(π (h_z² (α² − 1) + 1)²); facets hide one another by
// G2 = 1/(1 + Λ(i) + Λ(o)) with Λ(μ) = (√(1 + α² tan²) − 1)/2, which counts that height hides and
// shades together.
// Source: B. Walter et al., "Microfacet Models for Refraction through Rough Surfaces" (EGSR 2007),
// eqs. 20, 33, 34; E. Heitz, "Understanding the Masking-Shadowing Function" (JCGT 3(2), 2014),
// eqs. 72, 99.
#pragma once

#include <functional>

#include "core/transform.h"
#include "raytrace/surfaces/cosine_table.h"

namespace photorque {

struct Ggx {
  double alpha;  // (0, 1]; the root mean square slope is not defined: GGX has long tails

  double lambda(double cosine) const;
  // D(h) [1/sr] of the facets' normal.
  double distribution(const Vec3& normal) const;
  // A facet that is seen from i, in proportion to its area as seen. `u`, `v` ∈ (0, 1).
  // Source: E. Heitz, "Sampling the GGX Distribution of Visible Normals" (JCGT 7(4), 2018).
  Vec3 visible_normal(const Vec3& towards_light, double u, double v) const;
  // G2/G1: the chance that light from i, reflected to o by a facet seen from i, gets away. Zero
  // below the horizon.
  double leaves(double cosine_in, double cosine_out) const;
  // D G2/(4 cos θ_i): the density of o after one reflection, times the reflectance of the facets.
  double once_reflected_1_sr(const Vec3& towards_light, const Vec3& out) const;

  // Moments of light from `cosine` (below 1), reflected once by facets with the reflectance
  // `of_facet`(cosine at the facet): reflected power, mean of o_x over sin θ_i, mean of o_z, both
  // weighted by power. By quadrature, to 1e-4.
  using Moments = std::array<double, 3>;
  Moments moments(double cosine, const std::function<double(double)>& of_facet) const;
};

// The unit vector (sin θ, 0, cos θ) towards the light of a hit in its own frame; `cosine` ∈ [0, 1].
Vec3 direction_at(double cosine);

}  // namespace photorque
