// Force and torque of direct light on whole bodies, as an integral over their surfaces.
//
// For a facet that nothing can shade, the momentum at first contact (FirstContact) is computed in
// closed form, or by quadrature under a near lamp. Other facets get shadow rays, in proportion to
// their light. If no ray is blocked, the facet is treated as open, so that only the edges of
// shadows cause noise. Light after the first contact is traced with rays.
#pragma once

#include <map>
#include <memory>

#include "receivers/gather/bodies/lamp.h"
#include "receivers/gather/gather.h"
#include "receivers/wrench/wrench.h"

namespace photorque {

// A scene and its lamps, prepared for any attitude. Immutable; safe to call from many threads.
class WrenchGather {
 public:
  // Null if a lamp has no uniform aperture, or if the beam of a near lamp has an edge, which the
  // quadrature over facets does not resolve. `scene` must outlive the result.
  static std::unique_ptr<const WrenchGather> make(const TraceableScene& scene,
                                                  std::span<const Beam> beams);

  // Direct entries of the receiver, at the attitude `lab_from_body`. Uses seed, replicates, threads
  // and body_points of the options. The result has the same bits for any number of threads.
  Gathered wrench(const RigidTransform& lab_from_body, const WrenchReceiver& receiver,
                  const GatherOptions& options) const;

  // Number of pairs of a facet's side and a lamp.
  size_t pairs() const { return 2 * facets_.count() * beams_.size(); }

 private:
  WrenchGather(const TraceableScene& scene, std::span<const Beam> beams,
               std::vector<std::shared_ptr<const DiscLight>> lights);

  const TraceableScene& scene_;
  std::vector<Beam> beams_;
  Facets facets_;
  std::vector<std::shared_ptr<const DiscLight>> lights_;  // one per beam
  std::map<const DiscLight*, std::unique_ptr<BodyLight>> tables_;
};

}  // namespace photorque
