// From an emitter's rays to rays near the scene, in the body frame.
#pragma once

#include <array>

#include "core/transform.h"
#include "raytrace/emitter.h"
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
  std::array<float, 3> offset_m_;  // in the body frame, of the emitter's (0, 0, start_z)
};

}  // namespace photorque
