#include "raytrace/launch.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "raytrace/transpose.h"

namespace photorque {
namespace {

constexpr uint32_t cell_bits = 5;  // per side
constexpr uint32_t cells_per_side = 1u << cell_bits;
constexpr uint32_t key_count = 8 * cells_per_side * cells_per_side;  // octants × cells

using Column = std::array<float, ray_block>;

// Interleaves the bits of a 5-bit number with zeros (Morton order).
constexpr uint32_t spread_bits(uint32_t x) {
  x = (x | (x << 4)) & 0x10fu;
  x = (x | (x << 2)) & 0x133u;
  return (x | (x << 1)) & 0x155u;
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

void make_keys(const LandingGrid& grid, const Column& x, const Column& y,
               const std::array<Column, 6>& placed, uint16_t* key) {
  constexpr float last = cells_per_side - 1;
  for (int i = 0; i < ray_block; ++i) {
    const float fx = std::min(std::max((x[i] - grid.x_low) * grid.x_scale, 0.0f), last);
    const float fy = std::min(std::max((y[i] - grid.y_low) * grid.y_scale, 0.0f), last);
    const uint32_t cell = spread_bits(static_cast<uint32_t>(static_cast<int32_t>(fx))) |
                          (spread_bits(static_cast<uint32_t>(static_cast<int32_t>(fy))) << 1);
    const uint32_t octant = (std::bit_cast<uint32_t>(placed[3][i]) >> 31) |
                            ((std::bit_cast<uint32_t>(placed[4][i]) >> 31) << 1) |
                            ((std::bit_cast<uint32_t>(placed[5][i]) >> 31) << 2);
    key[i] = static_cast<uint16_t>((octant << (2 * cell_bits)) | cell);
  }
}

// Columns → records.
void store(const std::array<Column, 6>& placed, uint32_t first_sample, Ray* out) {
  for (int begin = 0; begin < ray_block; begin += 8) {
    alignas(32) std::array<float, 64> columns;
    for (size_t c = 0; c < 6; ++c) std::copy_n(&placed[c][begin], 8, &columns[8 * c]);
    for (int i = 0; i < 8; ++i) {
      columns[48 + i] = std::bit_cast<float>(first_sample + static_cast<uint32_t>(begin + i));
      columns[56 + i] = 0.0f;
    }
    transpose_8x8(columns.data(), &out[begin].origin_m[0], 8);
  }
}

void counting_sort(uint32_t count, LaunchBuffer& buffer) {
  buffer.start.assign(key_count + 1, 0);
  for (uint32_t i = 0; i < count; ++i) ++buffer.start[buffer.key[i] + 1u];
  for (uint32_t k = 0; k < key_count; ++k) buffer.start[k + 1] += buffer.start[k];
  for (uint32_t i = 0; i < count; ++i)
    buffer.rays[buffer.start[buffer.key[i]]++] = buffer.unsorted[i];
}

SampleBlock sample_block(const SobolStream& stream, uint32_t first) {
  SampleBlock samples;
  sobol_points(stream, first,
               {samples.bits[0].data(), samples.bits[1].data(), samples.bits[2].data(),
                samples.bits[3].data()});
  return samples;
}

}  // namespace

LandingGrid landing_grid(const Emitter& emitter, const RigidTransform& body_from_emitter,
                         const TraceableScene::Data& scene) {
  LandingGrid grid;
  const Vec3 centre = body_from_emitter.inverse().point(scene.centre_m);
  grid.plane_z_m = centre.z();
  const auto radius = static_cast<float>(scene.radius_m);
  const auto cx = static_cast<float>(centre.x()), cy = static_cast<float>(centre.y());
  float x_low = std::numeric_limits<float>::max(), y_low = x_low, x_high = -x_low, y_high = -x_low;
  RayBlock rays;
  Column x, y;
  for (uint32_t first = 0; first < 4 * sobol_block; first += sobol_block) {
    emitter.emit(sample_block({}, first), rays);
    find_landing(rays, grid.plane_z_m, x, y);
    for (int i = 0; i < ray_block; ++i) {
      x_low = std::min(x_low, x[i]), x_high = std::max(x_high, x[i]);
      y_low = std::min(y_low, y[i]), y_high = std::max(y_high, y[i]);
    }
  }
  if (grid.plane_z_m > 0.0) {  // what misses the scene need not be told apart
    x_low = std::max(x_low, cx - radius), x_high = std::min(x_high, cx + radius);
    y_low = std::max(y_low, cy - radius), y_high = std::min(y_high, cy + radius);
  }
  grid.x_low = x_low;
  grid.y_low = y_low;
  if (x_high > x_low) grid.x_scale = static_cast<float>(cells_per_side) / (x_high - x_low);
  if (y_high > y_low) grid.y_scale = static_cast<float>(cells_per_side) / (y_high - y_low);
  return grid;
}

void launch(const Emitter& emitter, const RigidTransform& body_from_emitter,
            const TraceableScene::Data& scene, const LandingGrid& grid, const SobolStream& stream,
            uint32_t first, uint32_t count, LaunchBuffer& buffer) {
  buffer.rays.resize(count);
  buffer.unsorted.resize(count);
  buffer.key.resize(count);
  RayBlock rays;
  Column x, y;
  std::array<Column, 6> placed;
  for (uint32_t i = 0; i < count; i += ray_block) {
    emitter.emit(sample_block(stream, first + i), rays);
    find_landing(rays, grid.plane_z_m, x, y);
    place(rays, body_from_emitter, scene, placed);
    make_keys(grid, x, y, placed, &buffer.key[i]);
    store(placed, first + i, &buffer.unsorted[i]);
  }
  counting_sort(count, buffer);
}

}  // namespace photorque
