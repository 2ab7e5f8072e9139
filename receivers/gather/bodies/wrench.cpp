#include "receivers/gather/bodies/wrench.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>

#include "core/numerics/random.h"
#include "core/parallel.h"
#include "receivers/gather/bodies/sampler.h"

namespace photorque {
namespace {

// What one lamp lights of one instance: the item of parallel work.
struct Item {
  uint32_t lamp, instance;
  size_t part;  // of the receiver
  std::vector<FacetSide> open;
  std::vector<SampledSide> sampled;
  double weight = 0.0;  // of the sampled sides
  std::vector<WrenchSum> replicates = {};
  WrenchSum bound = WrenchSum::Zero();
  uint64_t rays = 0;
};

double weight_of(const SampledSide& sampled, const Vec3& about_m) {
  const Ball& ball = sampled.side.facet->ball;
  return sampled.power_W * ((ball.centre_m - about_m).norm() + ball.radius_m);
}

void find_sides(const Facets& facets, const BodyLamp& lamp, bool plain, const Vec3& about_m,
                Item& item) {
  const Ball& ball = facets.ball_of(item.instance);
  if (lamp.misses(ball)) return;
  // The inside of a body is dark for lamps outside of it.
  const auto inward = lamp.outside(ball) ? facets.inward(item.instance) : std::nullopt;
  for (const Facet& facet : facets.of(item.instance)) {
    for (const bool front : {false, true}) {
      if (inward == front) continue;
      const FacetSide side{&facet, front};
      const Exposure exposure = lamp.exposure_of(side);
      if (exposure == Exposure::none) continue;
      if (plain && exposure == Exposure::whole && facet.free[front ? 1 : 0]) {
        item.open.push_back(side);
        continue;
      }
      item.sampled.push_back({side, exposure == Exposure::whole, lamp.typical_W(side)});
      item.weight += weight_of(item.sampled.back(), about_m);
    }
  }
}

// Shares out the rays by what the light counts.
void share_points(Item& item, double points_per_weight, const Vec3& about_m) {
  constexpr double most = 1 << 14;
  for (SampledSide& sampled : item.sampled) {
    const double wanted = points_per_weight * weight_of(sampled, about_m);
    sampled.points = std::bit_ceil(static_cast<uint32_t>(std::clamp(wanted, 1.0, most)));
  }
}

Gathered sum_of(std::vector<Item>& items, const WrenchReceiver& receiver, int replicates) {
  Gathered result;
  const size_t entries = receiver.direct_entries();
  result.direct = {entries, replicates,
                   std::vector<double>(entries * static_cast<size_t>(replicates), 0.0),
                   std::vector<double>(entries, 0.0)};
  for (const Item& item : items) {
    result.open_pairs += item.open.size();
    result.shaded_pairs += item.sampled.size();
    result.shadow_rays += item.rays;
    for (size_t k = 0; k < 6; ++k) {
      const size_t entry = 6 * item.part + k;
      const auto i = static_cast<Eigen::Index>(k);
      result.direct.bound[entry] += item.bound[i];
      for (size_t r = 0; r < item.replicates.size(); ++r) {
        result.direct.sums[r * entries + entry] += item.replicates[r][i];
      }
    }
  }
  return result;
}

}  // namespace

std::unique_ptr<const WrenchGather> WrenchGather::make(const TraceableScene& scene,
                                                       std::span<const Beam> beams) {
  std::map<const Emitter*, std::unique_ptr<BodyLight>> lights;
  for (const Beam& beam : beams) {
    if (!beam.aperture) return nullptr;
    auto& light = lights[beam.emitter.get()];
    if (light) continue;
    const auto disc = std::make_shared<DiscLight>(*beam.emitter, *beam.aperture);
    if (!disc->parallel() && !disc->fades_out()) return nullptr;
    light = std::make_unique<BodyLight>(disc);
  }
  return std::unique_ptr<const WrenchGather>(new WrenchGather(scene, beams, std::move(lights)));
}

WrenchGather::WrenchGather(const TraceableScene& scene, std::span<const Beam> beams,
                           std::map<const Emitter*, std::unique_ptr<BodyLight>> lights)
    : scene_(scene),
      beams_(beams.begin(), beams.end()),
      facets_(scene.scene()),
      lights_(std::move(lights)) {
  // Tables serve all attitudes: the body turns about the lab's origin.
  const double radius_m = scene.scene().radius_m();
  for (const Beam& beam : beams_) {
    const double height_m = beam.lab_from_emitter.inverse().point(Vec3::Zero()).z();
    lights_.at(beam.emitter.get())->reach(height_m - radius_m, height_m + radius_m);
  }
}

Gathered WrenchGather::wrench(const RigidTransform& lab_from_body, const WrenchReceiver& receiver,
                              const GatherOptions& options) const {
  const auto start = std::chrono::steady_clock::now();
  const Scene& scene = scene_.scene();
  const Vec3& about_m = receiver.about_body_m();
  std::vector<BodyLamp> lamps;
  for (const Beam& beam : beams_) {
    lamps.emplace_back(beam, *lights_.at(beam.emitter.get()), lab_from_body.inverse(), scene.bands,
                       scene_diameter_m(scene_));
  }
  std::vector<Item> items;
  for (uint32_t lamp = 0; lamp < lamps.size(); ++lamp) {
    for (uint32_t instance = 0; instance < scene.instances.size(); ++instance) {
      const auto part = receiver.part_of(instance);
      if (part) items.push_back({lamp, instance, *part, {}, {}});
    }
  }
  const auto surface = [&](const Item& item, bool front) -> const OpticalSurface& {
    const Instance& of = scene.instances[item.instance];
    return scene.surfaces[front ? of.front_surface : of.back_surface];
  };
  parallel_for(items.size(), options.threads, [&](size_t i) {
    Item& item = items[i];
    const bool plain = !surface(item, true).bsdf && !surface(item, false).bsdf;
    find_sides(facets_, lamps[item.lamp], plain, about_m, item);
  });
  std::erase_if(items, [](const Item& item) { return item.open.empty() && item.sampled.empty(); });
  double weight = 0.0;
  for (const Item& item : items) weight += item.weight;
  const double points_per_weight = weight > 0.0 ? options.body_points / weight : 0.0;
  parallel_for(items.size(), options.threads, [&](size_t i) {
    Item& item = items[i];
    const BodyLamp& lamp = lamps[item.lamp];
    const auto contact = [&](bool front) {
      return FirstContact(surface(item, front), front, lamp.fraction(), scene.bands.count());
    };
    const SampledLight light{scene_, lamp, {contact(false), contact(true)}, about_m};
    item.replicates.assign(static_cast<size_t>(options.replicates), WrenchSum::Zero());
    const WrenchEntries entries{item.replicates, item.bound};
    for (const FacetSide& side : item.open) add_open(light, side, entries);
    if (item.sampled.empty()) return;
    share_points(item, points_per_weight, about_m);
    item.rays = add_sampled(light, item.sampled, options.seed, hash_words(item.lamp, item.instance),
                            entries);
  });
  Gathered result = sum_of(items, receiver, options.replicates);
  result.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace photorque
