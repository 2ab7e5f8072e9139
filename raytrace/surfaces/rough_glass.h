// The rough front of a clear dielectric: GGX microfacets that reflect by Fresnel's law.
//
// The lobe is what one reflection sends away, of power E(μ) = ∫ F(i·h) D G2/(4 μ) do. It is
// reciprocal; whatever it does not send away counts as entering the glass (glass.h), so nothing is
// lost.
#pragma once

#include "raytrace/surfaces/bsdf.h"
#include "raytrace/surfaces/ggx.h"

namespace photorque {

class RoughGlass final : public Lobe {
 public:
  // `alpha` ∈ [0.001, 1], `index` ∈ (1, 10].
  RoughGlass(double alpha, double index);

  // E at `cosine`. To 1e-4, from a table.
  double reflectance(double cosine) const { return once_(cosine)[0]; }

  Vec3 direction(double cosine, const Draw& draw) const override;
  Vec3 mean_direction(double cosine) const override;
  double density(double cosine, const Vec3& out) const override;

 private:
  Ggx facets_;
  double index_;
  CosineTable<3> once_;  // power, sums of o_x and o_z
};

// The same, to be shared by a Bsdf and the law behind it.
std::shared_ptr<const RoughGlass> rough_glass(double alpha, double index);

}  // namespace photorque
