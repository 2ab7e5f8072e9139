#include "receivers/gather/bodies/sampler.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/numerics/random.h"

namespace photorque {
namespace {

// A ray towards a side of the group.
struct GroupRay {
  Vec3 at_m, travel;  // body frame
  double power_W;
  uint32_t side, replicate;
  bool lit;
};

// What decides how the light of a side is summed.
struct SideLight {
  double lit_W = 0.0, dark_W = 0.0;
  bool as_open = false;  // less what is dark
};

// Sides whose points share a block, or one that takes several blocks.
class FacetSampler {
 public:
  FacetSampler(const SampledLight& light, const WrenchEntries& entries)
      : light_(light),
        entries_(entries),
        ray_offset_m_(shadow_ray_offset_m(light.scene)),
        body_from_emitter_(light.lamp.body_from_emitter().rotation.toRotationMatrix()),
        emitter_from_body_(body_from_emitter_.transpose()) {}

  // The points of the group begin at `first` of each replicate's sequence.
  uint64_t run(std::span<const SampledSide> group, std::span<const SobolStream> streams,
               uint32_t first) {
    const size_t blocks = std::max<size_t>(group[0].points / ray_block, 1);
    rays_.clear();
    std::array<uint32_t*, sobol_dimensions> out;
    for (size_t k = 0; k < sobol_dimensions; ++k) out[k] = samples_.bits[k].data();
    for (replicate_ = 0; replicate_ < streams.size(); ++replicate_) {
      for (size_t block = 0; block < blocks; ++block) {
        sobol_points(streams[replicate_], first + static_cast<uint32_t>(block) * ray_block, out);
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
  // Lines to one side, from the points [first, first + count) of the block.
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
      // Area-preserving from the unit square.
      const double root = std::sqrt(sobol_fraction(samples_.bits[dimension][i]));
      const double t = sobol_fraction(samples_.bits[dimension + 1][i]);
      const Vec3 at = origin + root * (1.0 - t) * edge1 + root * t * edge2;
      Vec3 from;
      double power_W = share_m2;
      if (directed) {
        const Vec3 direction(emitted_.direction[0][i], emitted_.direction[1][i],
                             emitted_.direction[2][i]);
        power_W *= light_.lamp.along_direction_W_m2(direction, at, normal_emitter, from);
      } else {
        from = {emitted_.origin_m[0][i], emitted_.origin_m[1][i], emitted_.origin_m[2][i]};
        power_W *= light_.lamp.from_point_W_m2(from, at, normal_emitter);
      }
      if (power_W > 0.0) add_ray(index, power_W, at, from, normal, normal_emitter);
    }
  }

  void add_ray(uint32_t index, double power_W, const Vec3& at, const Vec3& from, const Vec3& normal,
               const Vec3& normal_emitter) {
    const Vec3 at_body = body_from_emitter_ * at + light_.lamp.body_from_emitter().translation_m;
    const Vec3 between = from - at - ray_offset_m_ * normal_emitter;
    const double length = between.norm();
    const Vec3 towards = body_from_emitter_ * (between / length);
    const Vec3 origin = at_body + ray_offset_m_ * normal;
    rays_.push_back({at_body, -towards, power_W, index, static_cast<uint32_t>(replicate_), false});
    ShadowRay& ray = shadow_[count_++];
    for (int k = 0; k < 3; ++k) {
      ray.origin_m[k] = static_cast<float>(origin[k]);
      ray.direction[k] = static_cast<float>(towards[k]);
    }
    ray.length_m = static_cast<float>(length - ray_offset_m_);
  }

  const FirstContact& contact_of(const FacetSide& side) const {
    return light_.contact[side.front ? 1 : 0];
  }

  void settle(std::span<const SampledSide> group) {
    sides_.assign(group.size(), {});
    for (const GroupRay& ray : rays_) {
      (ray.lit ? sides_[ray.side].lit_W : sides_[ray.side].dark_W) += ray.power_W;
    }
    for (size_t s = 0; s < group.size(); ++s) {
      const FacetSide& side = group[s].side;
      sides_[s].as_open =
          group[s].whole && contact_of(side).plain() && sides_[s].lit_W > sides_[s].dark_W;
      if (sides_[s].as_open) add_open(light_, side, entries_);
    }
    for (const GroupRay& ray : rays_) {
      const bool as_open = sides_[ray.side].as_open;
      if (ray.lit == as_open) continue;
      const FacetSide& side = group[ray.side].side;
      const double signed_N = (as_open ? -ray.power_W : ray.power_W) / speed_of_light_m_s;
      entries_.replicates[ray.replicate] += wrench_of(
          signed_N * contact_of(side).of_ray(ray.travel, side.normal()), ray.at_m - light_.about_m);
    }
  }

  const SampledLight& light_;
  const WrenchEntries& entries_;
  double ray_offset_m_;
  Mat3 body_from_emitter_, emitter_from_body_;
  SampleBlock samples_;
  RayBlock emitted_;
  size_t count_ = 0, replicate_ = 0;
  std::vector<GroupRay> rays_;    // of the group, replicate by replicate
  std::vector<SideLight> sides_;  // of the group
  std::array<ShadowRay, ray_block> shadow_;
  std::array<uint8_t, ray_block> lit_;
};

}  // namespace

void add_open(const SampledLight& light, const FacetSide& side, const WrenchEntries& entries) {
  const auto open = light.lamp.open_wrench(side, light.contact[side.front ? 1 : 0], light.about_m);
  for (WrenchSum& replicate : entries.replicates) replicate += open.wrench;
  entries.bound.head<3>() += open.force_error_N;
  entries.bound.tail<3>() += open.torque_error_N_m;
}

uint64_t add_sampled(const SampledLight& light, std::vector<SampledSide> sides, uint64_t seed,
                     uint64_t which, const WrenchEntries& entries) {
  // So that the points of each are a whole stretch of their sequence.
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

}  // namespace photorque
