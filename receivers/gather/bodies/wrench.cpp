#include "receivers/gather/bodies/wrench.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>
#include <vector>

#include "core/constants.h"
#include "core/numerics/random.h"
#include "core/parallel.h"
#include "raytrace/tracing/shadow.h"
#include "receivers/gather/bodies/lamp.h"

namespace photorque {

namespace {

// A side that may be shaded, or that some rays meet from behind.
struct SampledSide {
  FacetSide side;
  bool whole;           // Exposure::whole
  double power_W;       // estimated power
  uint32_t points = 1;  // rays per replicate: a power of two
};

// The lamp, the effect of its light on both sides of the instance [back, front], and the reference
// point of torques.
struct SampledLight {
  const TraceableScene& scene;
  const BodyLamp& lamp;
  std::array<FirstContact, 2> contact;
  Vec3 about_m;

  const FirstContact& contact_of(const FacetSide& side) const {
    return contact[side.front ? 1 : 0];
  }
};

// Results: six numbers per replicate, and the bounds of their errors.
struct WrenchEntries {
  std::span<WrenchSum> replicates;
  WrenchSum& bound;
};

// Adds the light on a side as if nothing shaded it.
void add_open(const SampledLight& light, const FacetSide& side, const WrenchEntries& entries) {
  const auto open = light.lamp.open_wrench(side, light.contact_of(side), light.about_m);
  for (WrenchSum& replicate : entries.replicates) replicate += open.wrench;
  entries.bound.head<3>() += open.force_error_N;
  entries.bound.tail<3>() += open.torque_error_N_m;
}

// A ray to a side of the group.
struct GroupRay {
  Vec3 at_m, travel;  // body frame
  double power_W;
  uint32_t side, replicate;
  bool lit;
};

// Power that determines how the light of a side is summed.
struct SideLight {
  double lit_W = 0.0, dark_W = 0.0;
  bool as_open = false;  // the open light minus the blocked rays
};

// Samples a group: several sides that share a block of points, or one side with several blocks.
class FacetSampler {
 public:
  FacetSampler(const SampledLight& light, const WrenchEntries& entries)
      : light_(light),
        entries_(entries),
        ray_offset_m_(shadow_ray_offset_m(light.scene)),
        body_from_emitter_(light.lamp.body_from_emitter().rotation.toRotationMatrix()),
        emitter_from_body_(body_from_emitter_.transpose()) {}

  // Samples a group with the points of each replicate's sequence from `first` on. Returns the
  // number of rays.
  uint64_t run(std::span<const SampledSide> group, std::span<const SobolStream> streams,
               uint32_t first) {
    const size_t blocks = std::max<size_t>(group[0].points / ray_block, 1);
    rays_.clear();
    for (replicate_ = 0; replicate_ < streams.size(); ++replicate_) {
      for (size_t block = 0; block < blocks; ++block) {
        sobol_points(streams[replicate_], first + static_cast<uint32_t>(block) * ray_block,
                     samples_.columns());
        light_.lamp.light().emitter().emit(samples_, emitted_);
        count_ = 0;
        size_t at = 0;
        for (uint32_t side = 0; side < group.size(); ++side) {
          const size_t points = std::min<size_t>(group[side].points, ray_block);
          add_lines(group[side], side, at, points);
          at += points;
        }
        find_shadows(light_.scene, std::span(shadow_).first(count_), lit_);
        const size_t begin = rays_.size() - count_;
        for (size_t i = 0; i < count_; ++i) rays_[begin + i].lit = lit_[i] != 0;
      }
    }
    settle(group);
    return rays_.size();
  }

