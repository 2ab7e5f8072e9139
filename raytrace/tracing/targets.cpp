#include "raytrace/tracing/targets.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/constants.h"
#include "core/numerics/vector_math.h"

namespace photorque {
namespace {

// A vertex in the emitter's frame, with the distances that determine its shift with the light's
// direction.
struct Seen {
  double x_m, y_m;
  double height_m, across_m;  // |z| over the disc's middle; ρ from the axis
};
struct SeenTriangle {
  std::array<Seen, 3> corner;

  double margin_m(double sine) const {
    const double rise = sine * sine / (1.0 + std::sqrt(1.0 - sine * sine));
    double margin_m = 0.0;
    for (const Seen& seen : corner) {
      margin_m = std::max(margin_m, seen.height_m * sine + seen.across_m * rise);
    }
    return margin_m;
  }
};

// The median height along the light of the area that the light meets. A disc at this height has
// small margins for a scene with most of its area at one height.
double median_height_m(const Scene& scene, const Vec3& centre_m, const Vec3& along) {
  std::vector<std::pair<double, double>> areas;  // height, area
  double sum = 0.0;
  for (const Instance& part : scene.instances) {
    const Mesh& mesh = scene.meshes[part.mesh];
    for (const auto& [a, b, c] : mesh.triangles) {
      const Vec3 p = part.body_from_mesh * mesh.vertices_m[a] - centre_m;
      const Vec3 q = part.body_from_mesh * mesh.vertices_m[b] - centre_m;
      const Vec3 r = part.body_from_mesh * mesh.vertices_m[c] - centre_m;
      areas.emplace_back(along.dot(p + q + r) / 3.0, std::abs(along.dot((q - p).cross(r - p))));
      sum += areas.back().second;
    }
  }
  std::ranges::sort(areas);
  double below = 0.0;
  for (const auto& [height_m, area] : areas) {
    below += area;
    if (below >= 0.5 * sum) return height_m;
  }
  return 0.0;
}

// Triangles of all parts; for scenes of more than `most` triangles, those of the boxes around the
// parts' meshes. Heights count from `middle_m` above the scene's centre.
std::vector<SeenTriangle> triangles_of(const Scene& scene, const Vec3& centre_m, double middle_m,
                                       const Quat& rays_from_body, uint64_t most) {
  const auto seen_at = [&](const Vec3& body_m) {
    const Vec3 at_m = rays_from_body * (body_m - centre_m);
    return Seen{at_m.x(), at_m.y(), std::abs(at_m.z() - middle_m), std::hypot(at_m.x(), at_m.y())};
  };
  size_t count = 0;
  for (const Instance& part : scene.instances) count += scene.meshes[part.mesh].triangles.size();
  std::vector<SeenTriangle> triangles;
  for (const Instance& part : scene.instances) {
    const Mesh& mesh = scene.meshes[part.mesh];
    std::vector<Seen> corners;
    if (count <= most) {
      for (const Vec3& at_m : mesh.vertices_m)
        corners.push_back(seen_at(part.body_from_mesh * at_m));
      for (const auto& [a, b, c] : mesh.triangles) {
        triangles.push_back({corners[a], corners[b], corners[c]});
      }
      continue;
    }
    Eigen::AlignedBox3d box;
    for (const Vec3& at_m : mesh.vertices_m) box.extend(at_m);
    for (int i = 0; i < 8; ++i) {
      const auto corner = static_cast<Eigen::AlignedBox3d::CornerType>(i);
      corners.push_back(seen_at(part.body_from_mesh * box.corner(corner)));
    }
    // Two triangles per face of the box. The corners of a face differ in two of the three axes.
    for (const auto& [a, b, c, d] : {std::array{0, 1, 3, 2},
                                     {4, 5, 7, 6},
                                     {0, 1, 5, 4},
                                     {2, 3, 7, 6},
                                     {0, 2, 6, 4},
                                     {1, 3, 7, 5}}) {
      const auto at = [&](int k) { return corners[static_cast<size_t>(k)]; };
      triangles.push_back({at(a), at(b), at(c)});
      triangles.push_back({at(a), at(c), at(d)});
    }
  }
  return triangles;
}

// A bitmap of square cells.
class BitGrid {
 public:
  // Covers [low, high] with `side` cells (a power of two ≥ 64) along the longer edge.
  BitGrid(const Vec2& low_m, const Vec2& high_m, size_t side)
      : low_m_(low_m),
        size_m_((high_m - low_m).maxCoeff() * (1.0 + 1e-9) / static_cast<double>(side)),
        side_(side),
        bits_(side * side / 64, 0) {}

