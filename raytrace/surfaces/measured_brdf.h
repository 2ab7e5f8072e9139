// A surface whose scattering was measured: a table of f(θ_i, θ_o, φ), isotropic.
//
// The table is made reciprocal (reciprocal_brdf()) and is linear in each of its angles between
// nodes, which keeps f(i, o) = f(o, i). The reflectance ρ(θ_i) = ∫ f cos θ_o do, the momentum that
// leaves and the distribution of directions are those of this interpolant, to rounding, so that
// power and momentum balance. A peak narrower than the nodes are apart comes out as wide as they
// are.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "raytrace/surfaces/bsdf.h"

namespace photorque {

// Angles rise; each list holds at least one.
struct BrdfTable {
  std::vector<double> incidence_rad;  // from the normal, in [0, π/2]
  std::vector<double> scatter_rad;    // of the light that leaves, the same
  // Between the planes of the two, in [0, π]: 0 is forward, where a mirror sends light, π is back
  // towards where it came from. Scattering is the same on both sides of the plane of incidence.
  std::vector<double> azimuth_rad;
  std::vector<double> brdf_1_sr;  // ≥ 0; [incidence][scatter][azimuth], the last fastest

  double& at(size_t incidence, size_t scatter, size_t azimuth) {
    return brdf_1_sr[(incidence * scatter_rad.size() + scatter) * azimuth_rad.size() + azimuth];
  }
};

// A table with f(i, o) = f(o, i): incidence and scattering share their nodes, from 0 to π/2, the
// azimuth runs from 0 to π, and along the normal f does not depend on it. Linear in each of the
// three angles between nodes.
struct ReciprocalBrdf {
  std::vector<double> polar_rad, azimuth_rad;
  std::vector<double> brdf_1_sr;  // [incidence][scatter][azimuth]
  // Root mean square of f(i, o) − f(o, i) over that of their mean, where the table had both; 0
  // where it had none.
  double asymmetry = 0.0;

  double at(size_t incidence, size_t scatter, size_t azimuth) const {
    return brdf_1_sr[index(incidence, scatter, azimuth)];
  }
  size_t index(size_t incidence, size_t scatter, size_t azimuth) const {
    return (incidence * polar_rad.size() + scatter) * azimuth_rad.size() + azimuth;
  }
};

// Both ways of a pair of directions get the mean of what was measured both ways, or the one that
// was measured. Beyond its nodes the table stays as it is at the last; where both ways are beyond,
// the one that is so by less counts.
ReciprocalBrdf reciprocal_brdf(const BrdfTable& table);

// Where an angle lies between nodes that rise: between `below` and `below` + 1, at `part` ∈ [0, 1].
struct NodePlace {
  size_t below = 0;
  double part = 0.0;
};
NodePlace place_among(const std::vector<double>& nodes, double angle);

struct MeasuredSurface {
  OpticalSurface surface;  // fractions at normal incidence
  // The largest ρ, over the bands, and where. Above 1 the surface would shine: the caller refuses.
  double largest_reflectance = 0.0;
  double at_incidence_rad = 0.0;
  double asymmetry = 0.0;  // of the table, see ReciprocalBrdf
};

// The table times `scale` (> 0) per band; the rest of the light is absorbed.
MeasuredSurface measured_surface(std::string name, const BrdfTable& table, const BandValues& scale);

}  // namespace photorque
