// Rays of one batch as they leave an emitter, placed near the scene in the body frame, in an order
// that keeps neighbours together.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/numerics/random.h"
#include "core/transform.h"
#include "raytrace/emitter.h"
#include "raytrace/tracing/targets.h"
#include "raytrace/tracing/traceable_scene_data.h"

namespace photorque {

using RayColumn = std::array<float, ray_block>;

// The columns of records Ray: ox oy oz dx dy dz, then the bits of `sample`, nothing.
using RayColumns = std::array<RayColumn, 8>;

// Where rays cross the plane through the scene's centre, in the emitter's frame.
struct Landing {
  RayColumn x, y;
};

// Rays start where they cross a plane z = const of the emitter's frame just before the scene, or
// where they are emitted if no such plane has all of the scene behind it. Across the beam the
// coordinates of rays that meet the scene are of the scene's size there, and the plane itself is
// placed in double precision: single precision loses nothing over any distance, but for what an
// emitter far away sends far off its axis (1e-7 of the distance).
class RayPlacement {
 public:
  RayPlacement(const RigidTransform& body_from_emitter, const TraceableScene::Data& scene);

  // Fills columns 0 to 5 of `placed`, and where the rays land; if the scene's centre is behind the
  // emitter, their directions instead.
  void place(const RayBlock& rays, RayColumns& placed, Landing& landing) const;

 private:
  bool starts_late_;
  float start_z_m_;  // of the plane before the scene, 0 if there is none
  float landing_z_m_;
  std::array<std::array<float, 3>, 3> rotation_;
  std::array<float, 3>
      offset_m_;  // from the scene's centre in body axes, of the emitter's (0, 0, start_z)
};

// A ray as Embree takes it, from the scene's centre in body axes. Its single-precision origin and
// direction ARE the ray: everything later is computed in double precision from them.
struct alignas(32) Ray {
  float origin_m[3];
  float direction[3];
  uint32_t sample;  // index in the sequence of its beam and replicate
  uint32_t unused = 0;
};

// Room for one batch, reused from batch to batch.
struct LaunchBuffer {
  std::vector<Ray> rays;        // in the order of emission
  std::vector<uint16_t> order;  // indices into `rays`, neighbours together
  std::vector<uint16_t> key, start;
};

// Order of the rays of a beam that keeps neighbours together: its sequence is
// cut into cells of neighbours, which are the batches, and each batch is sorted.
struct LaunchPlan {
  SobolCells cells;
  RayPlacement placement;
  std::optional<Targets> targets;  // of parallel light: where it is sent
  // Where the rays land; bounds beyond which their order does not matter.
  float x_low, x_high, y_low, y_high;
  // The rays' octants are numbered by the signs of those components of their directions in the body
  // frame that have both: what a negative x, y, z adds to the number.
  std::array<uint32_t, 3> octant_step;
  uint32_t octants;
};

// Plans 2^log2_rays rays, at least ray_block: one replicate of one beam.
LaunchPlan plan_launch(const Emitter& emitter, const RigidTransform& body_from_emitter,
                       const TraceableScene::Data& scene, int log2_rays,
                       std::optional<Targets> targets = std::nullopt);

// Emits batch `cell` of plan.cells into `buffer`.
//
// `buffer.order` sorts the rays by the signs of their directions first and by landing cell second.
// Embree follows a packet as one only within an octant of directions; a beam along an axis, whose
// rays straddle up to four octants, is traced three to four times slower without this.
void launch(const Emitter& emitter, const LaunchPlan& plan, const SobolStream& stream,
            uint32_t cell, LaunchBuffer& buffer);

}  // namespace photorque