  void mark(const SeenTriangle& triangle, double margin_m);
  size_t count() const;
  // Merges 2 × 2 cells.
  void halve();
  Targets::Cells cells() const;

 private:
  size_t words() const { return side_ / 64; }
  size_t place(double at_m, double from_m) const {
    const double cell = std::floor((at_m - from_m) / size_m_);
    return static_cast<size_t>(std::clamp(cell, 0.0, static_cast<double>(side_ - 1)));
  }
  void mark_row(size_t row, double from_m, double to_m);

  Vec2 low_m_;
  double size_m_;
  size_t side_;
  std::vector<uint64_t> bits_;  // row by row
};

void BitGrid::mark_row(size_t row, double from_m, double to_m) {
  const size_t first = place(from_m, low_m_.x()), last = place(to_m, low_m_.x());
  uint64_t* bits = &bits_[row * words()];
  for (size_t word = first / 64; word <= last / 64; ++word) {
    uint64_t mask = ~uint64_t{0};
    if (word == first / 64) mask &= ~uint64_t{0} << (first % 64);
    if (word == last / 64) mask &= ~uint64_t{0} >> (63 - last % 64);
    bits[word] |= mask;
  }
}

void BitGrid::mark(const SeenTriangle& triangle, double margin_m) {
  const auto& [a, b, c] = triangle.corner;
  const auto [y_low, y_high] = std::minmax({a.y_m, b.y_m, c.y_m});
  const auto [x_low, x_high] = std::minmax({a.x_m, b.x_m, c.x_m});
  const size_t first = place(y_low - margin_m, low_m_.y()),
               last = place(y_high + margin_m, low_m_.y());
  if (last - first < 2) {
    for (size_t row = first; row <= last; ++row) mark_row(row, x_low - margin_m, x_high + margin_m);
    return;
  }
  for (size_t row = first; row <= last; ++row) {
    // Range of the triangle within the row, extended by the margin on both sides.
    const double bottom_m = low_m_.y() + static_cast<double>(row) * size_m_ - margin_m;
    const double top_m = bottom_m + size_m_ + 2.0 * margin_m;
    double from_m = std::numeric_limits<double>::max(), to_m = -from_m;
    const auto reach = [&](double x_m) {
      from_m = std::min(from_m, x_m);
      to_m = std::max(to_m, x_m);
    };
    for (const auto& [from, to] : {std::pair(&a, &b), {&b, &c}, {&c, &a}}) {
      const double rise_m = to->y_m - from->y_m;
      if (std::max(from->y_m, to->y_m) < bottom_m || std::min(from->y_m, to->y_m) > top_m) continue;
      const auto at = [&](double y_m) {
        const double part = rise_m == 0.0 ? 0.0 : std::clamp((y_m - from->y_m) / rise_m, 0.0, 1.0);
        return from->x_m + part * (to->x_m - from->x_m);
      };
      if (rise_m == 0.0) reach(to->x_m);
      reach(at(bottom_m));
      reach(at(top_m));
    }
    if (from_m <= to_m) mark_row(row, from_m - margin_m, to_m + margin_m);
  }
}

size_t BitGrid::count() const {
  size_t sum = 0;
  for (const uint64_t word : bits_) sum += static_cast<size_t>(std::popcount(word));
  return sum;
}

// Packs every second bit of a word into its lower half.
uint64_t even_bits(uint64_t x) {
  x &= 0x5555555555555555u;
  x = (x | (x >> 1)) & 0x3333333333333333u;
  x = (x | (x >> 2)) & 0x0f0f0f0f0f0f0f0fu;
  x = (x | (x >> 4)) & 0x00ff00ff00ff00ffu;
  x = (x | (x >> 8)) & 0x0000ffff0000ffffu;
  return (x | (x >> 16)) & 0x00000000ffffffffu;
}

void BitGrid::halve() {
  BitGrid half = *this;
  half.side_ = side_ / 2;
  half.size_m_ = 2.0 * size_m_;
  half.bits_.assign(half.side_ * half.side_ / 64, 0);
  for (size_t row = 0; row < half.side_; ++row) {
    for (size_t word = 0; word < words(); ++word) {
      const uint64_t both = bits_[2 * row * words() + word] | bits_[(2 * row + 1) * words() + word];
      half.bits_[row * half.words() + word / 2] |= even_bits(both | (both >> 1))
                                                   << (32 * (word % 2));
    }
  }
  *this = std::move(half);
}

Targets::Cells BitGrid::cells() const {
  std::vector<uint32_t> curve;
  for (size_t row = 0; row < side_; ++row) {
    for (size_t word = 0; word < words(); ++word) {
      for (uint64_t left = bits_[row * words() + word]; left != 0; left &= left - 1) {
        const auto column = 64 * word + static_cast<size_t>(std::countr_zero(left));
        curve.push_back(with_gaps(static_cast<uint32_t>(column)) |
                        (with_gaps(static_cast<uint32_t>(row)) << 1));
      }
    }
  }
  std::sort(curve.begin(), curve.end());
  Targets::Cells cells{low_m_.x(), low_m_.y(), size_m_, {}};
  for (const uint32_t place : curve) {
    cells.cells.push_back(
        {static_cast<uint16_t>(even_bits(place)), static_cast<uint16_t>(even_bits(place >> 1))});
  }
  return cells;
}

// Cells for all directions with a sine of the angle from the axis up to `sine`.
Targets::Cells cells_within(const std::vector<SeenTriangle>& triangles, double sine,
                            double rounding_m, uint64_t rays) {
  Vec2 low_m = Vec2::Constant(std::numeric_limits<double>::max()), high_m = -low_m;
  for (const SeenTriangle& triangle : triangles) {
    const Vec2 margin_m = Vec2::Constant(triangle.margin_m(sine) + rounding_m);
    for (const Seen& seen : triangle.corner) {
      low_m = low_m.cwiseMin(Vec2(seen.x_m, seen.y_m) - margin_m);
      high_m = high_m.cwiseMax(Vec2(seen.x_m, seen.y_m) + margin_m);
    }
  }
  // The number of cells follows from the number of rays.
  const uint64_t side = std::clamp<uint64_t>(
      std::bit_ceil(static_cast<uint64_t>(4.0 * std::sqrt(static_cast<double>(rays)))), 64, 4096);
  const uint64_t most_cells = std::clamp<uint64_t>(rays / 16, 256, 65536);
  BitGrid grid(low_m, high_m, side);
  for (const SeenTriangle& triangle : triangles) {
    grid.mark(triangle, triangle.margin_m(sine) + rounding_m);
  }
  for (size_t size = side; size > 64 && grid.count() > most_cells; size /= 2) grid.halve();
  return grid.cells();
}

// Sine of the angle that contains a fraction of the light.
double sine_within(const ParallelLight& light, double fraction) {
  SampleBlock samples{};
  RayBlock rays;
  samples.bits[2].fill(static_cast<uint32_t>(std::min(fraction * 0x1p32, 0x1p32 - 1.0)));
  light.fill_directions(samples, rays);
  return std::hypot(rays.direction[0][0], rays.direction[1][0]);
}

}  // namespace

std::optional<Targets> Targets::of(const Emitter& emitter, const RigidTransform& body_from_emitter,
                                   const TraceableScene::Data& scene, uint64_t rays) {
  const auto* light = dynamic_cast<const ParallelLight*>(&emitter);
  if (light == nullptr) return std::nullopt;
  const Quat& rotation = body_from_emitter.rotation;
  std::optional<Targets> best = at_height(*light, rotation, scene, 0.0, rays);
  const double median_m = median_height_m(scene.scene, scene.centre_m, rotation * Vec3::UnitZ());
  constexpr double same_height = 0.01;  // of the scene's radius
  if (std::abs(median_m) < same_height * scene.radius_m) return best;
  std::optional<Targets> other = at_height(*light, rotation, scene, median_m, rays);
  return other && (!best || other->fraction_ < best->fraction_) ? other : best;
}

std::optional<Targets> Targets::at_height(const ParallelLight& light, const Quat& body_from_emitter,
                                          const TraceableScene::Data& scene, double middle_m,
                                          uint64_t rays) {
  const std::vector<SeenTriangle> triangles =
      triangles_of(scene.scene, scene.centre_m, middle_m, body_from_emitter.conjugate(), rays / 8);
  if (triangles.empty()) return std::nullopt;
  const double before_m = 1.001 * scene.radius_m, height_m = before_m + middle_m;
  // Rounding error of a few operations on coordinates in single precision.
  const double rounding_m = 2e-6 * before_m;
  // Adjacent ranges, from the outside inwards, differ in their angle by at least this factor.
  constexpr double worth = 1.5, rounding_of_sine = 1.0 + 1e-6;
  std::vector<AngleRange> ranges = {{0.0, 1.0, 0.0, 0.0, {}}};
  std::vector<double> sines = {sine_within(light, 1.0) * rounding_of_sine};
  for (const double inner : {0.997, 0.99, 0.98, 0.95, 0.9, 0.8, 0.5}) {
    const double sine = sine_within(light, inner) * rounding_of_sine;
    if (sines.back() == 0.0 || sine * worth > sines.back()) continue;
    ranges.back().from = inner;
    ranges.push_back({0.0, inner, 0.0, 0.0, {}});
    sines.push_back(sine);
  }
  for (size_t i = 0; i < ranges.size(); ++i) {
    ranges[i].cells = cells_within(triangles, sines[i], rounding_m, rays);
  }
  std::reverse(ranges.begin(), ranges.end());
  const RigidTransform body_from_rays{
      body_from_emitter, scene.centre_m - before_m * (body_from_emitter * Vec3::UnitZ())};
  Targets targets(light, body_from_rays, height_m, std::move(ranges));
  constexpr double nearly_all = 0.9;
  if (!(targets.fraction_ < nearly_all)) return std::nullopt;
  return targets;
}

Targets::Targets(const ParallelLight& light, const RigidTransform& body_from_rays, double height_m,
                 std::vector<AngleRange> ranges)
    : light_(&light),
      body_from_rays_(body_from_rays),
      height_m_(height_m),
      ranges_(std::move(ranges)) {
  double sum_m2 = 0.0;
  for (const AngleRange& range : ranges_) sum_m2 += (range.to - range.from) * range.cells.area_m2();
  double before = 0.0;
  for (AngleRange& range : ranges_) {
    const double part = (range.to - range.from) * range.cells.area_m2() / sum_m2;
    range.begin = before;
    range.scale = (range.to - range.from) / part;
    before += part;
  }
  fraction_ = sum_m2 / (pi * light.radius_m() * light.radius_m());
}

void Targets::emit(SampleBlock& samples, RayBlock& rays) const {
  std::array<const AngleRange*, ray_block> range;
  range.fill(&ranges_.front());
  if (ranges_.size() > 1) {
    for (int i = 0; i < ray_block; ++i) {
      const double draw = fraction_of(samples.bits[2][i]);
      size_t k = ranges_.size() - 1;
      while (k > 0 && draw < ranges_[k].begin) --k;
      range[i] = &ranges_[k];
      const double fraction = std::clamp(
          ranges_[k].from + (draw - ranges_[k].begin) * ranges_[k].scale, 0.0, ranges_[k].to);
      samples.bits[2][i] = static_cast<uint32_t>(std::min(fraction * 0x1p32, 0x1p32 - 1.0));
    }
  }
  light_->fill_directions(samples, rays);
  for (int i = 0; i < ray_block; ++i) {
    const Cells& all = range[i]->cells;
    // Index of the cell; the lower half of the word is the position within it.
    const uint64_t count = all.cells.size();
    const uint64_t place = samples.bits[0][i] * count + count / 2;
    const Cell cell = all.cells[place >> 32];
    const double x = cell.x + fraction_of(static_cast<uint32_t>(place));
    const double y = cell.y + fraction_of(samples.bits[1][i]);
    rays.origin_m[0][i] = static_cast<float>(all.x_m + all.size_m * x);
    rays.origin_m[1][i] = static_cast<float>(all.y_m + all.size_m * y);
  }
  ParallelLight::place_on_discs(height_m_, rays);
}

}  // namespace photorque
