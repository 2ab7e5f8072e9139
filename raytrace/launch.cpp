#include "raytrace/launch.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include "raytrace/transpose.h"

namespace photorque {
namespace {

// Rays of a batch: many enough that sorting brings packets of close neighbours together, few enough
// that they stay in the cache.
constexpr int log2_batch = 13;

// Bits of a landing cell per side: some eight rays of a batch in each cell, a packet.
uint32_t cell_bits(uint32_t batch) {
  return (static_cast<uint32_t>(std::bit_width(batch)) - 3u) / 2u;
}

using Column = std::array<float, ray_block>;

// Interleaves the bits of an 8-bit number with zeros (Morton order).
constexpr uint32_t spread_bits(uint32_t x) {
  x = (x | (x << 4)) & 0x0f0fu;
  x = (x | (x << 2)) & 0x3333u;
  return (x | (x << 1)) & 0x5555u;
}

// Where the rays of a block cross the plane; if that lies behind the aperture, their directions.
void find_landing(const RayBlock& rays, double plane_z_m, Column& x, Column& y) {
  const double ahead = plane_z_m > 0.0 ? 1.0 : 0.0;
  for (int i = 0; i < ray_block; ++i) {
    const double dz = std::max(rays.direction[2][i], 0.05);
    const double step = ahead * (plane_z_m - rays.origin_m[2][i]) / dz + (1.0 - ahead);
    x[i] = static_cast<float>(ahead * rays.origin_m[0][i] + rays.direction[0][i] * step);
    y[i] = static_cast<float>(ahead * rays.origin_m[1][i] + rays.direction[1][i] * step);
  }
}

// Body frame, near the scene, single precision: columns ox oy oz dx dy dz.
void place(const RayBlock& rays, const RigidTransform& body_from_emitter,
           const TraceableScene::Data& scene, std::array<Column, 6>& placed) {
  const Mat3 r = body_from_emitter.rotation.toRotationMatrix();
  const Vec3 t = body_from_emitter.translation_m - scene.centre_m;
  const Vec3 c = scene.centre_m;
  const double radius = scene.radius_m * 1.001;
  for (int i = 0; i < ray_block; ++i) {
    const double ex = rays.origin_m[0][i], ey = rays.origin_m[1][i], ez = rays.origin_m[2][i];
    const double fx = rays.direction[0][i], fy = rays.direction[1][i], fz = rays.direction[2][i];
    const double dx = r(0, 0) * fx + r(0, 1) * fy + r(0, 2) * fz;
    const double dy = r(1, 0) * fx + r(1, 1) * fy + r(1, 2) * fz;
    const double dz = r(2, 0) * fx + r(2, 1) * fy + r(2, 2) * fz;
    const double ox = r(0, 0) * ex + r(0, 1) * ey + r(0, 2) * ez + t.x();
    const double oy = r(1, 0) * ex + r(1, 1) * ey + r(1, 2) * ez + t.y();
    const double oz = r(2, 0) * ex + r(2, 1) * ey + r(2, 2) * ez + t.z();
    // Up to the tangent plane of the sphere: never past a surface of the scene.
    const double step = std::max(0.0, -(ox * dx + oy * dy + oz * dz) - radius);
    placed[0][i] = static_cast<float>(ox + step * dx + c.x());
    placed[1][i] = static_cast<float>(oy + step * dy + c.y());
    placed[2][i] = static_cast<float>(oz + step * dz + c.z());
    placed[3][i] = static_cast<float>(dx);
    placed[4][i] = static_cast<float>(dy);
    placed[5][i] = static_cast<float>(dz);
  }
}

// Cells of the part of the plane on which a batch lands.
struct LandingGrid {
  uint32_t bits;  // per side
  float x_low, y_low, x_scale, y_scale;

