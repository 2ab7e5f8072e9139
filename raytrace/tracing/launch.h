// Rays of one batch as they leave an emitter, in the body frame, in an order that keeps neighbours
// together.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/numerics/random.h"
#include "core/transform.h"
#include "raytrace/emitter.h"
#include "raytrace/tracing/ray_placement.h"
#include "raytrace/tracing/traceable_scene_data.h"

namespace photorque {

// A ray as Embree takes it. Its single-precision origin and direction ARE the ray: everything later
// is computed in double precision from them.
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

// How the rays of a beam are brought into an order that keeps neighbours together: its sequence is
// cut into cells of neighbours, which are the batches, and each batch is sorted.
struct LaunchPlan {
  SobolCells cells;
  RayPlacement placement;
  // Where the rays land; bounds beyond which they need not be told apart.
  float x_low, x_high, y_low, y_high;
  // The rays' octants are numbered by the signs of those components of their directions in the body
  // frame that have both: what a negative x, y, z adds to the number.
  std::array<uint32_t, 3> octant_step;
  uint32_t octants;
};

// Plans 2^log2_rays rays, at least ray_block: one replicate of one beam.
LaunchPlan plan_launch(const Emitter& emitter, const RigidTransform& body_from_emitter,
                       const TraceableScene::Data& scene, int log2_rays);

// Emits batch `cell` of plan.cells into `buffer`.
//
// `buffer.order` sorts the rays by the signs of their directions first and by landing cell second.
// Embree follows a packet as one only within an octant of directions; a beam along an axis, whose
// rays straddle up to four octants, is traced three to four times slower without this.
void launch(const Emitter& emitter, const LaunchPlan& plan, const SobolStream& stream,
            uint32_t cell, LaunchBuffer& buffer);

}  // namespace photorque
