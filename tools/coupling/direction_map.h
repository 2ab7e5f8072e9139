// torque-map over directions of light or wind: the table of a body in sunlight or in a gas flow,
// and ways to find force and torque at one direction after another.
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

// Force and torque with the Sun, or a gas that comes, at every direction of [torque_map]: sunlight
// by quadrature where the scene is for that, else by rays. When the directions cover the sphere,
// the wrench per pressure is a file of the result in the SPAD layout. The experiment's only source
// must be a sun, or it has a gas flow. Directions are shared out over `threads` (0: all); `run`
// itself is best made for one. `watch` has each traced for it, of sunlight only. With a checkpoint,
// finished nodes are saved there periodically, and the run resumes from it.
DirectionMap map_over_directions(const Console& console, const OpticalRun& run, int threads,
                                 const NodeWatch& watch = {}, CheckpointFile* checkpoint = nullptr);

// The experiment's sun or gas: tables may be normalised by its pressure.
struct DistantSource {
  Vec3 towards_lab;
  double pressure_Pa = 0.0;  // irradiance over the speed of light; dynamic pressure

  // The attitude at which the source is in the direction `towards_body`. It depends on nothing
  // else, so that equal directions with different azimuths give equal results.
  RigidTransform lab_from_body(const Vec3& towards_body) const;
};

// The wrench at one direction, about the point of the table.
struct DirectionWrench {
  WrenchComponents direct{};
  WrenchPair bounced;        // of light after its first bounce, twice
  WrenchComponents error{};  // standard error of the parts that both halves share
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
  // Puts the result at each node into the table, and states its error; warns where a check fails.
  // `whole`: the nodes go from pole to pole and all round.
  virtual void fill(WrenchTable& table, const std::vector<DirectionWrench>& found, bool whole,
                    const Console& console, int threads,
                    std::vector<std::string>& warnings) const = 0;
};

// Tables by ray tracing; direct light is integrated over the surfaces if possible. Over a whole
// sphere, light after the first contact is smoothed.
std::unique_ptr<LightDirections> traced_directions(const OpticalRun& run, const DistantSource& sun,
                                                   const Vec3& about_body_m);

// Tables by quadrature (receivers/gather/bodies/sunlit_body.h). Null if the scene does not permit
// it, or if the experiment requires rays.
std::unique_ptr<LightDirections> sunlit_directions(const OpticalRun& run, const DistantSource& sun,
                                                   const Vec3& about_body_m, int threads);

// Tables of a gas flow (receivers/gather/bodies/body_in_flow.h), at the pressure of `source`.
std::unique_ptr<LightDirections> flow_directions(const OpticalRun& run, const DistantSource& source,
                                                 const Vec3& about_body_m);

// Directions that no table has, evenly over the sphere, in which a method is compared with rays.
std::vector<RigidTransform> fresh_directions(size_t count, const DistantSource& sun);

// The longest of these torques [N m].
double largest_torque_N_m(const WrenchTable& table);

}  // namespace photorque
