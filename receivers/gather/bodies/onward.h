// Light that is mirrored or transmitted by thin sheets, traced ray by ray until its power is
// negligible. For the files of this folder only.
#pragma once

#include <functional>
#include <vector>

#include "raytrace/tracing/find_hits.h"
#include "receivers/gather/bodies/lamp.h"

namespace photorque {

struct OnwardRay {
  Vec3 origin_m, direction;  // body frame
  BandValues power_W;
  uint32_t owner;
};

// Callbacks for the points where rays land. A side is the back (2 · facet) or the front
// (2 · facet + 1) of a facet.
struct OnwardSink {
  // Receives the mean force and torque that a ray of this owner exerts on a surface.
  std::function<void(uint32_t owner, const WrenchSum& wrench)> push;
  // Receives the light that is scattered there by Lambert's law.
  std::function<void(uint32_t owner, size_t side, const Vec2& uv, const BandValues& power_W)>
      scatter;
};

// A shadow ray of this length from a point on a surface.
ShadowRay probe(const TraceableScene& scene, const Vec3& at_m, const Vec3& normal,
                const Vec3& direction, double length_m);

// Whether all surfaces only reflect as mirrors, scatter by Lambert's law and transmit without
// change of direction.
bool all_plain(const Scene& scene);

class OnwardLight {
 public:
  // `facet_of` maps the triangles of each instance to facets, see Facets::numbers(). Both
  // references must outlive this object.
  OnwardLight(const TraceableScene& scene, const std::vector<std::vector<uint32_t>>& facet_of,
              const Vec3& about_m);

  // Follows the rays and their further bounces until less than the fraction `cutoff` of a ray's
  // power remains; clears `rays`.
  void follow(std::vector<OnwardRay>& rays, double cutoff, const OnwardSink& sink);
  uint64_t rays() const { return traced_; }

 private:
  void land(std::span<const OnwardRay> some, std::span<const double> least_W,
            const OnwardSink& sink, std::vector<OnwardRay>& next,
            std::vector<double>& next_least_W);

  const TraceableScene::Data& scene_;
  const std::vector<std::vector<uint32_t>>& facet_of_;
  Vec3 about_m_;
  std::unique_ptr<HitBuffer> buffer_;
  std::vector<Ray> narrow_;
  Hits::Column<int> kept_{};
  uint64_t traced_ = 0;
};

}  // namespace photorque
