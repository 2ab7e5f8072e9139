// Finds the bins that nothing can shade, for each lamp, and sends shadow rays between the other
// bins and the apertures. For the files of this folder only.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "core/numerics/random.h"
#include "core/parallel.h"
#include "receivers/gather/gather.h"
#include "receivers/gather/plane.h"

namespace photorque {

// A tile that nothing can shade from one lamp, and a ball that contains it.
struct OpenTile {
  BinTile tile;
  Ball ball;
  uint32_t lamp;
};

// Visibility in one square of bins, an item of parallel work.
struct TileSight {
  std::vector<OpenTile> open;      // sorted by lamp
  std::vector<ShadedPair> shaded;  // sorted by lamp
};

// The surface, the lamps and the bodies between them, at one attitude.
class Gathering {
 public:
  // `side` of the grid is front or back. With `tables`, lights that illuminate many bins get a
  // table of their irradiance.
  Gathering(const TraceableScene& scene, const RigidTransform& lab_from_body,
            std::span<const Beam> beams, const SurfaceGrid& grid, Side side, int threads,
            bool tables);

  const GatherPlane& plane() const { return plane_; }
  const GatherLamp& lamp(uint32_t index) const { return lamps_[index]; }
  const std::vector<TileSight>& sights() const { return sights_; }
  size_t shaded_pairs() const;  // pairs of a bin and a lamp

 private:
  void make_table(const DiscLight& light, int threads);
  void descend(const BinTile& tile, uint32_t lamp, std::span<const uint32_t> candidates,
               TileSight& sight) const;

  GatherPlane plane_;
  std::vector<Occluder> occluders_;
  std::vector<GatherLamp> lamps_;
  std::vector<TileSight> sights_;
};

// Whether gathering is possible: one flat surface and lamps with uniform apertures.
bool is_gatherable(const Scene& scene, const SurfaceGrid& grid, std::span<const Beam> beams);

// A ray that may reach a bin; unless blocked, it carries `power_W`. Emitter's frame.
struct CandidateRay {
  double power_W;
  Vec3 at_m, from_m;
  uint32_t instance;
};

// A patch in the emitter's frame.
struct PlacedPatch {
  const SurfacePatch* patch;
  Vec3 origin_m, edge1_m, edge2_m;
  double fraction;  // of the bin's area
};

// Samples the light of one lamp on bins. A Quantity defines the result:
//   using Value = …;  // a sum of rays' contributions
//   Value of(const CandidateRay&, const GatherLamp&) const;
//   void add(const Value&, const GatherLamp&, size_t bin, uint32_t instance,
//            std::span<double> entries) const;
template <typename Quantity>
class ShadedSampler {
 public:
  ShadedSampler(const GatherPlane& plane, const GatherLamp& lamp, const Quantity& quantity,
                size_t points, std::span<const ShadedPair> pairs)
      : plane_(plane),
        lamp_(lamp),
        quantity_(quantity),
        points_(points),
        ray_offset_m_(shadow_ray_offset_m(plane.scene())),
        body_from_emitter_(lamp.body_from_emitter().rotation.toRotationMatrix()),
        scene_from_emitter_m_(lamp.body_from_emitter().translation_m -
                              scene_centre_m(plane.scene())) {
    for (const ShadedPair& pair : pairs) place(pair.bin);
  }

  // Samples all pairs once with the points of `stream`. Returns the number of rays.
  uint64_t run(const SobolStream& stream, std::span<double> entries) {
    // Several bins share a block of points, or one bin takes several blocks.
    const size_t in_block = std::min<size_t>(points_, ray_block);
    const size_t per_block = ray_block / in_block, blocks = points_ / in_block;
    uint64_t rays = 0;
    uint32_t block = 0;
    for (size_t begin = 0; begin < bins_.size(); begin += per_block) {
      const auto some = std::span(bins_).subspan(begin, std::min(per_block, bins_.size() - begin));
      for (size_t pass = 0; pass < blocks; ++pass, ++block) {
        sobol_points(stream, block * ray_block, samples_.columns());
        lamp_.light().emitter().emit(samples_, emitted_);
        count_ = 0;
        for (size_t p = 0; p < some.size(); ++p) add_lines(some[p], p * in_block, in_block);
        rays += count_;
        finish(entries);
      }
    }
    return rays;
  }

 private:
  // A bin and the range of its patches in `placed_`.
  struct Bin {
    uint32_t bin, first, end;
    double area_m2;  // per point
    bool directed;
  };

  void place(uint32_t bin) {
    const double area_m2 = plane_.grid().area_m2[bin];
    const Mat3 rotation = body_from_emitter_.transpose();
    const auto first = static_cast<uint32_t>(placed_.size());
    for (const SurfacePatch& patch : plane_.patches().of(bin)) {
      placed_.push_back(
          {&patch, rotation * patch.origin_m + lamp_.emitter_from_body().translation_m,
           rotation * patch.edge1_m, rotation * patch.edge2_m, patch.area_m2 / area_m2});
    }
    bins_.push_back({bin, first, static_cast<uint32_t>(placed_.size()),
                     area_m2 / static_cast<double>(points_),
                     lamp_.sampled_by_direction(placed_[first].origin_m.z())});
  }

