// Direct light on a flat surface, and its torque, integrated over the surface without ray tracing.
//
// There are three cases for a bin and an aperture. If provably nothing is in between, the light is
// a quadrature (raytrace/direct/disc_light.h) without noise. If a convex body provably hides the
// whole aperture, there is no light. Otherwise shadow rays connect scrambled Sobol points of
// aperture and bin. The proofs use shafts: the convex hull of two balls around the bins and around
// the part of the aperture that can light them. Shafts are tested against bodies and triangles for
// smaller and smaller groups of bins.
//
// Source of the idea: E. A. Haines, J. R. Wallace, "Shaft Culling for Efficient Ray-Cast Radiosity"
// (1991).
#pragma once

#include <span>

#include "raytrace/tracing/tracer.h"
#include "receivers/flux_map.h"
#include "receivers/torque_map.h"

namespace photorque {

struct GatherOptions {
  int replicates = 16;  // ≥ 2
  uint64_t seed = 1;
  int points = 16;  // rays per replicate, bin and beam for bins that may be shaded: a power of two
  // Rays per replicate on bodies, in total, for the facets that may be shaded (bodies/wrench.h).
  int body_points = 1 << 13;
  int threads = 0;  // 0: all
  // Doubles `points` until every bin with more than `floor` of the largest irradiance has this
  // relative standard error, or until `points` is 16384. 0: no refinement.
  double target_error = 0.0;
  double floor = 0.1;
};

struct Gathered {
  // Direct entries of the flux map per replicate, with the error bounds of the quadrature.
  BinSums direct;
  size_t open_pairs = 0;  // pairs of a bin and a beam that are computed by quadrature
  size_t shaded_pairs = 0;
  uint64_t shadow_rays = 0;
  double worst_error = 0.0;  // largest relative standard error of the bins above `floor`
};

// Whether gather_direct() applies: a flat map, counting one side, whose absorption does not depend
// on the angle (no glass in front), and beams with uniform apertures.
bool can_gather(const Scene& scene, const SurfaceGrid& grid, std::span<const Beam> beams);

// Estimated single-thread times [s] for gathering over pairs of a bin and a lamp, and for rays
// without bounces (docs/benchmarks.md). An open pair takes 0.06 µs, a pair that needs shadow rays
// 0.5 µs. Their numbers are not known beforehand; most pairs are open.
double gathering_cost_s(size_t pairs);
double tracing_cost_s(uint64_t rays);

// Whether gathering is worth its time. It is not if it would take seconds and several times as long
// as the rays, as for thousands of lamps on one map.
bool gathering_pays(size_t pairs, uint64_t rays);

// Light on `map` directly from the beams, at the attitude `lab_from_body`. All surfaces in between
// shade completely, even transparent ones; raytrace/tracing/tracer.h traces the light that they
// transmit. The result has the same bits for any number of threads.
Gathered gather_direct(const TraceableScene& scene, const RigidTransform& lab_from_body,
                       std::span<const Beam> beams, const FluxMapReceiver& map,
                       const GatherOptions& options);

// Torque. With the force f per area of FirstContact (lamp.h), torques per bin are integrals of
// (r − p) × f by the same rules as irradiance. Later bounces come from rays.

// Whether gather_torque() applies: the conditions of can_gather() for both sides, and surfaces with
// fractions that do not depend on the angle and without other components.
bool can_gather_torque(const Scene& scene, const SurfaceGrid& grid, std::span<const Beam> beams);

// Direct entries of the torque map, at the attitude `lab_from_body`; see gather_direct().
// `target_error` is not used.
Gathered gather_torque(const TraceableScene& scene, const RigidTransform& lab_from_body,
                       std::span<const Beam> beams, const TorqueMapReceiver& map,
                       const GatherOptions& options);

}  // namespace photorque
