// Direct light on a flat surface, and its torque, gathered from the surface's side.
//
// Between a bin and an aperture either provably nothing stands, and the light is a quadrature
// (raytrace/direct/disc_light.h) without noise, or a convex body provably stands before all of the
// aperture, or shadow rays to scrambled Sobol points of aperture and bin are weighed. The proofs
// are by shafts: the convex hull of two balls about the bins and about the part of the aperture
// that can light them, tested against bodies and triangles, for smaller and smaller groups of bins.
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
  int points = 16;  // per replicate, bin and beam, where there may be shadow: a power of two
  // On bodies, per replicate and in all, for the facets that may be shaded (bodies/wrench.h).
  int body_points = 1 << 13;
  int threads = 0;  // 0: all
  // Doubles `points` until every bin with more than `floor` of the largest irradiance has this
  // relative standard error, or `points` is 16384; 0: once.
  double target_error = 0.0;
  double floor = 0.1;
};

struct Gathered {
  // The direct entries of the flux map, replicate by replicate, with the error of the quadrature
  // as it was estimated for each.
  BinSums direct;
  size_t open_pairs = 0;  // of a bin and a beam, by quadrature
  size_t shaded_pairs = 0;
  uint64_t shadow_rays = 0;
  double worst_error = 0.0;  // relative standard error of the bins that `floor` names
};

// Whether gather_direct() applies: a flat map, one side of it that absorbs the same at every angle
// (no glass in front), and beams with uniform apertures.
bool can_gather(const Scene& scene, const SurfaceGrid& grid, std::span<const Beam> beams);

// Rough times [s] of one thread: of gathering over pairs of a bin and a lamp, and of rays without
// bounces (docs/benchmarks.md). A pair that nothing can shade takes 0.06 µs, one that needs shadow
// rays 0.5 µs; which those are is not known beforehand, and most are open.
double gathering_cost_s(size_t pairs);
double tracing_cost_s(uint64_t rays);

// Whether gathering is worth its time: not when it would take seconds and several times as long as
// the rays, as with thousands of lamps on one map.
bool gathering_pays(size_t pairs, uint64_t rays);

// The light that comes to `map` straight from the beams, at the attitude `lab_from_body`. Surfaces
// in between shade, whatever they are made of; what they pass on is for raytrace/tracing/tracer.h.
// The result is the same bits at any number of threads.
Gathered gather_direct(const TraceableScene& scene, const RigidTransform& lab_from_body,
                       std::span<const Beam> beams, const FluxMapReceiver& map,
                       const GatherOptions& options);

// With the force f per area of FirstContact (lamp.h), torques per bin are integrals of (r − p) × f
// by the same rules as irradiance; later bounces come from rays.

// Whether gather_torque() applies: as can_gather(), for both sides, and surfaces whose fractions
// are the same for every angle and that send light nowhere else.
bool can_gather_torque(const Scene& scene, const SurfaceGrid& grid, std::span<const Beam> beams);

// The direct entries of the torque map, at the attitude `lab_from_body`; else as gather_direct().
// `target_error` is not used.
Gathered gather_torque(const TraceableScene& scene, const RigidTransform& lab_from_body,
                       std::span<const Beam> beams, const TorqueMapReceiver& map,
                       const GatherOptions& options);

}  // namespace photorque
