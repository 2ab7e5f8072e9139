// A surface whose scattering was measured: a table of f(θ_i, θ_o, φ), isotropic.
//
// The table is made reciprocal (brdf_table.h) and is linear in each of its angles between nodes,
// which keeps f(i, o) = f(o, i). The reflectance ρ(θ_i) = ∫ f cos θ_o do, the momentum that leaves
// and the distribution of directions are those of this interpolant, to rounding, so that power and
// momentum balance. A peak narrower than the nodes are apart comes out as wide as they are.
#pragma once

#include <string>

#include "raytrace/surfaces/brdf_table.h"
#include "raytrace/surfaces/bsdf.h"

namespace photorque {

struct MeasuredSurface {
  OpticalSurface surface;  // fractions at normal incidence
  // The largest ρ, over the bands, and where. Above 1 the surface would shine: the caller refuses.
  double largest_reflectance = 0.0;
  double at_incidence_rad = 0.0;
  double asymmetry = 0.0;  // of the table, see ReciprocalBrdf
};

// The table times `scale` (> 0) per band; what is not reflected is absorbed.
MeasuredSurface measured_surface(std::string name, const BrdfTable& table, const BandValues& scale);

}  // namespace photorque
