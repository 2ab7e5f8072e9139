#include "raytrace/tracing/view.h"

#include <memory>

#include "core/parallel.h"
#include "raytrace/tracing/find_hits.h"

namespace photorque {
namespace {

// Starts the ray at the sphere that holds the scene when the viewer stands outside, for the sake of
// single precision.
Ray nearby_ray(const TraceableScene::Data& scene, const Sight& sight, size_t index) {
  const double ahead =
      (scene.centre_m - sight.origin_m).dot(sight.direction) - 1.001 * scene.radius_m;
  const Vec3 origin = sight.origin_m + std::max(0.0, ahead) * sight.direction;
  Ray ray{};
  for (int k = 0; k < 3; ++k) {
    ray.origin_m[k] = static_cast<float>(origin[k]);
    ray.direction[k] = static_cast<float>(sight.direction[k]);
  }
  ray.sample = static_cast<uint32_t>(index);
  return ray;
}

VisiblePoint visible_point(const TraceableScene::Data& scene, const Hits& hits, int i,
                           const Sight& sight) {
  VisiblePoint point;
  point.hit = true;
  point.front = hits.front[i] != 0;
  point.instance = hits.instance[i];
  point.triangle = hits.triangle[i];
  point.barycentric = {hits.barycentric[0][i], hits.barycentric[1][i]};
  point.position_m = {hits.position_m[0][i], hits.position_m[1][i], hits.position_m[2][i]};
  const double* n = scene.plane(point.instance, point.triangle).normal;
  point.normal = (point.front ? 1.0 : -1.0) * Vec3(n[0], n[1], n[2]);
  point.distance_m = (point.position_m - sight.origin_m).norm();
  return point;
}

}  // namespace

std::vector<VisiblePoint> look(const TraceableScene& scene, size_t count,
                               const std::function<Sight(size_t)>& sight, int threads) {
  const TraceableScene::Data& data = scene.data();
  std::vector<VisiblePoint> points(count);
  const size_t chunks = (count + Hits::capacity - 1) / Hits::capacity;
  parallel_for(chunks, threads, [&](size_t chunk) {
    const size_t first = chunk * Hits::capacity;
    const size_t end = std::min(count, first + Hits::capacity);
    std::vector<Sight> sights;
    std::vector<Ray> rays;
    for (size_t i = first; i < end; ++i) {
      sights.push_back(sight(i));
      rays.push_back(nearby_ray(data, sights.back(), i - first));
    }
    const auto buffer = std::make_unique<HitBuffer>();
    const auto kept = std::make_unique<Hits::Column<int>>();
    find_hits(data, {rays, {}}, Coherence::incoherent, *buffer);
    compact(*buffer, *kept);
    locate_hits(data, 0, *buffer);
    for (int i = 0; i < buffer->hits.count; ++i) {
      const size_t at = buffer->sample[i];
      points[first + at] = visible_point(data, buffer->hits, i, sights[at]);
    }
  });
  return points;
}

}  // namespace photorque
