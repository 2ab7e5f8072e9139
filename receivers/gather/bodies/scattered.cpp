#include "receivers/gather/bodies/scattered.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>

#include "core/numerics/random.h"
#include "core/parallel.h"
#include "raytrace/surfaces/bsdf.h"
#include "receivers/gather/bodies/partition.h"

namespace photorque {
namespace {

constexpr size_t chunk = 64;  // patches per item of parallel work

// Sobol points on a patch, each with a direction by Lambert's law.
struct Starts {
  std::vector<Vec3> at_m, direction;
};

Starts starts_of(const FacetSide& side, const Cell& cell, const SobolStream& stream, uint32_t first,
                 uint32_t count) {
  const Facet& facet = *side.facet;
  const Vec3 normal = side.normal();
  SampleBlock samples;
  sobol_points(stream, first, samples.columns());
  const Vec3 x = normal.unitOrthogonal(), y = normal.cross(x);
  const Vec3 e1 = facet.corner_m[1] - facet.corner_m[0], e2 = facet.corner_m[2] - facet.corner_m[0];
  Starts starts;
  for (uint32_t i = 0; i < count; ++i) {
    const auto u = [&](size_t k) { return sobol_fraction(samples.bits[k][i]); };
    const double root = std::sqrt(u(0)), second = u(1);
    const Vec2 uv = cell.at({1.0 - root, root * (1.0 - second), root * second});
    const Vec3 local = lambertian_direction(u(2), u(3));
    starts.at_m.emplace_back(facet.corner_m[0] + uv[0] * e1 + uv[1] * e2);
    starts.direction.emplace_back(local.x() * x + local.y() * y + local.z() * normal);
  }
  return starts;
}

// For each of at most one block of points: whether another surface is close above it.
std::vector<bool> covered_of(const TraceableScene& scene, std::span<const Vec3> at_m,
                             const Vec3& normal, double close_m) {
  std::array<ShadowRay, sobol_block> rays;
  std::array<uint8_t, sobol_block> clear;
  for (size_t i = 0; i < at_m.size(); ++i) {
    rays[i] = probe(scene, at_m[i], normal, normal, close_m);
  }
  find_shadows(scene, std::span(rays).first(at_m.size()), clear);
  std::vector<bool> covered;
  for (size_t i = 0; i < at_m.size(); ++i) covered.push_back(clear[i] == 0);
  return covered;
}

}  // namespace

size_t ScatteredLight::node_of(size_t side, uint32_t level, uint64_t path) const {
  size_t node = root_[side];
  for (uint32_t left = level; left-- > 0 && nodes_[node].first_quarter != 0;) {
    node = nodes_[node].first_quarter + ((path >> (2 * left)) & 3);
  }
  return node;
}

size_t ScatteredLight::node_at(size_t side, const Vec2& uv) const {
  size_t node = root_[side];
  CornerWeights weights(1.0 - uv[0] - uv[1], uv[0], uv[1]);
  while (nodes_[node].first_quarter != 0) {
    const uint32_t which = quarter_of(weights);
    weights = in_quarter(weights, which);
    node = nodes_[node].first_quarter + which;
  }
  return node;
}

ScatteredLight::ScatteredLight(const TraceableScene& scene, const BodyShape& shape,
                               const Vec3& about_m, const Effort& effort)
    : patch_m2_(shape.facets.area_m2() / static_cast<double>(effort.patches)),
      close_m_(0.03 * std::sqrt(patch_m2_)) {
  const bool opaque =
      std::ranges::none_of(scene.scene().surfaces, any_positive, &OpticalSurface::transmitted);
  for (const Facet& facet : shape.facets.all()) {
    for (const bool front : {false, true}) {
      const FacetSide one{&facet, front};
      const size_t side = unseen_.size();
      const bool inside = opaque && shape.facets.inward(facet.instance) == front;
      unseen_.push_back(one.is_free() || inside);
      root_.push_back(static_cast<uint32_t>(nodes_.size()));
      nodes_.push_back({});
      Screen screen(facet);
      lines_.emplace_back();
      if (!unseen_.back() && facet.area_m2 > patch_m2_) {
        const Vec3 normal = one.normal();
        const double rounding_m = plane_rounding * scene_diameter_m(scene);
        std::vector<Line> lines = shape.outlines.in_light(-normal);
        std::ranges::copy(shape.cuts[shape.facets.number_of(facet)], std::back_inserter(lines));
        screen.add(lines, normal, -normal, rounding_m);
        for (const Line& line : lines) {
          Screen single(facet);
          single.add(std::span(&line, 1), normal, -normal, rounding_m);
          if (!single.traces().empty() && single.traces()[0].height_m < close_m_) {
            lines_.back().push_back(line);
          }
        }
      }
      if (!unseen_.back()) grow(side, root_.back(), {}, screen.traces(), facet);
    }
  }
  const auto bands = static_cast<size_t>(scene.scene().bands.count());
  per_watt_.assign(bands,
                   std::vector<Pair>(nodes_.size(), {TwofoldSum::Zero(), TwofoldSum::Zero()}));
  find_covered(scene, shape.facets, effort.seed);
  for (size_t band = 0; band < bands; ++band) {
    for (const int half : {0, 1}) {
      const Task task{scene, shape.facets, about_m, effort, band, half};
      const std::vector<Work> work = work_of(task);
      if (!work.empty()) settle(task, work, send_out(task, work));
    }
    find_means(band);
  }
}

// Divides a cell until it is small compared with the body and with parts on it or close above it.
void ScatteredLight::grow(size_t side, size_t node, const Cell& cell, std::span<const Trace> traces,
                          const Facet& facet) {
  constexpr uint32_t finer = 3;  // additional divisions below the common size
  constexpr double margin = 0.5;
  const double cell_m2 = cell.share() * facet.area_m2, size_m = std::sqrt(cell_m2);
  std::vector<Trace> close;
  for (const Trace& trace : traces) {
    if (trace.height_m < size_m && meets(trace, margin)) close.push_back(trace);
  }
  const double long_m = std::ldexp(facet.ball.radius_m, -static_cast<int>(cell.level));
  const bool small = cell_m2 < patch_m2_ && long_m < 2.0 * std::sqrt(patch_m2_);
  const bool smallest = cell_m2 < patch_m2_ / (1 << (2 * finer));
  if (smallest || (small && close.empty())) {
    nodes_[node].crowded = !close.empty();
    patches_.push_back({side, node, cell});
    return;
  }
  const auto first = static_cast<uint32_t>(nodes_.size());
  nodes_[node].first_quarter = first;
  nodes_.resize(nodes_.size() + 4);
  std::vector<Trace> own(traces.size());
  for (uint32_t q = 0; q < 4; ++q) {
    for (size_t i = 0; i < traces.size(); ++i) own[i] = in_quarter(traces[i], q);
    grow(side, first + q, cell.quarter(q), own, facet);
  }
}

// Determines the covered fraction of crowded patches. A patch that is completely covered or
// completely clear needs one value only and is no longer crowded.
void ScatteredLight::find_covered(const TraceableScene& scene, const Facets& facets,
                                  uint64_t seed) {
  for (const Patch& patch : patches_) {
    Node& node = nodes_[patch.node];
    if (!node.crowded) continue;
    const FacetSide side = facets.side(patch.side);
    const Starts starts = starts_of(side, patch.cell, {seed, patch.node, 0}, 0, 64);
    const std::vector<bool> covered = covered_of(scene, starts.at_m, side.normal(), close_m_);
    node.covered = static_cast<double>(std::ranges::count(covered, true)) / 64.0;
    node.crowded = node.covered > 0.0 && node.covered < 1.0;
  }
}

std::vector<ScatteredLight::Work> ScatteredLight::work_of(const Task& task) const {
  const Scene& parts = task.scene.scene();
  std::vector<Work> work;
  for (const Patch& patch : patches_) {
    const FacetSide side = task.facets.side(patch.side);
    const Instance& of = parts.instances[side.facet->instance];
    if (!(parts.surface(of, side.front).diffuse[task.band] > 0.0)) continue;
    work.push_back({patch, 0});
    if (nodes_[patch.node].crowded) work.push_back({patch, 1});
  }
  return work;
}

// Adds rays of 1 W in total from the points of a patch that are of one kind (covered or clear).
void ScatteredLight::add_starts(const Task& task, const Work& one, uint64_t number, uint32_t count,
                                uint32_t owner, std::vector<OnwardRay>& rays) const {
  const Patch& patch = one.patch;
  const FacetSide side = task.facets.side(patch.side);
  const Vec3 normal = side.normal();
  const SobolStream stream{task.effort.seed,
                           hash_words(number, static_cast<uint64_t>(task.half), task.band), 0};
  const uint32_t at_once = std::min(count, sobol_block);
  std::vector<OnwardRay> others;
  for (uint32_t begin = 0; begin < count; begin += at_once) {
    const Starts starts = starts_of(side, patch.cell, stream, begin, at_once);
    std::vector<bool> covered(at_once, one.kind == 1);
    if (nodes_[patch.node].crowded) {
      covered = covered_of(task.scene, starts.at_m, normal, close_m_);
    }
    for (size_t i = 0; i < starts.at_m.size(); ++i) {
      const Vec3 from = starts.at_m[i] + shadow_ray_offset_m(task.scene) * normal;
      (covered[i] == (one.kind == 1) ? rays : others)
          .push_back({from, starts.direction[i], {}, owner});
    }
  }
  if (rays.empty()) std::swap(rays, others);  // no sampled point is of this kind: use the others
  for (OnwardRay& ray : rays) ray.power_W[task.band] = 1.0 / static_cast<double>(rays.size());
}

// Merges all parts with the same place into one.
void ScatteredLight::merge_places(std::vector<Reached::Part>& parts, size_t from) {
  const auto begin = parts.begin() + static_cast<std::ptrdiff_t>(from);
  std::stable_sort(begin, parts.end(),
                   [](const auto& a, const auto& b) { return a.place < b.place; });
  size_t kept = from;
  for (size_t i = from; i < parts.size(); ++i) {
    if (kept > from && parts[kept - 1].place == parts[i].place) {
      parts[kept - 1].fraction += parts[i].fraction;
    } else {
      parts[kept++] = parts[i];
    }
  }
  parts.resize(kept);
}

std::vector<ScatteredLight::Reached> ScatteredLight::send_out(const Task& task,
                                                              const std::vector<Work>& work) const {
  constexpr uint64_t most = 1 << 14;
  constexpr double cutoff = 1e-5;
  const uint64_t wanted = task.effort.rays / work.size();
  const auto count = static_cast<uint32_t>(std::bit_floor(std::clamp<uint64_t>(wanted, 16, most)));
  std::vector<Reached> reached((work.size() + chunk - 1) / chunk);
  parallel_for(reached.size(), task.effort.threads, [&](size_t c) {
    const size_t first = c * chunk, last = std::min(first + chunk, work.size());
    Reached& own = reached[c];
    own.contact.assign(last - first, WrenchSum::Zero());
    OnwardLight onward(task.scene, task.facets.numbers(), task.about_m);
    const OnwardSink sink{
        [&](uint32_t owner, const WrenchSum& wrench) { own.contact[owner] += wrench; },
        [&](uint32_t owner, size_t side, const Vec2& uv, const BandValues& power_W) {
          own.parts.push_back({owner, node_at(side, uv), power_W[task.band]});
        }};
    std::vector<OnwardRay> rays;
    for (size_t w = first; w < last; ++w) {
      const size_t before = own.parts.size();
      add_starts(task, work[w], w, count, static_cast<uint32_t>(w - first), rays);
      onward.follow(rays, cutoff, sink);
      merge_places(own.parts, before);
    }
  });
  return reached;
}

// Solves w = contact + fractions · w by fixed-point iteration.
void ScatteredLight::settle(const Task& task, const std::vector<Work>& work,
                            const std::vector<Reached>& reached) {
  std::vector<Pair>& per_watt = per_watt_[task.band];
  const Eigen::Index own = 6 * task.half;
  constexpr int most_rounds = 2000;
  constexpr double settled = 1e-7;
  for (int round = 0; round < most_rounds; ++round) {
    std::vector<WrenchSum> next(work.size());
    parallel_for(reached.size(), task.effort.threads, [&](size_t c) {
      const auto begin = static_cast<std::ptrdiff_t>(c * chunk);
      std::ranges::copy(reached[c].contact, next.begin() + begin);
      for (const Reached::Part& one : reached[c].parts) {
        const TwofoldSum there = mixed(per_watt[one.place], nodes_[one.place].covered);
        next[c * chunk + one.patch] += one.fraction * there.segment<6>(own);
      }
    });
    // First element: forces; second element: torques.
    Eigen::Array2d change = Eigen::Array2d::Zero(), largest = Eigen::Array2d::Zero();
    const auto sizes = [](const WrenchSum& wrench) {
      return Eigen::Array2d(wrench.head<3>().abs().maxCoeff(), wrench.tail<3>().abs().maxCoeff());
    };
    for (size_t w = 0; w < work.size(); ++w) {
      const size_t node = work[w].patch.node;
      auto mine = per_watt[node][work[w].kind].segment<6>(own);
      change = change.max(sizes(next[w] - mine));
      largest = largest.max(sizes(next[w]));
      mine = next[w];
      if (!nodes_[node].crowded) per_watt[node][1].segment<6>(own) = next[w];
    }
    if ((change <= settled * largest).all()) break;
  }
}

// Computes the means of divided cells from their quarters, which follow them in the list.
void ScatteredLight::find_means(size_t band) {
  for (size_t node = nodes_.size(); node-- > 0;) {
    const uint32_t first = nodes_[node].first_quarter;
    if (first == 0) continue;
    for (const size_t kind : {0, 1}) {
      TwofoldSum sum = TwofoldSum::Zero();
      for (size_t q = 0; q < 4; ++q) sum += per_watt_[band][first + q][kind];
      per_watt_[band][node][kind] = 0.25 * sum;
    }
  }
}

}  // namespace photorque
