// A rough mirror: GGX microfacets that lose nothing.
//
// Light that one reflection does not bring away from the facets, a fraction 1 − E(μ) at cosine μ,
// meets others until it leaves. It is given the only shape that is reciprocal, loses nothing and
// needs no more than E: density (1 − E(μ_o)) μ_o/(π (1 − Ē)), with Ē = ∫ 2 μ E dμ. A surface's
// specular fraction is therefore its reflectance at every angle, and absorptance + reflectance = 1.
// Source: C. Kulla and A. Conty, "Revisiting Physically Based Shading at Imageworks" (SIGGRAPH
// course, 2017).
#pragma once

#include <memory>

#include "raytrace/surfaces/bsdf.h"

namespace photorque {

// `alpha` ∈ [0.001, 1]: the square of glTF's roughness. Momenta to 1e-4 of the power over c.
std::shared_ptr<const Lobe> rough_mirror(double alpha);

}  // namespace photorque
