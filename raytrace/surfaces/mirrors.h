// Mirrors that are not flat: rough ones (GGX) and ones with slope errors.
#pragma once

#include <memory>

#include "raytrace/surfaces/bsdf.h"

namespace photorque {

// A rough mirror: GGX microfacets that lose nothing.
//
// Light that one reflection does not bring away from the facets, a fraction 1 − E(μ) at cosine μ,
// meets others until it leaves. It is given the only shape that is reciprocal, loses nothing and
// needs no more than E: density (1 − E(μ_o)) μ_o/(π (1 − Ē)), with Ē = ∫ 2 μ E dμ. A surface's
// specular fraction is therefore its reflectance at every angle, and absorptance + reflectance = 1.
// Source: C. Kulla and A. Conty, "Revisiting Physically Based Shading at Imageworks" (SIGGRAPH
// course, 2017).
//
// `alpha` ∈ [0.001, 1]: the square of glTF's roughness. Momenta to 1e-4 of the power over c.
std::shared_ptr<const Lobe> rough_mirror(double alpha);

// Distribution of the slopes of a surface with slope errors.
enum class SlopeShape {
  gaussian,  // independent along two axes, with a standard deviation for each
  pillbox,   // even over an ellipse with two semi-axes
};

// A mirror that is not quite flat: slope errors as solar concentrators state them.
//
// The surface's normal leans by slopes (tangents) along two axes. A reflected ray strays by twice
// the slope in the plane of incidence, and by twice the slope times cos θ across it. Of a surface
// seen at a slant the parts that lean towards the viewer show more, by 1 + s tan θ for a slope s
// towards it, cut to [0, 2]: with it the scattering is reciprocal, and for slopes far below cot θ
// it is exact. Nothing is lost.
// Source of the convention: F. Biggs and C. N. Vittitoe, The Helios Model for the Optical Behavior
// of Reflecting Solar Concentrators (SAND76-0347, 1979).
//
// Slopes ∈ (0, 0.2]: the standard deviation or semi-axis along Bsdf::axis and across it. Momenta to
// 1e-6 of the power over c, with unequal axes to 1e-5.
std::shared_ptr<const Lobe> slope_error(double first_rad, double second_rad, SlopeShape shape);
inline std::shared_ptr<const Lobe> slope_error(double slope_rad,
                                               SlopeShape shape = SlopeShape::gaussian) {
  return slope_error(slope_rad, slope_rad, shape);
}

}  // namespace photorque
