// Clear glass in front of a surface: reflection by Fresnel's law, and the light that passes through
// the glass to the base and back.
//
// R(θ) is the unpolarised reflectance of the glass's front; it depends on the angle and on the
// refractive index. The fractions of an OpticalSurface describe the base behind the glass:
//
// - matt (diffuse d): the fraction d of the light that enters leaves again, scattered. The specular
//   fraction is R, the diffuse fraction (1 − R) d. The density of the diffuse light is
//   (1 − R(θ_o)) cos θ_o/(π (1 − R̄)), R̄ = ∫ 2 μ R dμ, which is required for f(i, o) = f(o, i).
// - cell (specular s): a base below the glass reflects s each time light meets it. Including inner
//   reflections between base and front, the specular fraction is R + (1 − R)² s/(1 − R s).
// - pane (transmittance t): both faces of a sheet that transmits t at normal incidence and
//   τ = t^(1/cos θ') along a slanted path. R + (1 − R)² τ² R/(1 − R² τ²) is reflected and
//   (1 − R)² τ/(1 − R² τ²) is transmitted without change of direction.
//
// The rest is absorbed. Intensities are added, without interference: the glass is far thicker than
// the coherence length. Every surface has one of the three types. Matt and cell agree if s = d = 0.
#pragma once

#include "raytrace/surfaces/bsdf.h"

namespace photorque {

enum class GlassBase { matt, cell, pane };

// Matt, unless the surface has a specular or a transmitted fraction. The other two fractions must
// be zero.
GlassBase glass_base(const OpticalSurface& base);

// `base` behind glass of `index` ∈ [1, 10]. With `alpha` > 0 (matt only) the front is rough: GGX
// facets that reflect by Fresnel's law (ggx.h); alpha is the square of glTF's roughness. Light that
// the facets do not send away in one reflection enters the glass. The base must have no
// retroreflection.
OpticalSurface behind_glass(const OpticalSurface& base, double index, double alpha = 0.0);

// Reflection where air meets a clear dielectric.

// Cosine of the refracted ray inside a medium of `index` ≥ 1, by Snell's law.
double refracted_cosine(double cosine, double index);

// Fraction of unpolarised light reflected at the boundary from air to a lossless medium of
// refractive index `index` ≥ 1, for `cosine` ∈ [0, 1] of the angle of incidence in air: the mean of
// Fresnel's two polarisations. Exact to rounding; 1 at grazing incidence (0 for an index of 1).
// Source: M. Born and E. Wolf, Principles of Optics, 7th ed., section 1.5.2, eqs. 21a and 33.
double fresnel_reflectance(double cosine, double index);

}  // namespace photorque
