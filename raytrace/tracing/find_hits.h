// Rays → hits: through Embree in packets, then in double precision.
#pragma once

#include <algorithm>
#include <span>

#include "raytrace/receiver.h"
#include "raytrace/tracing/launch.h"
#include "raytrace/tracing/traceable_scene_data.h"

namespace photorque {

// Hits on their way to the receivers, with data that the receivers do not need.
struct HitBuffer {
  Hits hits;
  Hits::Column<uint32_t> sample;
  // The rays in single precision: ox oy oz dx dy dz, then the bits of `sample`, and padding.
  std::array<Hits::Column<float>, 8> ray;
  std::array<Hits::Column<double>, 4> plane;  // of the triangle: normal and offset
  Hits::Column<float> facing;                 // normal · direction: negative on the front
  bool one_side = false;                      // all hits are on the same side of one instance
  Hits::Column<double> left_W;                // power that goes on, all bands

  Vec3 direction(int i) const { return {ray[3][i], ray[4][i], ray[5][i]}; }
};

// Rays in their own order.
struct RayList {
  std::span<const Ray> rays;
  std::span<const uint16_t> order;  // indices into `rays`; empty: as they lie

  size_t size() const { return order.empty() ? rays.size() : order.size(); }
  const Ray& operator[](size_t i) const { return rays[order.empty() ? i : order[i]]; }
  RayList part(size_t begin, size_t most) const {
    const size_t count = std::min(most, size() - begin);
    if (order.empty()) return {rays.subspan(begin, count), {}};
    return {rays, order.subspan(begin, count)};
  }
};

// Traces up to Hits::capacity rays. Afterwards row i of the buffer belongs to ray i: instance (or
// RTC_INVALID_GEOMETRY_ID), triangle, barycentric, ray; hits.count is the number of rays.
void find_hits(const TraceableScene::Data& scene, const RayList& rays, Coherence coherence,
               HitBuffer& buffer);

// Closes the gaps of the rows without a hit; hits.count becomes the number of hits and kept[j] the
// row that hit j had. Returns the number of hits; where that is all, `kept` stays as it is.
int compact(HitBuffer& buffer, Hits::Column<int>& kept);

// Fills position, cosine, front, sample and depth of every hit, and whether all are on one side.
void locate_hits(const TraceableScene::Data& scene, int depth, HitBuffer& buffer);

}  // namespace photorque
