// Direct light both ways: gathered from the surface's side, and by the rays that it is checked
// with.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "raytrace/tracing/tracer.h"
#include "receivers/gather/gather.h"
#include "scenes/experiment/experiment.h"

namespace photorque {

class WrenchGather;  // receivers/gather/bodies/wrench.h

// Comparison of direct light on a flux map by quadrature and by rays.
struct DirectLight {
  size_t receiver = 0;  // its place among the experiment's
  std::string name;
  Estimate gathered_W, rays_W;
  double difference_sigma = 0.0;  // of the totals, in standard errors of both
  // Mean of (difference/error)² over the bins that the rays light well; about 1 + 2/replicates.
  double mean_square = 0.0;
  size_t open_pairs = 0, shaded_pairs = 0;  // of bins and beams: by quadrature, by shadow rays
  uint64_t shadow_rays = 0;
};

// Comparison of the torque of direct light on a torque map, or of its wrench on a body, by
// quadrature and by rays.
struct DirectTorque {
  std::string name;
  double worst_sigma = 0.0;  // largest difference of a component in standard errors of both
};

// Which way the direct light went.
struct DirectRoute {
  std::vector<DirectLight> gathered;   // by flux map; empty where rays alone had to do
  std::vector<DirectTorque> torques;   // by torque map, likewise
  std::vector<DirectTorque> wrenches;  // by wrench, likewise
  std::vector<std::string> notices;  // one line for each map that was left to the rays for its cost
};

// Replaces the direct light of every flat flux map in `result`, its torque on every flat torque
// map, and its wrench on bodies, by what gather_direct(), gather_torque() and `bodies` find, where
// the experiment requires it and sources and surfaces allow it, and says how it agrees with the
// rays' own. An experiment with a target error always gathers, unless it says "rays". `bodies` is
// of the experiment's beams, or null.
DirectRoute gather_into(const Experiment& experiment, const TraceableScene& scene,
                        const WrenchGather* bodies, const RigidTransform& lab_from_body,
                        const TraceOptions& options, TraceResult& result);

// The error of a power that counts rays, where the replicates do not show it: Sobol points can meet
// a surface equally often in all of them, and still be off by part of a ray in each. One ray of
// each replicate, in the mean of all.
inline double counting_error_W(const TraceResult& result, int replicates) {
  return result.sent_W / static_cast<double>(result.rays) * std::sqrt(replicates);
}

// Largest relative standard error of any bin of any flux map with more than a tenth of the map's
// largest irradiance.
double worst_bin_error(const Experiment& experiment, const TraceResult& result);

}  // namespace photorque
