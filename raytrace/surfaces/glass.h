// Clear glass in front of a surface: reflection by Fresnel's law, and the path that the light
// behind it does.
//
// With R(θ) the unpolarised reflectance of the glass's front, which depends on the angle and on the
// refractive index, the fractions of an OpticalSurface describe the base behind the glass:
//
// - matt (diffuse d): of the light that enters d leaves again, scattered. The specular fraction
//   is R, the diffuse one (1 − R) d with density (1 − R(θ_o)) cos θ_o/(π (1 − R̄)), as it has to be
//   for f(i, o) = f(o, i), where R̄ = ∫ 2 μ R dμ.
// - cell (specular s): a base below the glass reflects s at each meeting. With the inner
//   reflections between it and the front the specular fraction is R + (1 − R)² s/(1 − R s).
// - pane (transmittance t): both faces of a sheet that passes t on a way straight through it and
//   t^(1/cos θ') on a slanted one. With τ for that, R + (1 − R)² τ² R/(1 − R² τ²) is reflected
//   and (1 − R)² τ/(1 − R² τ²) goes straight on.
//
// and the rest is absorbed. Intensities add, not fields: sheets far thicker than the coherence
// length. A surface is one of the three; matt and cell are the same for s = d = 0.
#pragma once

#include "raytrace/surfaces/bsdf.h"

namespace photorque {

enum class GlassBase { matt, cell, pane };

// Matt, unless the surface has a specular or a transmitted fraction. The caller keeps the other two
// at zero.
GlassBase glass_base(const OpticalSurface& base);

// `base` behind glass of `index` ∈ [1, 10]. With `alpha` > 0, matt only, the front is rough: GGX
// facets with Fresnel's law on each (ggx.h), alpha the square of glTF's roughness; what they do not
// reflect at once enters. Keeps the BSDF's retroreflection out: it must have none.
OpticalSurface behind_glass(const OpticalSurface& base, double index, double alpha = 0.0);

// Reflection where air meets a clear dielectric.

// Cosine of the refracted ray inside a medium of `index` ≥ 1, by Snell's law.
double refracted_cosine(double cosine, double index);

// The fraction of unpolarised light reflected at the boundary from air to a medium of refractive
// index `index` ≥ 1 without absorption, for `cosine` ∈ [0, 1] of the angle of incidence outside:
// the mean of Fresnel's two polarisations. To rounding; 1 at grazing incidence
// (0 for an index of 1).
// Source: M. Born and E. Wolf, Principles of Optics, 7th ed., section 1.5.2, eqs. 21a and 33.
double fresnel_reflectance(double cosine, double index);

}  // namespace photorque
