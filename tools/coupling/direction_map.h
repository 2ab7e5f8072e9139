// Wrench tables over directions of light or wind for a body in sunlight or in a gas flow, and
// methods that compute force and torque for one direction.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/snapshot.h"
#include "core/wrench.h"
#include "receivers/wrench/smoothing.h"
#include "tools/coupling/couple.h"
#include "tools/runs/optical_run.h"

namespace photorque {

struct DirectionMap {
  WrenchTable wrenches;  // of the whole scene, body frame
  RunResult result;
};

// Force and torque with the Sun or the wind in every direction of [torque_map]: by quadrature if
// the scene permits it, otherwise by rays. If the directions cover the sphere, the result contains
// the wrench per pressure as a file in the SPAD format. The experiment's only source must be a sun,
// or it has a gas flow. Directions are distributed over `threads` (0: all); `run` should use one
// thread. `watch` receives each node of sunlight, traced for display. With a checkpoint, finished
// nodes are saved periodically, and the run resumes from it.
DirectionMap map_over_directions(const Console& console, const OpticalRun& run, int threads,
                                 const NodeWatch& watch = {}, CheckpointFile* checkpoint = nullptr);

// The experiment's sun or gas, by whose pressure tables may be normalised.
struct DistantSource {
  Vec3 towards_lab;
  double pressure_Pa = 0.0;  // irradiance over the speed of light; dynamic pressure

  // Attitude for which the source is in the direction `towards_body`. It depends only on the
  // direction, so that equal directions with different azimuths give equal results.
  RigidTransform lab_from_body(const Vec3& towards_body) const;
};

// Wrench for one direction, about the reference point of the table.
struct DirectionWrench {
  WrenchComponents direct{};
  WrenchPair bounced;        // of light after its first bounce: two independent estimates
  WrenchComponents error{};  // standard error common to both estimates
  uint64_t rays = 0;
  std::vector<std::string> warnings;

  void keep(Snapshot& snapshot) {
    snapshot(direct, bounced, error, rays);
    snapshot.each(warnings, [&](std::string& one) { snapshot(one); });
  }
};

class LightDirections {
 public:
  virtual ~LightDirections() = default;
  // Safe to call from many threads.
  virtual DirectionWrench at(const RigidTransform& lab_from_body) const = 0;
  // Writes the result at each node into the table with its error; adds warnings for failed checks.
  // `whole`: the nodes cover the sphere from pole to pole.
  virtual void fill(WrenchTable& table, const std::vector<DirectionWrench>& found, bool whole,
                    const Console& console, int threads,
                    std::vector<std::string>& warnings) const = 0;
};

// Wrenches by ray tracing; direct light is integrated over the surfaces if possible. Over a whole
// sphere, light after the first contact is smoothed.
std::unique_ptr<LightDirections> traced_directions(const OpticalRun& run, const DistantSource& sun,
                                                   const Vec3& about_body_m);

// Wrenches by quadrature (receivers/gather/bodies/sunlit_body.h). Null if the scene does not permit
// it, or if the experiment requires rays.
std::unique_ptr<LightDirections> sunlit_directions(const OpticalRun& run, const DistantSource& sun,
                                                   const Vec3& about_body_m, int threads);

// Attitudes for evenly distributed directions outside the table, for comparisons with rays.
std::vector<RigidTransform> fresh_directions(size_t count, const DistantSource& sun);

// Magnitude of the largest torque in the table [N m].
double largest_torque_N_m(const WrenchTable& table);

}  // namespace photorque
