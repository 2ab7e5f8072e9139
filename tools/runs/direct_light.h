// Direct light by gathering, and its comparison with the direct light of the rays.
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
  size_t receiver = 0;  // index among the experiment's receivers
  std::string name;
  Estimate gathered_W, rays_W;
  double difference_sigma = 0.0;  // of the totals, in standard errors of both
  // Mean of (difference/error)² over the bins with enough rays; about 1 + 2/replicates.
  double mean_square = 0.0;
  // Pairs of bins and beams, by quadrature and by shadow rays.
  size_t open_pairs = 0, shaded_pairs = 0;
  uint64_t shadow_rays = 0;
};

// Comparison of the torque of direct light on a torque map, or of its wrench on a body, by
// quadrature and by rays.
struct DirectTorque {
  std::string name;
  double worst_sigma = 0.0;  // largest difference of a component, in standard errors of both
};

// Results that were computed by gathering.
struct DirectRoute {
  std::vector<DirectLight> gathered;   // by flux map; empty if only rays were possible
  std::vector<DirectTorque> torques;   // by torque map; empty if only rays were possible
  std::vector<DirectTorque> wrenches;  // by wrench; empty if only rays were possible
  // one line for each map for which gathering would take too long
  std::vector<std::string> notices;
};

// Replaces the direct light of every flat flux map in `result`, its torque on every flat torque
// map, and its wrench on bodies, by the results of gather_direct(), gather_torque() and `bodies`.
// Applies if the experiment requires it and sources and surfaces permit it; experiments with a
// target error always gather, except with "rays". Returns the comparison with the rays. `bodies`
// belongs to the experiment's beams, or is null.
DirectRoute gather_into(const Experiment& experiment, const TraceableScene& scene,
                        const WrenchGather* bodies, const RigidTransform& lab_from_body,
                        const TraceOptions& options, TraceResult& result);

// Error of a power that is a count of rays, if the replicates do not show it: Sobol points can meet
// a surface equally often in all replicates and still be off by part of a ray in each. One ray per
// replicate, in the mean over all.
inline double counting_error_W(const TraceResult& result, int replicates) {
  return result.sent_W / static_cast<double>(result.rays) * std::sqrt(replicates);
}

// Largest relative standard error of the bins of all flux maps that exceed a tenth of their map's
// maximum irradiance.
double worst_bin_error(const Experiment& experiment, const TraceResult& result);

}  // namespace photorque
