#include "raytrace/tracing/scattering.h"

#include <bit>
#include <cmath>
#include <numeric>

#include "core/constants.h"

namespace photorque {
namespace {

using ComponentPowers = std::array<double, components.size()>;

// The fractions of one hit: the surface's own where they are the same at every angle, which costs
// no copy, else what its law says.
class HitAlbedo {
 public:
  HitAlbedo(const OpticalSurface& surface, double cosine, int bands) {
    static constexpr BandValues none{};
    const Bsdf* bsdf = surface.bsdf.get();
    if (bsdf == nullptr || !bsdf->law) {
      of_ = {&surface.specular, &surface.diffuse, &surface.transmitted,
             bsdf == nullptr ? &none : &bsdf->retroreflected};
      return;
    }
    for (size_t c = 0; c < of_.size(); ++c) of_[c] = &by_law_[c];
    for (size_t band = 0; band < static_cast<size_t>(bands); ++band) {
      const PowerFractions fractions = bsdf->law->fractions(cosine, band);
      for (const Component c : components) {
        by_law_[static_cast<size_t>(c)][band] = fractions.of(c);
      }
    }
  }
  HitAlbedo(const HitAlbedo&) = delete;
  HitAlbedo& operator=(const HitAlbedo&) = delete;

  // Per band.
  const BandValues& operator[](Component c) const { return *of_[static_cast<size_t>(c)]; }

 private:
  std::array<const BandValues*, components.size()> of_;
  std::array<BandValues, components.size()> by_law_;  // filled only if there is a law
};

// The power [W] that each component of hit i carries away, all bands.
ComponentPowers carried_W(const Hits& hits, int i, const HitAlbedo& albedo) {
  ComponentPowers carried{};
  for (const Component c : components) {
    for (int b = 0; b < hits.bands; ++b) {
      carried[static_cast<size_t>(c)] += hits.incident_W[b][i] * albedo[c][b];
    }
  }
  return carried;
}

// Draws a component in proportion to the power that it carries; at least one carries some.
Component choose_component(const ComponentPowers& carried, double total_W, double u) {
  Component chosen = components.front();
  double at_W = u * total_W;
  for (const Component c : components) {
    const double power_W = carried[static_cast<size_t>(c)];
    if (power_W <= 0.0) continue;
    chosen = c;
    if (at_W < power_W) break;
    at_W -= power_W;
  }
  return chosen;
}

// The momentum flow [N] that leaves along all components: the expectation over what is drawn, so
// that forces carry no noise of the draw.
Vec3 leaving_momentum_N(const OpticalSurface& surface, const Incidence& incidence,
                        const ComponentPowers& carried) {
  Vec3 flow_W = Vec3::Zero();
  for (const Component c : components) {
    const double power_W = carried[static_cast<size_t>(c)];
    if (power_W > 0.0) flow_W += mean_flow(surface, c, incidence, power_W);
  }
  return flow_W / speed_of_light_m_s;
}

// Momentum flow [N] of the heat that leaves both sides of the sheet, by Lambert's law on each.
Vec3 heat_momentum_N(const Bsdf& bsdf, bool front, const Vec3& lit_normal, double absorbed_W) {
  const double lit = front ? bsdf.front_emission : 1.0 - bsdf.front_emission;
  return bsdf.reemitted * absorbed_W * (2.0 * lit - 1.0) * lambertian_mean / speed_of_light_m_s *
         lit_normal;
}

Ray make_ray(const Vec3& origin_m, const Vec3& direction, uint32_t sample) {
  Ray ray{};
  for (int k = 0; k < 3; ++k) {
    ray.origin_m[k] = static_cast<float>(origin_m[k]);
    ray.direction[k] = static_cast<float>(direction[k]);
  }
  ray.sample = sample;
  return ray;
}

}  // namespace

Incidence incidence_at(const TraceableScene::Data& scene, const HitBuffer& buffer, int i) {
  const TrianglePlane& plane = scene.plane(buffer.hits.instance[i], buffer.hits.triangle[i]);
  const Vec3 outward(plane.normal[0], plane.normal[1], plane.normal[2]);
  return {buffer.direction(i), buffer.hits.front[i] != 0 ? outward : Vec3(-outward)};
}

void scatter(const InteractionContext& context, const SobolSequence& sequence, HitBuffer& buffer,
             int i, PowerBalanceSums& power_balance, Continuation& next) {
  Hits& hits = buffer.hits;
  const TraceableScene::Data& scene = *context.scene;
  const OpticalSurface& surface = scene.surface(hits.instance[i], hits.front[i]);
  const Incidence incidence = incidence_at(scene, buffer, i);
  const Vec3 position(hits.position_m[0][i], hits.position_m[1][i], hits.position_m[2][i]);
  const HitAlbedo albedo(surface, incidence.cosine, hits.bands);
  const ComponentPowers carried = carried_W(hits, i, albedo);

  Vec3 leaving_N = leaving_momentum_N(surface, incidence, carried);
  if (surface.bsdf && surface.bsdf->reemitted > 0.0) {
    double absorbed_W = 0.0;
    for (int b = 0; b < hits.bands; ++b) absorbed_W += hits.absorbed_W[b][i];
    const Vec3 heat_N =
        heat_momentum_N(*surface.bsdf, hits.front[i] != 0, incidence.normal, absorbed_W);
    power_balance.release_momentum(position, heat_N);
    leaving_N += heat_N;
  }
  for (int k = 0; k < 3; ++k) hits.force_N[k][i] -= leaving_N[k];

  const double total_W = std::accumulate(carried.begin(), carried.end(), 0.0);
  if (!(total_W > 0.0)) return;
  const auto point = sequence.point(buffer.sample[i]);
  const Component chosen = choose_component(carried, total_W, point[0]);
  // The ray takes all that was not absorbed: its power per band is that of the component, scaled.
  const double scale = total_W / carried[static_cast<size_t>(chosen)];
  BandValues power_W;
  double ray_W = 0.0;
  for (int b = 0; b < hits.bands; ++b) {
    power_W[b] = hits.incident_W[b][i] * (albedo[chosen][b] * scale);
    ray_W += power_W[b];
  }
  const Draw draw{point[1], point[2], std::bit_cast<uint64_t>(point[3])};
  const Vec3 onward = scattered_direction(surface, chosen, incidence, draw);
  if (ray_W < context.cutoff_W) {
    power_balance.truncated_W += ray_W;
    power_balance.release(position, onward, ray_W);
    return;
  }
  const double ray_offset_m =
      chosen == Component::transmitted ? -scene.ray_offset_m : scene.ray_offset_m;
  next.rays.push_back(
      make_ray(position + ray_offset_m * incidence.normal, onward, buffer.sample[i]));
  next.power_W.insert(next.power_W.end(), power_W.begin(), power_W.begin() + hits.bands);
}

}  // namespace photorque
