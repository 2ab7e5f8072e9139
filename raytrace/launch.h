// Rays of one batch as they leave an emitter, in the body frame, in an order that keeps neighbours
// together.
#pragma once

#include <cstdint>
#include <vector>

#include "core/sobol.h"
#include "core/transform.h"
#include "raytrace/emitter.h"
#include "raytrace/traceable_scene_data.h"

namespace photorque {

// Most rays of a batch: large enough that sorting brings packets of neighbours together, small
// enough that a batch stays in the cache.
inline constexpr uint32_t largest_batch = 1u << 14;

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
  std::vector<Ray> rays;  // sorted, after launch()
  std::vector<Ray> unsorted;
  std::vector<uint16_t> key;
  std::vector<uint32_t> start;
};

// Where the rays of a beam cross a plane near the scene, as a grid to sort by.
struct LandingGrid {
  double plane_z_m =
      0.0;  // in the emitter's frame; ≤ 0: the scene is behind, directions serve instead
  float x_low = 0, y_low = 0, x_scale = 0, y_scale = 0;  // landing point → cell
};

// A grid that fits the beam, from a sample of its rays.
LandingGrid landing_grid(const Emitter& emitter, const RigidTransform& body_from_emitter,
                         const TraceableScene::Data& scene);

// Emits points first … first + count − 1 of the stream into `buffer.rays`. `first` and `count` are
// multiples of ray_block, count ≤ largest_batch. Origins are moved along the rays to the sphere
// that holds the scene, in double precision, before they are rounded: sources may be far away.
//
// The rays are sorted by the signs of their directions first and by landing cell second. Embree
// follows a packet as one only within an octant of directions; a beam along an axis, whose rays
// straddle up to four octants, is traced three to four times slower without this.
void launch(const Emitter& emitter, const RigidTransform& body_from_emitter,
            const TraceableScene::Data& scene, const LandingGrid& grid, const SobolStream& stream,
            uint32_t first, uint32_t count, LaunchBuffer& buffer);

}  // namespace photorque
