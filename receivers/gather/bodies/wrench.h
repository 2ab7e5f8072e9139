// The wrench of direct light on whole bodies, gathered from the surfaces' side.
//
// A facet above which nothing of the scene lies takes the momentum that arrives there and leaves at
// first contact (FirstContact) in closed form, or by quadrature under a lamp that is near.
// Towards all others go shadow rays, the more the more their light counts; where none is stopped,
// the facet is as if it were open, so that noise comes from the edges of shadows alone. What
// bounces is for rays.
#pragma once

#include <map>
#include <memory>

#include "receivers/gather/bodies/lamp.h"
#include "receivers/gather/gather.h"
#include "receivers/wrench/wrench.h"

namespace photorque {

// A scene and its lamps made ready for any attitude. Immutable; called from many threads at once.
class WrenchGather {
 public:
  // Nothing where a lamp has no uniform aperture, or is near and its beam has an edge (which the
  // quadrature over facets would have to find). `scene` must outlive this.
  static std::unique_ptr<const WrenchGather> make(const TraceableScene& scene,
                                                  std::span<const Beam> beams);

  // The direct entries of the receiver, at the attitude `lab_from_body`. Uses seed, replicates,
  // threads and body_points of the options. The same bits at any number of threads.
  Gathered wrench(const RigidTransform& lab_from_body, const WrenchReceiver& receiver,
                  const GatherOptions& options) const;

  // Of a facet's side and a lamp.
  size_t pairs() const { return 2 * facets_.count() * beams_.size(); }

 private:
  WrenchGather(const TraceableScene& scene, std::span<const Beam> beams,
               std::map<const Emitter*, std::unique_ptr<BodyLight>> lights);

  const TraceableScene& scene_;
  std::vector<Beam> beams_;
  Facets facets_;
  std::map<const Emitter*, std::unique_ptr<BodyLight>> lights_;
};

}  // namespace photorque
