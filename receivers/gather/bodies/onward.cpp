#include "receivers/gather/bodies/onward.h"

#include <algorithm>
#include <numeric>

#include "core/constants.h"
#include "raytrace/surfaces/bsdf.h"

namespace photorque {
namespace {

double total_W(const BandValues& power_W) {
  return std::accumulate(power_W.begin(), power_W.end(), 0.0);
}

BandValues part_of(const BandValues& power_W, const BandValues& fraction) {
  BandValues part;
  for (size_t b = 0; b < part.size(); ++b) part[b] = power_W[b] * fraction[b];
  return part;
}

}  // namespace

ShadowRay probe(const TraceableScene& scene, const Vec3& at_m, const Vec3& normal,
                const Vec3& direction, double length_m) {
  return shadow_ray(at_m - scene_centre_m(scene) + shadow_ray_offset_m(scene) * normal, direction,
                    length_m);
}

bool all_plain(const Scene& scene) {
  return std::ranges::all_of(scene.instances, [&](const Instance& one) {
    return !scene.surface(one, true).bsdf && !scene.surface(one, false).bsdf;
  });
}

OnwardLight::OnwardLight(const TraceableScene& scene,
                         const std::vector<std::vector<uint32_t>>& facet_of, const Vec3& about_m)
    : scene_(scene.data()),
      facet_of_(facet_of),
      about_m_(about_m),
      buffer_(std::make_unique<HitBuffer>(scene_.scene.bands.count())) {}

void OnwardLight::follow(std::vector<OnwardRay>& rays, double cutoff, const OnwardSink& sink) {
  // The cutoff ends all light earlier, except between perfect mirrors.
  constexpr int deepest = 1000;
  std::vector<OnwardRay> next;
  std::vector<double> least_W, next_least_W;
  for (const OnwardRay& ray : rays) least_W.push_back(cutoff * total_W(ray.power_W));
  for (int depth = 0; !rays.empty() && depth < deepest; ++depth) {
    next.clear();
    next_least_W.clear();
    for (size_t begin = 0; begin < rays.size(); begin += Hits::capacity) {
      const size_t count = std::min<size_t>(rays.size() - begin, Hits::capacity);
      land(std::span(rays).subspan(begin, count), std::span(least_W).subspan(begin, count), sink,
           next, next_least_W);
    }
    std::swap(rays, next);
    std::swap(least_W, next_least_W);
  }
  rays.clear();
}

void OnwardLight::land(std::span<const OnwardRay> some, std::span<const double> least_W,
                       const OnwardSink& sink, std::vector<OnwardRay>& next,
                       std::vector<double>& next_least_W) {
  narrow_.clear();
  for (uint32_t i = 0; i < some.size(); ++i) {
    narrow_.push_back(make_ray(some[i].origin_m - scene_.centre_m, some[i].direction, i));
  }
  traced_ += some.size();
  find_hits(scene_, {narrow_, {}}, Coherence::incoherent, *buffer_);
  const int count = compact(*buffer_, kept_);
  if (count == 0) return;
  locate_hits(scene_, 0, *buffer_);
  const Hits& hits = buffer_->hits;
  for (int i = 0; i < count; ++i) {
    const auto index = static_cast<size_t>(buffer_->sample[i]);
    const OnwardRay& ray = some[index];
    const OpticalSurface& surface = scene_.surface(hits.instance[i], hits.front[i]);
    const Vec3 normal = scene_.normal(hits.instance[i], hits.triangle[i], hits.front[i]);
    const Vec3 at_m = hits.position_at_m(static_cast<size_t>(i));
    const Vec3 mirrored = ray.direction - 2.0 * normal.dot(ray.direction) * normal;
    const BandValues on = part_of(ray.power_W, surface.specular);
    const BandValues through = part_of(ray.power_W, surface.transmitted);
    const BandValues scattered = part_of(ray.power_W, surface.diffuse);
    const double on_W = total_W(on), through_W = total_W(through), scattered_W = total_W(scattered);
    const Vec3 kept = (total_W(ray.power_W) - through_W) * ray.direction - on_W * mirrored -
                      lambertian_mean * scattered_W * normal;
    sink.push(ray.owner, wrench_of(kept / speed_of_light_m_s, at_m - about_m_));
    if (scattered_W > 0.0) {
      const uint32_t facet = facet_of_[hits.instance[i]][hits.triangle[i]];
      sink.scatter(ray.owner, 2 * static_cast<size_t>(facet) + hits.front[i],
                   {hits.barycentric[0][i], hits.barycentric[1][i]}, scattered);
    }
    const auto go_on = [&](double power_W, const BandValues& power, const Vec3& direction,
                           double above_m) {
      if (!(power_W > least_W[index])) return;
      next.push_back({at_m + above_m * normal, direction, power, ray.owner});
      next_least_W.push_back(least_W[index]);
    };
    go_on(on_W, on, mirrored, scene_.ray_offset_m);
    go_on(through_W, through, ray.direction, -scene_.behind_m(hits.instance[i]));
  }
}

}  // namespace photorque