  const PlacedPatch& pick(const Bin& bin, double& s) const {
    for (uint32_t p = bin.first; p + 1 < bin.end; ++p) {
      if (s < placed_[p].fraction) {
        s /= placed_[p].fraction;
        return placed_[p];
      }
      s -= placed_[p].fraction;
    }
    s = std::min(s / placed_[bin.end - 1].fraction, 1.0);
    return placed_[bin.end - 1];
  }

  // Adds rays to one bin, from `count` points of the block.
  void add_lines(const Bin& bin, size_t first, size_t count) {
    const size_t dimension = bin.directed ? 0 : 2;
    for (size_t i = first; i < first + count; ++i) {
      double s = sobol_fraction(samples_.bits[dimension][i]);
      double t = sobol_fraction(samples_.bits[dimension + 1][i]);
      const PlacedPatch& placed = bin.end - bin.first == 1 ? placed_[bin.first] : pick(bin, s);
      if (placed.patch->triangle) {
        const double root = std::sqrt(s);
        s = root * (1.0 - t);
        t = root * t;
      }
      const Vec3 at = placed.origin_m + s * placed.edge1_m + t * placed.edge2_m;
      Vec3 from;
      const double density =
          lamp_.sampled_W_m2(emitted_, i, bin.directed, at, lamp_.normal_emitter(), from);
      if (!(density > 0.0)) continue;
      bin_[count_] = bin.bin;
      instance_[count_] = placed.patch->instance;
      contribution_[count_] =
          quantity_.of({density * bin.area_m2, at, from, placed.patch->instance}, lamp_);
      add_ray(at, from);
    }
  }

  void add_ray(const Vec3& at, const Vec3& from) {
    const Vec3 start = at + ray_offset_m_ * lamp_.normal_emitter();
    const Vec3 between = from - start;
    const double length = between.norm(), per_length = 1.0 / length;
    shadow_[count_++] =
        shadow_ray(body_from_emitter_ * start + scene_from_emitter_m_,
                   body_from_emitter_ * (per_length * between), length - ray_offset_m_);
  }

  // Traces the rays and adds the contributions of consecutive rays to the same bin together.
  void finish(std::span<double> entries) {
    find_shadows(plane_.scene(), std::span(shadow_).first(count_), lit_);
    for (size_t i = 0; i < count_;) {
      typename Quantity::Value sum = contribution_[i] * 0.0;
      const size_t begin = i;
      bool any = false;
      for (; i < count_ && bin_[i] == bin_[begin] && instance_[i] == instance_[begin]; ++i) {
        if (!lit_[i]) continue;
        sum += contribution_[i];
        any = true;
      }
      if (any) quantity_.add(sum, lamp_, bin_[begin], instance_[begin], entries);
    }
  }

  const GatherPlane& plane_;
  const GatherLamp& lamp_;
  const Quantity& quantity_;
  size_t points_;
  double ray_offset_m_;
  Mat3 body_from_emitter_;
  Vec3 scene_from_emitter_m_;
  std::vector<Bin> bins_;
  std::vector<PlacedPatch> placed_;
  SampleBlock samples_;
  RayBlock emitted_;
  size_t count_ = 0;
  std::array<ShadowRay, ray_block> shadow_;
  std::array<typename Quantity::Value, ray_block> contribution_;
  std::array<uint32_t, ray_block> bin_, instance_;
  std::array<uint8_t, ray_block> lit_;
};

// For each replicate: `open` plus the light on the bins that may be shaded, from `points` shadow
// rays each (a power of two). Adds the number of rays to `rays`.
template <typename Quantity>
std::vector<double> sample_shaded(const Gathering& gathering, const Quantity& quantity,
                                  std::span<const double> open, const GatherOptions& options,
                                  int points, uint64_t& rays) {
  std::vector<double> sums;
  for (int r = 0; r < options.replicates; ++r) sums.insert(sums.end(), open.begin(), open.end());
  const std::vector<TileSight>& sights = gathering.sights();
  std::vector<uint64_t> counted(sights.size(), 0);
  parallel_for(sights.size(), options.threads, [&](size_t tile) {
    const std::vector<ShadedPair>& pairs = sights[tile].shaded;
    for (size_t begin = 0, end = 0; begin < pairs.size(); begin = end) {
      const uint32_t lamp = pairs[begin].lamp;
      while (end < pairs.size() && pairs[end].lamp == lamp) ++end;
      ShadedSampler<Quantity> sampler(gathering.plane(), gathering.lamp(lamp), quantity,
                                      static_cast<size_t>(points),
                                      std::span(pairs).subspan(begin, end - begin));
      for (int r = 0; r < options.replicates; ++r) {
        const uint64_t which = hash_words(hash_words(lamp, tile), static_cast<uint64_t>(r));
        counted[tile] +=
            sampler.run({options.seed, which, 0},
                        std::span(sums).subspan(static_cast<size_t>(r) * open.size(), open.size()));
      }
    }
  });
  rays += std::accumulate(counted.begin(), counted.end(), uint64_t{0});
  return sums;
}

}  // namespace photorque