 private:
  // Adds rays to one side, from the points [first, first + count) of the block.
  void add_lines(const SampledSide& sampled, uint32_t index, size_t first, size_t count) {
    const Facet& facet = *sampled.side.facet;
    const Vec3 normal = sampled.side.normal(), normal_emitter = emitter_from_body_ * normal;
    const Vec3 origin = light_.lamp.emitter_from_body().point(facet.corner_m[0]);
    const Vec3 edge1 = emitter_from_body_ * (facet.corner_m[1] - facet.corner_m[0]);
    const Vec3 edge2 = emitter_from_body_ * (facet.corner_m[2] - facet.corner_m[0]);
    const bool directed = light_.lamp.sampled_by_direction(
        light_.lamp.emitter_from_body().point(facet.ball.centre_m).z());
    const size_t dimension = directed ? 0 : 2;
    const double share_m2 = facet.area_m2 / static_cast<double>(sampled.points);
    for (size_t i = first; i < first + count; ++i) {
      // Area-preserving map of the unit square to the triangle.
      const double root = std::sqrt(sobol_fraction(samples_.bits[dimension][i]));
      const double t = sobol_fraction(samples_.bits[dimension + 1][i]);
      const Vec3 at = origin + root * (1.0 - t) * edge1 + root * t * edge2;
      Vec3 from;
      const double power_W =
          share_m2 * light_.lamp.sampled_W_m2(emitted_, i, directed, at, normal_emitter, from);
      if (power_W > 0.0) add_ray(index, power_W, at, from, normal, normal_emitter);
    }
  }

  void add_ray(uint32_t index, double power_W, const Vec3& at, const Vec3& from, const Vec3& normal,
               const Vec3& normal_emitter) {
    const Vec3 at_body = body_from_emitter_ * at + light_.lamp.body_from_emitter().translation_m;
    const Vec3 between = from - at - ray_offset_m_ * normal_emitter;
    const double length = between.norm();
    const Vec3 towards = body_from_emitter_ * (between / length);
    const Vec3 origin = at_body - scene_centre_m(light_.scene) + ray_offset_m_ * normal;
    rays_.push_back({at_body, -towards, power_W, index, static_cast<uint32_t>(replicate_), false});
    shadow_[count_++] = shadow_ray(origin, towards, length - ray_offset_m_);
  }

  void settle(std::span<const SampledSide> group) {
    sides_.assign(group.size(), {});
    for (const GroupRay& ray : rays_) {
      (ray.lit ? sides_[ray.side].lit_W : sides_[ray.side].dark_W) += ray.power_W;
    }
    for (size_t s = 0; s < group.size(); ++s) {
      const FacetSide& side = group[s].side;
      sides_[s].as_open =
          group[s].whole && light_.contact_of(side).plain() && sides_[s].lit_W > sides_[s].dark_W;
      if (sides_[s].as_open) add_open(light_, side, entries_);
    }
    for (const GroupRay& ray : rays_) {
      const bool as_open = sides_[ray.side].as_open;
      if (ray.lit == as_open) continue;
      const FacetSide& side = group[ray.side].side;
      const double signed_N = (as_open ? -ray.power_W : ray.power_W) / speed_of_light_m_s;
      entries_.replicates[ray.replicate] +=
          wrench_of(signed_N * light_.contact_of(side).of_ray(ray.travel, side.normal()),
                    ray.at_m - light_.about_m);
    }
  }

