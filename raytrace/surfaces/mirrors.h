// Mirrors that are not perfectly flat: rough (GGX) and with slope errors.
#pragma once

#include <memory>

#include "raytrace/surfaces/bsdf.h"

namespace photorque {

// A rough mirror: lossless GGX microfacets.
//
// At cosine μ a fraction 1 − E(μ) of the light does not leave after one reflection and is reflected
// again until it leaves. It gets the density (1 − E(μ_o)) μ_o/(π (1 − Ē)), with Ē = ∫ 2 μ E dμ.
// This is the only density that is reciprocal, loses no power and depends on E alone. Hence a
// surface's specular fraction is its reflectance at every angle, and absorptance + reflectance = 1.
// Source: C. Kulla and A. Conty, "Revisiting Physically Based Shading at Imageworks" (SIGGRAPH
// course, 2017).
//
// `alpha` ∈ [0.001, 1] is the square of glTF's roughness. Momenta have an error of 1e-4 of power/c.
std::shared_ptr<const Lobe> rough_mirror(double alpha);

// Distribution of the slopes of a surface with slope errors.
enum class SlopeShape {
  gaussian,  // independent along two axes, with a standard deviation for each
  pillbox,   // uniform over an ellipse with two semi-axes
};

// A mirror with slope errors, as they are stated for solar concentrators.
//
// The surface normal is tilted by slopes (tangents) along two axes. A reflected ray deviates by
// twice the slope in the plane of incidence, and by twice the slope times cos θ across it. On a
// surface seen at a slant, the parts tilted towards the viewer appear larger by 1 + s tan θ for a
// slope s towards it, clamped to [0, 2]. With this factor the scattering is reciprocal; it is exact
// for slopes far below cot θ. No power is lost.
// Source of the convention: F. Biggs and C. N. Vittitoe, The Helios Model for the Optical Behavior
// of Reflecting Solar Concentrators (SAND76-0347, 1979).
//
// Slopes ∈ (0, 0.2]: the standard deviation or semi-axis along Bsdf::axis and across it. Momenta
// have an error of 1e-6 of power/c, with unequal axes 1e-5.
std::shared_ptr<const Lobe> slope_error(double first_rad, double second_rad, SlopeShape shape);
inline std::shared_ptr<const Lobe> slope_error(double slope_rad,
                                               SlopeShape shape = SlopeShape::gaussian) {
  return slope_error(slope_rad, slope_rad, shape);
}

}  // namespace photorque