  // From some rays of the batch.
  LandingGrid(const LaunchPlan& plan, uint32_t batch, const Column& x, const Column& y)
      : bits(cell_bits(batch)) {
    const auto [x_least, x_most] = std::minmax_element(x.begin(), x.end());
    const auto [y_least, y_most] = std::minmax_element(y.begin(), y.end());
    x_low = std::max(*x_least, plan.x_low);
    y_low = std::max(*y_least, plan.y_low);
    const float side = static_cast<float>(1u << bits);
    x_scale = side / std::max(std::min(*x_most, plan.x_high) - x_low, 1e-30f);
    y_scale = side / std::max(std::min(*y_most, plan.y_high) - y_low, 1e-30f);
  }
};

void make_keys(const LaunchPlan& plan, const LandingGrid& grid, const Column& x, const Column& y,
               const std::array<Column, 6>& placed, uint16_t* key) {
  const float last = static_cast<float>(1u << grid.bits) - 1.0f;
  const std::array<uint32_t, 3> step = plan.octant_step;
  for (int i = 0; i < ray_block; ++i) {
    const float fx = std::min(std::max((x[i] - grid.x_low) * grid.x_scale, 0.0f), last);
    const float fy = std::min(std::max((y[i] - grid.y_low) * grid.y_scale, 0.0f), last);
    const uint32_t cell = spread_bits(static_cast<uint32_t>(static_cast<int32_t>(fx))) |
                          (spread_bits(static_cast<uint32_t>(static_cast<int32_t>(fy))) << 1);
    const uint32_t octant = (std::bit_cast<uint32_t>(placed[3][i]) >> 31) * step[0] +
                            (std::bit_cast<uint32_t>(placed[4][i]) >> 31) * step[1] +
                            (std::bit_cast<uint32_t>(placed[5][i]) >> 31) * step[2];
    key[i] = static_cast<uint16_t>((octant << (2 * grid.bits)) | cell);
  }
}

// Columns → records.
void store(const std::array<Column, 6>& placed, const uint32_t* sample, Ray* out) {
  for (int begin = 0; begin < ray_block; begin += 8) {
    alignas(32) std::array<float, 64> columns;
    for (size_t c = 0; c < 6; ++c) std::copy_n(&placed[c][begin], 8, &columns[8 * c]);
    for (int i = 0; i < 8; ++i) {
      columns[48 + i] = std::bit_cast<float>(sample[begin + i]);
      columns[56 + i] = 0.0f;
    }
    std::array<const float*, 8> rows;
    for (size_t c = 0; c < 8; ++c) rows[c] = &columns[8 * c];
    transpose_8x8(rows, &out[begin].origin_m[0], 8);
  }
}

void counting_sort(uint32_t key_count, LaunchBuffer& buffer) {
  const auto count = static_cast<uint32_t>(buffer.key.size());
  buffer.start.assign(key_count + 1, 0);
  for (uint32_t i = 0; i < count; ++i) ++buffer.start[buffer.key[i] + 1u];
  for (uint32_t k = 0; k < key_count; ++k) buffer.start[k + 1] += buffer.start[k];
  for (uint32_t i = 0; i < count; ++i) buffer.order[buffer.start[buffer.key[i]]++] = i;
}

std::array<uint32_t*, sobol_dimensions> pointers(SampleBlock& samples) {
  return {samples.bits[0].data(), samples.bits[1].data(), samples.bits[2].data(),
          samples.bits[3].data()};
}

// What a sample of a beam's rays tells.
struct BeamSample {
  float x_low = std::numeric_limits<float>::max(), y_low = x_low;
  float x_high = -x_low, y_high = -x_low;
  std::array<uint32_t, 3> negative{};     // components of directions in the body frame
  double aperture2 = 0.0, spread2 = 0.0;  // Σ x² + y² of origins, and of directions
  static constexpr uint32_t rays = 4 * sobol_block;
};

BeamSample sample_beam(const Emitter& emitter, const RigidTransform& body_from_emitter,
                       const TraceableScene::Data& scene, double plane_z_m) {
  BeamSample sample;
  SampleBlock samples;
  RayBlock rays;
  Column x, y;
  std::array<Column, 6> placed;
  for (uint32_t first = 0; first < BeamSample::rays; first += sobol_block) {
    sobol_points({}, first, pointers(samples));
    emitter.emit(samples, rays);
    find_landing(rays, plane_z_m, x, y);
    place(rays, body_from_emitter, scene, placed);
    for (size_t i = 0; i < ray_block; ++i) {
      sample.x_low = std::min(sample.x_low, x[i]), sample.x_high = std::max(sample.x_high, x[i]);
      sample.y_low = std::min(sample.y_low, y[i]), sample.y_high = std::max(sample.y_high, y[i]);
      for (size_t k = 0; k < 2; ++k) {
        sample.aperture2 += rays.origin_m[k][i] * rays.origin_m[k][i];
        sample.spread2 += rays.direction[k][i] * rays.direction[k][i];
      }
      for (size_t k = 0; k < 3; ++k) sample.negative[k] += std::signbit(placed[3 + k][i]) ? 1 : 0;
    }
  }
  return sample;
}

// Which leading bits the rays of a batch share: those that bring them closest together where they
// land. Halving the aperture and the directions in turn, whichever spreads the landing points more;
// of each, the azimuth first.
std::array<int, sobol_dimensions> shared_bits(int bits, double aperture_m, double spread_m) {
  int of_aperture = 0, of_direction = 0;
  while (of_aperture + of_direction < bits) {
    const bool aperture =
        aperture_m * std::exp2(-0.5 * of_aperture) >= spread_m * std::exp2(-0.5 * of_direction);
    ++(aperture ? of_aperture : of_direction);
  }
  const auto radial = [](int both) { return std::max(both - 1, 0) / 2; };
  return {radial(of_aperture), of_aperture - radial(of_aperture), radial(of_direction),
          of_direction - radial(of_direction)};
}

}  // namespace

LaunchPlan plan_launch(const Emitter& emitter, const RigidTransform& body_from_emitter,
                       const TraceableScene::Data& scene, int log2_rays) {
  const Vec3 centre = body_from_emitter.inverse().point(scene.centre_m);
  const BeamSample sample = sample_beam(emitter, body_from_emitter, scene, centre.z());
  const auto bits = shared_bits(std::max(log2_rays - log2_batch, 0), std::sqrt(sample.aperture2),
                                std::sqrt(sample.spread2) * std::max(centre.z(), 0.0));
  LaunchPlan plan{SobolCells(log2_rays, bits),
                  centre.z(),
                  sample.x_low,
                  sample.x_high,
                  sample.y_low,
                  sample.y_high,
                  {},
                  1};
  if (plan.plane_z_m > 0.0) {  // what misses the scene need not be told apart
    const auto radius = static_cast<float>(scene.radius_m);
    const auto cx = static_cast<float>(centre.x()), cy = static_cast<float>(centre.y());
    plan.x_low = std::max(plan.x_low, cx - radius),
    plan.x_high = std::min(plan.x_high, cx + radius);
    plan.y_low = std::max(plan.y_low, cy - radius),
    plan.y_high = std::min(plan.y_high, cy + radius);
  }
  for (size_t k = 0; k < 3; ++k) {
    if (sample.negative[k] == 0 || sample.negative[k] == BeamSample::rays) continue;
    plan.octant_step[k] = plan.octants;
    plan.octants *= 2;
  }
  return plan;
}

void launch(const Emitter& emitter, const RigidTransform& body_from_emitter,
            const TraceableScene::Data& scene, const LaunchPlan& plan, const SobolStream& stream,
            uint32_t cell, LaunchBuffer& buffer) {
  const uint32_t count = plan.cells.points_per_cell();
  buffer.rays.resize(count);
  buffer.order.resize(count);
  buffer.key.resize(count);
  SampleBlock samples;
  std::array<uint32_t, ray_block> index;
  RayBlock rays;
  Column x, y;
  std::array<Column, 6> placed;
  std::optional<LandingGrid> grid;
  for (uint32_t i = 0; i < count; i += ray_block) {
    plan.cells.points(stream, cell, i, pointers(samples), index.data());
    emitter.emit(samples, rays);
    find_landing(rays, plan.plane_z_m, x, y);
    place(rays, body_from_emitter, scene, placed);
    if (!grid) grid.emplace(plan, count, x, y);
    make_keys(plan, *grid, x, y, placed, &buffer.key[i]);
    store(placed, index.data(), &buffer.rays[i]);
  }
  counting_sort(plan.octants << (2 * grid->bits), buffer);
}

}  // namespace photorque