  const SampledLight& light_;
  const WrenchEntries& entries_;
  double ray_offset_m_;
  Mat3 body_from_emitter_, emitter_from_body_;
  SampleBlock samples_;
  RayBlock emitted_;
  size_t count_ = 0, replicate_ = 0;
  std::vector<GroupRay> rays_;    // of the group, in the order of the replicates
  std::vector<SideLight> sides_;  // of the group
  std::array<ShadowRay, ray_block> shadow_;
  std::array<uint8_t, ray_block> lit_;
};

// Adds the light that reaches `sides`. If most rays reach a plain side, its light is the open light
// minus the blocked rays; without blocked rays it has no noise. The points of replicate r come from
// the stream (seed, hash of `which` and r). Returns the number of rays.
uint64_t add_sampled(const SampledLight& light, std::vector<SampledSide> sides, uint64_t seed,
                     uint64_t which, const WrenchEntries& entries) {
  // Sorted by size, so that the points of each side are a complete interval of the sequence.
  std::ranges::stable_sort(sides, std::greater<>(), &SampledSide::points);
  std::vector<SobolStream> streams;
  for (size_t r = 0; r < entries.replicates.size(); ++r) {
    streams.push_back({seed, hash_words(which, r), 0});
  }
  FacetSampler sampler(light, entries);
  uint64_t rays = 0;
  uint32_t first = 0;
  for (size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    size_t points = 0;
    while (end < sides.size() &&
           (end == begin || points + sides[end].points <= static_cast<size_t>(ray_block))) {
      points += sides[end++].points;
    }
    rays += sampler.run(std::span(sides).subspan(begin, end - begin), streams, first);
    first += static_cast<uint32_t>(std::max<size_t>(points, ray_block));
  }
  return rays;
}

// Light of one lamp on one instance: an item of parallel work.
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
  // The inside of a body is dark for lamps outside it.
  const auto inward = lamp.outside(ball) ? facets.inward(item.instance) : std::nullopt;
  for (const Facet& facet : facets.of(item.instance)) {
    for (const bool front : {false, true}) {
      if (inward == front) continue;
      const FacetSide side{&facet, front};
      const Exposure exposure = lamp.exposure_of(side);
      if (exposure == Exposure::none) continue;
      if (plain && exposure == Exposure::whole && side.is_free()) {
        item.open.push_back(side);
        continue;
      }
      item.sampled.push_back({side, exposure == Exposure::whole, lamp.typical_W(side)});
      item.weight += weight_of(item.sampled.back(), about_m);
    }
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
  for (const Beam& beam : beams) {
    if (!beam.aperture) return nullptr;
  }
  auto lights = lights_of(beams);
  for (const auto& light : lights) {
    if (!light->parallel() && !light->fades_out()) return nullptr;
  }
  return std::unique_ptr<const WrenchGather>(new WrenchGather(scene, beams, std::move(lights)));
}

WrenchGather::WrenchGather(const TraceableScene& scene, std::span<const Beam> beams,
                           std::vector<std::shared_ptr<const DiscLight>> lights)
    : scene_(scene),
      beams_(beams.begin(), beams.end()),
      facets_(scene.scene()),
      lights_(std::move(lights)) {
  // The tables are valid at all attitudes, because the body rotates about the lab's origin.
  const double radius_m = scene.scene().radius_m();
  for (size_t i = 0; i < beams_.size(); ++i) {
    const double height_m = beams_[i].lab_from_emitter.inverse().point(Vec3::Zero()).z();
    auto& tables = tables_[lights_[i].get()];
    if (!tables) tables = std::make_unique<BodyLight>(lights_[i]);
    tables->reach(height_m - radius_m, height_m + radius_m);
  }
}

Gathered WrenchGather::wrench(const RigidTransform& lab_from_body, const WrenchReceiver& receiver,
                              const GatherOptions& options) const {
  const Scene& scene = scene_.scene();
  const Vec3& about_m = receiver.about_body_m();
  std::vector<BodyLamp> lamps;
  for (size_t i = 0; i < beams_.size(); ++i) {
    lamps.emplace_back(beams_[i], *tables_.at(lights_[i].get()), lab_from_body.inverse(),
                       scene.bands, scene_diameter_m(scene_));
  }
  std::vector<Item> items;
  for (uint32_t lamp = 0; lamp < lamps.size(); ++lamp) {
    for (uint32_t instance = 0; instance < scene.instances.size(); ++instance) {
      const auto part = receiver.part_of(instance);
      if (part) items.push_back({lamp, instance, *part, {}, {}});
    }
  }
  const auto surface = [&](const Item& item, bool front) -> const OpticalSurface& {
    return scene.surface(scene.instances[item.instance], front);
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
    constexpr double most_points = 1 << 14;
    for (SampledSide& sampled : item.sampled) {
      const double wanted = points_per_weight * weight_of(sampled, about_m);
      sampled.points = std::bit_ceil(static_cast<uint32_t>(std::clamp(wanted, 1.0, most_points)));
    }
    item.rays = add_sampled(light, item.sampled, options.seed, hash_words(item.lamp, item.instance),
                            entries);
  });
  return sum_of(items, receiver, options.replicates);
}

}  // namespace photorque
