// Clear glass in front of a surface: reflection by Fresnel's law, and what the light behind it
// does.
//
// With R(θ) the unpolarised reflectance of the glass's front, which depends on the angle and on the
// refractive index, the fractions of an OpticalSurface tell what meets the light that enters:
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

}  // namespace photorque
