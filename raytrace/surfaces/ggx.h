// Microfacets of Trowbridge and Reitz ("GGX") with Smith's masking, shared by rough surfaces.
//
// The facet normals have the density D(h) = α²/(π (h_z² (α² − 1) + 1)²). The fraction of facets
// that is neither masked nor shadowed is G2 = 1/(1 + Λ(i) + Λ(o)) with
// Λ(μ) = (√(1 + α² tan²) − 1)/2. It includes the correlation of masking and shadowing by height.
// Source: B. Walter et al., "Microfacet Models for Refraction through Rough Surfaces" (EGSR 2007),
// eqs. 20, 33, 34; E. Heitz, "Understanding the Masking-Shadowing Function" (JCGT 3(2), 2014),
// eqs. 72, 99.
#pragma once

#include <functional>

#include "core/transform.h"
#include "raytrace/surfaces/cosine_table.h"

namespace photorque {

struct Ggx {
  double alpha;  // in (0, 1]; the root mean square slope is infinite because GGX has long tails

  // Smith's Λ at the cosine of the angle from the normal.
  double lambda(double cosine) const;
  // Density of facet normals D(h) [1/sr].
  double distribution(const Vec3& normal) const;
  // Draws the normal of a facet visible from i, in proportion to its projected area. `u`, `v` ∈ (0,
  // 1).
  // Source: E. Heitz, "Sampling the GGX Distribution of Visible Normals" (JCGT 7(4), 2018).
  Vec3 visible_normal(const Vec3& towards_light, double u, double v) const;
  // G2/G1: probability that light from i, reflected to o by a visible facet, leaves the surface.
  // Zero below the horizon.
  double leaves(double cosine_in, double cosine_out) const;
  // D G2/(4 cos θ_i): density of o after one reflection, before multiplication by the facets'
  // reflectance.
  double once_reflected_1_sr(const Vec3& towards_light, const Vec3& out) const;

  // Moments of light from `cosine` (< 1) after one reflection by facets with the reflectance
  // `of_facet`(cosine at the facet): reflected power; mean of o_x over sin θ_i; mean of o_z. Both
  // means are weighted by power. By quadrature, error 1e-4.
  using Moments = std::array<double, 3>;
  Moments moments(double cosine, const std::function<double(double)>& of_facet) const;
};

// Unit vector (sin θ, 0, cos θ) towards the light in the frame of the hit; `cosine` ∈ [0, 1].
Vec3 direction_at(double cosine);

}  // namespace photorque
