// Force and torque of sunlight on a body, including all bounces, with little noise. For tables over
// thousands of directions.
//
// Direct light. Every edge of a shadow in parallel light is the trace of a straight line. This line
// is an edge at which a mesh ends or turns away from the light, or a cut of one surface through
// another. Each lit facet is cut along these traces into pieces that are completely lit or
// completely dark; one shadow ray decides. Areas and centres of the pieces are exact. The size of
// the Sun is included in the light that arrives on a facet, but not in its shadows. The penumbra
// adds and removes nearly equal light on either side of an edge; the error is of the order of the
// square of the half-angle of the Sun.
//
// Onward light. Light scattered by Lambert's law is a field on the surfaces that does not depend on
// the incident direction (scattered.h). Light from mirrors and through thin sheets is traced from
// small cells of the lit pieces. Cells are divided further where neighbours disagree.
//
// Only for scenes with these interactions. Other surfaces and near lamps are traced with rays
// (raytrace/tracing/tracer.h). The two methods are independent; tests compare them.
#pragma once

#include <memory>

#include "receivers/gather/bodies/outlines.h"
#include "receivers/gather/bodies/scattered.h"

namespace photorque {

struct SunlitEffort {
  ScatteredLight::Effort scattered = {};
  size_t mirror_cells = 1000;  // approximate number, of about equal areas, over all surfaces
};

// Wrench of sunlight: of the first contact, and of all later light in two independent estimates of
// the scattered light.
struct SunlitWrench {
  WrenchSum direct = WrenchSum::Zero();
  TwofoldSum bounced = TwofoldSum::Zero();
  // Standard error of mirrored light, from the scatter within the last cells.
  WrenchSum mirror_error = WrenchSum::Zero();
  uint64_t rays = 0;

  WrenchSum total() const { return direct + 0.5 * (bounced.head<6>() + bounced.tail<6>()); }
};

// A scene prepared for any direction of the light. Immutable; safe to call from many threads.
class SunlitBody {
 public:
  // Null unless the only beam is a sun of at most 1 deg half-angle, all surfaces are plain and
  // there are at most 20,000 facets, which are tested against each other. `scene` must outlive the
  // result.
  static std::unique_ptr<const SunlitBody> make(const TraceableScene& scene,
                                                std::span<const Beam> beams, const Vec3& about_m,
                                                const SunlitEffort& effort = {});

  // Wrench about the point of make(), in the body frame [N, N m]. Cells of mirrored light are
  // divided until the error of each is below `tolerance_N_m`; infinite: never divided.
  SunlitWrench wrench(const RigidTransform& lab_from_body, double tolerance_N_m) const;

 private:
  SunlitBody(const TraceableScene& scene, const Beam& beam, const Vec3& about_m,
             const SunlitEffort& effort);
  class Direction;

  const TraceableScene& scene_;
  Beam beam_;
  Vec3 about_m_;
  BodyShape shape_;
  BodyLight light_;
  double area_m2_, mirror_cell_m2_;
  ScatteredLight scattered_;
};

}  // namespace photorque
