// A surface with measured scattering: a table of f(θ_i, θ_o, φ), isotropic.
//
// The table is symmetrised (reciprocal_brdf()) and linear in each angle between nodes, which
// preserves f(i, o) = f(o, i). The reflectance ρ(θ_i) = ∫ f cos θ_o do, the leaving momentum and
// the distribution of directions are those of this interpolant, to rounding. Hence power and
// momentum balance. A peak narrower than the node spacing is broadened to the spacing.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "raytrace/surfaces/bsdf.h"

namespace photorque {

// Angles rise; each list contains at least one.
struct BrdfTable {
  std::vector<double> incidence_rad;  // from the normal, in [0, π/2]
  std::vector<double> scatter_rad;    // of the leaving light, from the normal, in [0, π/2]
  // Angle between the planes of incidence and scattering, in [0, π]: 0 is forward (mirror
  // direction), π is backward. Scattering is equal on both sides of the plane of incidence.
  std::vector<double> azimuth_rad;
  std::vector<double> brdf_1_sr;  // ≥ 0; [incidence][scatter][azimuth], the last fastest

  size_t index(size_t incidence, size_t scatter, size_t azimuth) const {
    return (incidence * scatter_rad.size() + scatter) * azimuth_rad.size() + azimuth;
  }
  double& at(size_t incidence, size_t scatter, size_t azimuth) {
    return brdf_1_sr[index(incidence, scatter, azimuth)];
  }
  double at(size_t incidence, size_t scatter, size_t azimuth) const {
    return brdf_1_sr[index(incidence, scatter, azimuth)];
  }
};

// A table with f(i, o) = f(o, i). Incidence and scattering have the same nodes, from 0 to π/2; the
// azimuth runs from 0 to π; along the normal f does not depend on the azimuth. Linear in each of
// the three angles between nodes.
struct ReciprocalBrdf : BrdfTable {
  // Root mean square of f(i, o) − f(o, i), divided by the root mean square of their mean, over
  // pairs that the table has in both directions; 0 if there are none.
  double asymmetry = 0.0;
};

// Symmetrises a table. A pair of directions gets the mean of both measured values, or the only
// measured one. Beyond its nodes the table is extended with its last values; if both directions are
// beyond, the one that is less far beyond counts.
ReciprocalBrdf reciprocal_brdf(const BrdfTable& table);

// Position of an angle among rising nodes: between `below` and `below` + 1, at the fraction
// `part` ∈ [0, 1].
struct NodePlace {
  size_t below = 0;
  double part = 0.0;
};
NodePlace place_among(const std::vector<double>& nodes, double angle);

struct MeasuredSurface {
  OpticalSurface surface;  // fractions at normal incidence
  // Largest ρ over the bands, and its angle. The caller rejects a value above 1, which would
  // violate conservation of energy.
  double largest_reflectance = 0.0;
  double at_incidence_rad = 0.0;
  double asymmetry = 0.0;  // of the table, see ReciprocalBrdf
};

// A surface with the BRDF of the table times `scale` (> 0) per band; the rest of the light is
// absorbed.
MeasuredSurface measured_surface(std::string name, const BrdfTable& table, const BandValues& scale);

}  // namespace photorque
