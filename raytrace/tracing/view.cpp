#include "raytrace/tracing/view.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/numerics/random.h"
#include "core/parallel.h"
#include "raytrace/tracing/find_hits.h"

namespace photorque {
namespace {

// Starts the ray at the sphere around the scene if the viewer is outside it, to keep single
// precision sufficient.
Ray nearby_ray(const TraceableScene::Data& scene, const Sight& sight, size_t index) {
  const double ahead =
      (scene.centre_m - sight.origin_m).dot(sight.direction) - 1.001 * scene.radius_m;
  const Vec3 origin = sight.origin_m + std::max(0.0, ahead) * sight.direction;
  return make_ray(origin - scene.centre_m, sight.direction, static_cast<uint32_t>(index));
}

VisiblePoint visible_point(const TraceableScene::Data& scene, const Hits& hits, int i,
                           const Sight& sight) {
  VisiblePoint point;
  point.hit = true;
  point.front = hits.front[i] != 0;
  point.instance = hits.instance[i];
  point.triangle = hits.triangle[i];
  point.barycentric = {hits.barycentric[0][i], hits.barycentric[1][i]};
  point.position_m = hits.position_at_m(static_cast<size_t>(i));
  point.normal = scene.normal(point.instance, point.triangle, hits.front[i]);
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
    const auto buffer = std::make_unique<HitBuffer>(data.scene.bands.count());
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

namespace {

constexpr double far_radii = 20.0;  // of the scene

// Appends start and end of a ray in the lab frame, for a point on it near the scene.
void add_ray(std::vector<float>& rays, const Sight& sight, const VisiblePoint& seen,
             const RigidTransform& lab_from_body, double radius_m) {
  const bool is_near = sight.origin_m.norm() < far_radii * radius_m;
  const double nearest_m = -sight.origin_m.dot(sight.direction);
  const double reach_m = 3.0 * radius_m;
  const double from_m = is_near ? 0.0 : std::max(0.0, nearest_m - reach_m);
  const double to_m = seen.hit ? seen.distance_m : std::max(nearest_m, 0.0) + 0.5 * reach_m;
  if (!seen.hit && (sight.origin_m + nearest_m * sight.direction).norm() > reach_m) return;
  for (const double along_m : {from_m, to_m}) {
    const Vec3 at = lab_from_body.point(sight.origin_m + along_m * sight.direction);
    for (int k = 0; k < 3; ++k) rays.push_back(static_cast<float>(at[k]));
  }
}

}  // namespace

bool is_too_far_to_draw(const Beam& beam, double radius_m) {
  return beam.lab_from_emitter.translation_m.norm() > far_radii * radius_m ||
         (beam.aperture && std::isinf(beam.aperture->radius_m));
}

std::vector<float> shown_rays(const TraceableScene& scene, const std::vector<Beam>& beams,
                              const RigidTransform& lab_from_body, double radius_m, size_t about) {
  if (beams.empty() || about == 0) return {};
  const size_t stride = (beams.size() + about - 1) / about;
  const size_t each = std::clamp<size_t>(about / beams.size(), 1, 100);
  const RigidTransform body_from_lab = lab_from_body.inverse();
  std::vector<Sight> sights;
  SampleBlock samples;
  RayBlock block;
  for (size_t i = 0; i < beams.size(); i += stride) {
    sobol_points({1, i, 0}, 0, samples.columns());
    beams[i].emitter->emit(samples, block);
    const RigidTransform body_from_emitter = body_from_lab * beams[i].lab_from_emitter;
    for (size_t k = 0; k < each; ++k) {
      sights.push_back({body_from_emitter.point(block.origin_at_m(k)),
                        body_from_emitter.direction(block.direction_at(k).normalized())});
    }
  }
  const auto seen = look(scene, sights.size(), [&](size_t i) { return sights[i]; });
  std::vector<float> rays;
  for (size_t i = 0; i < sights.size(); ++i) {
    add_ray(rays, sights[i], seen[i], lab_from_body, radius_m);
  }
  return rays;
}

}  // namespace photorque
