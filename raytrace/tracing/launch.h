// Launch of one batch of rays: emission, placement near the scene in the body frame, and an order
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

// Columns of the records Ray: ox oy oz dx dy dz, then the bits of `sample`, then an unused one.
using RayColumns = std::array<RayColumn, 8>;

// Points where rays cross the plane through the scene's centre, in the emitter's frame.
struct Landing {
  RayColumn x, y;
};

// A rectangle of that plane.
using LandingRange = Eigen::AlignedBox2f;

// Moves the start of rays near the scene. Rays start where they cross a plane z = const of the
// emitter's frame just before the scene. If no such plane has the whole scene behind it, they start
// where they are emitted. At this plane the coordinates of rays that meet the scene are of the
// scene's size, and the plane itself is placed in double precision. Hence single precision is
// accurate at any distance, except for rays far off the axis of a distant emitter (error 1e-7 of
// the distance).
class RayPlacement {
 public:
  RayPlacement(const RigidTransform& body_from_emitter, const TraceableScene::Data& scene);

  // Fills columns 0 to 5 of `placed`, and `landing` with the landing points. If the scene's centre
  // is behind the emitter, `landing` gets the directions instead.
  void place(const RayBlock& rays, RayColumns& placed, Landing& landing) const;

 private:
  bool starts_late_;
  float start_z_m_;  // of the plane before the scene; 0 if there is none
  float landing_z_m_;
  Eigen::Matrix3f rotation_;
  // from the scene's centre to the emitter's (0, 0, start_z), in body axes
  Eigen::Vector3f offset_m_;
};

// A ray as Embree requires it, relative to the scene's centre in body axes. Its single-precision
// origin and direction define the ray: later steps compute from them in double precision.
struct alignas(32) Ray {
  float origin_m[3];
  float direction[3];
  uint32_t sample;  // index in the sequence of its beam and replicate
  uint32_t unused = 0;
};

// The ray in single precision.
inline Ray make_ray(const Vec3& origin_m, const Vec3& direction, uint32_t sample) {
  Ray ray{};
  Eigen::Map<Eigen::Vector3f>(ray.origin_m) = origin_m.cast<float>();
  Eigen::Map<Eigen::Vector3f>(ray.direction) = direction.cast<float>();
  ray.sample = sample;
  return ray;
}

// Memory for one batch, reused between batches.
struct LaunchBuffer {
  std::vector<Ray> rays;        // in the order of emission
  std::vector<uint16_t> order;  // indices into `rays`, neighbours together
  std::vector<uint16_t> key, start;
};

// Order of the rays of a beam that keeps neighbours together. The Sobol sequence is divided into
// cells of neighbours, which are the batches; each batch is sorted.
struct LaunchPlan {
  SobolCells cells;
  RayPlacement placement;
  std::optional<Targets> targets;  // only for parallel light
  // Range of landing points; beyond it the order of the rays does not matter.
  LandingRange range;
  // Octants of directions in the body frame are numbered by the signs of those components that
  // occur with both signs. octant_step is the increment of the number for a negative x, y, z.
  std::array<uint32_t, 3> octant_step = {};
  uint32_t octants = 1;
};

// Plans 2^log2_rays rays (at least ray_block), which are one replicate of one beam.
LaunchPlan plan_launch(const Emitter& emitter, const RigidTransform& body_from_emitter,
                       const TraceableScene::Data& scene, int log2_rays,
                       std::optional<Targets> targets = std::nullopt);

// Emits batch `cell` of plan.cells into `buffer`.
//
// `buffer.order` sorts the rays by the signs of their directions first and by landing cell second.
// Embree traces a packet together only within one octant of directions. Without this order a beam
// along an axis, whose rays lie in up to four octants, is three to four times slower.
void launch(const Emitter& emitter, const LaunchPlan& plan, const SobolStream& stream,
            uint32_t cell, LaunchBuffer& buffer);

}  // namespace photorque
