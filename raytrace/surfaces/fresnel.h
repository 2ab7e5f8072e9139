// Reflection where air meets a clear dielectric.
#pragma once

namespace photorque {

// Cosine of the refracted ray inside a medium of `index` ≥ 1, by Snell's law.
double refracted_cosine(double cosine, double index);

// The fraction of unpolarised light reflected at the boundary from air to a medium of refractive
// index `index` ≥ 1 without absorption, for `cosine` ∈ [0, 1] of the angle of incidence outside:
// the mean of Fresnel's two polarisations. To rounding; 1 at grazing incidence
// (0 for an index of 1).
// Source: M. Born and E. Wolf, Principles of Optics, 7th ed., section 1.5.2, eqs. 21a and 33.
double fresnel_reflectance(double cosine, double index);

}  // namespace photorque
