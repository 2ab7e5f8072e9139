// Finds the hits of rays: with Embree in packets, then in double precision.
#pragma once

#include <algorithm>
#include <span>

#include "raytrace/receiver.h"
#include "raytrace/tracing/launch.h"
#include "raytrace/tracing/traceable_scene_data.h"

namespace photorque {

// Hits before they reach the receivers, with data that only the tracer needs.
struct HitBuffer {
  explicit HitBuffer(int bands) {
    hits.bands = bands;
    for (size_t k = 0; k < 3; ++k) hits.direction[k] = ray[3 + k].data();
  }
  HitBuffer(const HitBuffer&) = delete;
  HitBuffer& operator=(const HitBuffer&) = delete;

  Hits hits;
  Hits::Column<uint32_t> sample;
  // Rays in single precision: ox oy oz dx dy dz, then the bits of `sample`, then padding.
  std::array<Hits::Column<float>, 8> ray;
  std::array<Hits::Column<double>, 4> plane;  // of the triangle: normal and offset
  Hits::Column<float> facing;                 // normal · direction: negative on the front
  bool one_side = false;                      // all hits are on the same side of one instance
  Hits::Column<double> left_W;                // power that continues, all bands

  Vec3 direction(int i) const { return {ray[3][i], ray[4][i], ray[5][i]}; }
};

// Rays in a given order.
struct RayList {
  std::span<const Ray> rays;
  std::span<const uint16_t> order;  // indices into `rays`; empty: order of `rays`

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

// Removes the rows without a hit. hits.count becomes the number of hits; kept[j] becomes the former
// row of hit j, or is unchanged if all rows are hits. Returns the number of hits.
int compact(HitBuffer& buffer, Hits::Column<int>& kept);

// Fills depth and one_side, and position, cosine, front and sample of every hit.
void locate_hits(const TraceableScene::Data& scene, int depth, HitBuffer& buffer);

}  // namespace photorque
