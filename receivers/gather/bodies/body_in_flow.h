// Force and torque of a free-molecular gas flow on a body, for tables over the directions of the
// relative wind (molecular_flow.h has the law of a surface).
//
// Shadows are those of parallel molecules (speed ratio S → ∞), cut out along their edges as in
// sunlit_body.h. Thermal motion fills real shadows at distances of about S times the width of what
// casts them. A side that is turned away from the wind is in shadow where another part is in the
// direction from which its few molecules come. Molecules that leave one part and meet another are
// left out.
#pragma once

#include <vector>

#include "receivers/gather/bodies/lamp.h"
#include "receivers/gather/bodies/molecular_flow.h"
#include "receivers/gather/bodies/outlines.h"

namespace photorque {

// A scene prepared for any direction of the flow. Immutable and safe to call from many threads.
class BodyInFlow {
 public:
  // `walls` are those of the scene's instances; torques are about `about_m`, body frame. The scene
  // must outlive this.
  BodyInFlow(const TraceableScene& scene, double speed_ratio, std::vector<GasWall> walls,
             const Vec3& about_m);

  struct Result {
    WrenchSum per_pressure = WrenchSum::Zero();  // divided by ½ρv² [m², m³]
    uint64_t rays = 0;
  };
  // For the unit vector of the flow's travel, body frame.
  Result wrench(const Vec3& travel) const;

 private:
  class Direction;

  const TraceableScene& scene_;
  double speed_ratio_;
  std::vector<GasWall> walls_;
  Vec3 about_m_;
  BodyShape shape_;
};

}  // namespace photorque
