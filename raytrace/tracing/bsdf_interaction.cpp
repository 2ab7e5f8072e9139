#include "raytrace/tracing/bsdf_interaction.h"

#include <bit>
#include <cmath>

#include "core/constants.h"
#include "raytrace/surfaces/bsdf.h"

namespace photorque {
namespace {

enum class Way { specular, diffuse, transmitted, retroreflected };

// A hit in the frame of bsdf.h.
struct LocalHit {
  const OpticalSurface* surface;
  bool front;
  Vec3 direction;  // of the light
  double cosine;
  Vec3 x, y, z;

  Vec3 to_body(const Vec3& local) const { return local.x() * x + local.y() * y + local.z() * z; }
};

LocalHit local_hit(const TraceableScene::Data& scene, const HitBuffer& buffer, int i) {
  const Hits& hits = buffer.hits;
  LocalHit hit;
  hit.front = hits.front[i] != 0;
  const Instance& instance = scene.scene.instances[hits.instance[i]];
  hit.surface = &scene.scene.surfaces[hit.front ? instance.front_surface : instance.back_surface];
  hit.direction = buffer.direction(i);
  const TrianglePlane& plane = scene.plane(hits.instance[i], hits.triangle[i]);
  hit.z = Vec3(plane.normal[0], plane.normal[1], plane.normal[2]) * (hit.front ? 1.0 : -1.0);
  hit.cosine = std::clamp(-hit.direction.dot(hit.z), 1e-9, 1.0);
  const Vec3 along = -hit.direction - hit.cosine * hit.z;
  hit.x = along.squaredNorm() > 1e-20 ? along.normalized() : hit.z.unitOrthogonal();
  hit.y = hit.z.cross(hit.x);
  return hit;
}

// Draws where the ray goes in proportion to power over all bands, and turns the powers of the bands
// into those of the ray: their sum is exactly what was not absorbed.
Way choose_way(const std::array<PowerFractions, max_bands>& fractions, int bands, double u,
               BandValues& power_W) {
  constexpr std::array members = {&PowerFractions::specular, &PowerFractions::diffuse,
                                  &PowerFractions::transmitted, &PowerFractions::retroreflected};
  std::array<double, members.size()> carried{};
  double total = 0.0;
  for (size_t w = 0; w < members.size(); ++w) {
    for (int b = 0; b < bands; ++b) carried[w] += power_W[b] * fractions[b].*members[w];
    total += carried[w];
  }
  size_t way = members.size();
  double at = u * total;
  for (size_t w = 0; w < members.size(); ++w) {
    if (carried[w] <= 0.0) continue;
    way = w;
    if (at < carried[w]) break;
    at -= carried[w];
  }
  for (int b = 0; b < bands; ++b) power_W[b] *= fractions[b].*members[way] * total / carried[way];
  return static_cast<Way>(way);
}

Vec3 way_direction(const LocalHit& hit, Way way, const Draw& draw) {
  const Bsdf& bsdf = *hit.surface->bsdf;
  switch (way) {
    case Way::specular:
      return bsdf.specular ? hit.to_body(bsdf.specular->direction(hit.cosine, draw))
                           : Vec3(hit.direction + 2.0 * hit.cosine * hit.z);
    case Way::diffuse:
      return hit.to_body(bsdf.diffuse ? bsdf.diffuse->direction(hit.cosine, draw)
                                      : lambertian_direction(draw.u, draw.v));
    case Way::retroreflected:
      return -hit.direction;
    case Way::transmitted:
      break;
  }
  return hit.direction;
}

// Momentum flow [N] of the heat that leaves both sides.
Vec3 heat_momentum_N(const LocalHit& hit, double absorbed_W) {
  const Bsdf& bsdf = *hit.surface->bsdf;
  const double lit = hit.front ? bsdf.front_emission : 1.0 - bsdf.front_emission;
  return bsdf.reemitted * absorbed_W * (2.0 * lit - 1.0) * (2.0 / 3.0) / speed_of_light_m_s * hit.z;
}

void settle(const InteractionContext& context, const SobolSequence& sequence, HitBuffer& buffer,
            int i, PowerBalanceSums& power_balance, Continuation& next) {
  Hits& hits = buffer.hits;
  const LocalHit hit = local_hit(*context.scene, buffer, i);
  const Vec3 position(hits.position_m[0][i], hits.position_m[1][i], hits.position_m[2][i]);
  Vec3 departure = Vec3::Zero();
  BandValues power_W{};
  std::array<PowerFractions, max_bands> fractions;
  double absorbed_W = 0.0;
  for (int b = 0; b < hits.bands; ++b) {
    const auto band = static_cast<size_t>(b);
    power_W[band] = hits.incident_W[band][i];
    absorbed_W += hits.absorbed_W[band][i];
    fractions[band] = fractions_of(*hit.surface, hit.cosine, band);
    departure += power_W[band] * first_moment(*hit.surface, hit.cosine, band);
  }
  const Vec3 heat_N = heat_momentum_N(hit, absorbed_W);
  power_balance.release_momentum(position, heat_N);
  const Vec3 leaving_N = hit.to_body(departure) / speed_of_light_m_s + heat_N;
  for (size_t k = 0; k < 3; ++k) hits.force_N[k][i] -= leaving_N[static_cast<Eigen::Index>(k)];
  if (!(buffer.left_W[i] > 0.0)) return;

  const auto point = sequence.point(buffer.sample[i]);
  const Way way = choose_way(fractions, hits.bands, point[0], power_W);
  const Draw draw{point[1], point[2], std::bit_cast<uint64_t>(point[3])};
  const Vec3 onward = way_direction(hit, way, draw);
  const double ray_offset =
      way == Way::transmitted ? -context.scene->ray_offset_m : context.scene->ray_offset_m;
  go_on(context, hits.bands, {position, position + ray_offset * hit.z, onward, buffer.sample[i]},
        power_W, power_balance, next);
}

}  // namespace

void absorb_by_angle(const TraceableScene::Data& scene, HitBuffer& buffer) {
  Hits& hits = buffer.hits;
  for (int i = 0; i < hits.count; ++i) {
    const Bsdf* bsdf = scene.bsdf[2 * hits.instance[i] + hits.front[i]];
    if (bsdf == nullptr || !bsdf->law) continue;
    const LocalHit hit = local_hit(scene, buffer, i);
    buffer.left_W[i] = 0.0;
    for (int b = 0; b < hits.bands; ++b) {
      const auto band = static_cast<size_t>(b);
      const PowerFractions fractions = bsdf->law->fractions(hit.cosine, band);
      hits.absorbed_W[band][i] = hits.incident_W[band][i] * fractions.absorbed;
      buffer.left_W[i] += hits.incident_W[band][i] - hits.absorbed_W[band][i];
    }
  }
}

void settle_finishes(const InteractionContext& context, const SobolSequence& sequence,
                     HitBuffer& buffer, PowerBalanceSums& power_balance, Continuation& next) {
  const Hits& hits = buffer.hits;
  for (int i = 0; i < hits.count; ++i) {
    if (context.scene->bsdf[2 * hits.instance[i] + hits.front[i]] == nullptr) continue;
    settle(context, sequence, buffer, i, power_balance, next);
    buffer.left_W[i] = 0.0;
  }
}

}  // namespace photorque
