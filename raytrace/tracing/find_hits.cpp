#include "raytrace/tracing/find_hits.h"

#include <bit>
#include <cmath>
#include <limits>

#include "core/numerics/transpose.h"

namespace photorque {
namespace {

template <int Width>
void intersect_packets(const TraceableScene::Data& scene, size_t rays, Coherence coherence,
                       HitBuffer& buffer) {
  embree_seam::Query query(coherence);
  alignas(64) std::array<int, Width> valid;
  alignas(64) typename embree_seam::PacketType<Width>::type packet;
  valid.fill(-1);
  embree_seam::initialise<Width>(packet.ray);
  std::fill_n(packet.hit.instID[0], Width, RTC_INVALID_GEOMETRY_ID);
  const std::array<float*, 6> rows = {packet.ray.org_x, packet.ray.org_y, packet.ray.org_z,
                                      packet.ray.dir_x, packet.ray.dir_y, packet.ray.dir_z};
  for (size_t begin = 0; begin < rays; begin += Width) {
    if (rays - begin < Width) {  // last packet: disable the lanes beyond the end
      std::fill(valid.begin() + static_cast<ptrdiff_t>(rays - begin), valid.end(), 0);
    }
    for (size_t k = 0; k < 6; ++k) std::copy_n(&buffer.ray[k][begin], Width, rows[k]);
    std::fill_n(packet.ray.tfar, Width, std::numeric_limits<float>::infinity());
    std::fill_n(packet.hit.geomID, Width, RTC_INVALID_GEOMETRY_ID);
    query.intersect(scene.embree, valid.data(), packet);
    std::copy_n(packet.hit.geomID, Width, &buffer.hits.instance[begin]);
    std::copy_n(packet.hit.primID, Width, &buffer.hits.triangle[begin]);
    std::copy_n(packet.hit.u, Width, &buffer.hits.barycentric[0][begin]);
    std::copy_n(packet.hit.v, Width, &buffer.hits.barycentric[1][begin]);
  }
}

// Converts records to columns; the columns are padded to a whole packet with copies of the last
// ray.
void load_rays(const RayList& rays, HitBuffer& buffer) {
  // Prefetch distance; reordered rays are read from anywhere in the batch.
  constexpr size_t ahead = 32;
  size_t i = 0;
  std::array<const float*, 8> rows;
  for (; i + 8 <= rays.size(); i += 8) {
    if (i + ahead + 8 <= rays.size()) {
      for (size_t k = 0; k < 8; ++k) __builtin_prefetch(rays[i + ahead + k].origin_m);
    }
    for (size_t k = 0; k < 8; ++k) rows[k] = rays[i + k].origin_m;
    transpose_8x8(rows, &buffer.ray[0][i], Hits::rows);
  }
  const size_t padded = (rays.size() + 15) / 16 * 16;
  for (; i < padded; ++i) {
    const Ray& ray = rays[std::min(i, rays.size() - 1)];
    for (size_t k = 0; k < 3; ++k) {
      buffer.ray[k][i] = ray.origin_m[k];
      buffer.ray[3 + k][i] = ray.direction[k];
    }
    buffer.ray[6][i] = std::bit_cast<float>(ray.sample);
  }
}

// Loads the planes of the hit triangles.
void load_planes(const TraceableScene::Data& scene, HitBuffer& buffer) {
  const Hits& hits = buffer.hits;
  for (int i = 0; i < hits.count; i += 4) {
    std::array<const double*, 4> rows;
    for (int k = 0; k < 4; ++k) {
      const int hit = std::min(i + k, hits.count - 1);
      // The normal and, behind it in memory, the offset.
      rows[static_cast<size_t>(k)] =
          scene.plane(hits.instance[hit], hits.triangle[hit]).normal.data();
    }
    transpose_4x4(rows, &buffer.plane[0][i], Hits::rows);
  }
}

// Whether all hits are on the same instance, which is common for neighbouring rays.
bool on_one_instance(const Hits& hits) {
  uint32_t differences = 0;
  for (int i = 0; i < hits.count; ++i) differences |= hits.instance[i] ^ hits.instance[0];
  return differences == 0;
}

bool on_one_side(const Hits& hits) {
  uint32_t differences = 0;
  for (int i = 0; i < hits.count; ++i) {
    differences |= static_cast<uint32_t>(hits.front[i] ^ hits.front[0]);
  }
  return differences == 0;
}

// Intersects the rays with the planes of their triangles in double precision: Embree's own distance
// has an error of up to 5e-7 of the scene's size. `plane(k, i)` gives component k of the normal of
// hit i for k < 3, and the offset for k = 3.
template <typename Plane>
void meet_planes(const Vec3& centre_m, const Plane& plane, HitBuffer& buffer) {
  Hits& hits = buffer.hits;
  const auto& ray = buffer.ray;
  const double cx = centre_m.x(), cy = centre_m.y(), cz = centre_m.z();
  for (int i = 0; i < hits.count; ++i) {
    const double ox = ray[0][i], oy = ray[1][i], oz = ray[2][i];
    const double dx = ray[3][i], dy = ray[4][i], dz = ray[5][i];
    const double nx = plane(0, i), ny = plane(1, i), nz = plane(2, i);
    const double facing = nx * dx + ny * dy + nz * dz;
    const double t = (plane(3, i) - nx * ox - ny * oy - nz * oz) / facing;
    hits.position_m[0][i] = cx + (ox + t * dx);
    hits.position_m[1][i] = cy + (oy + t * dy);
    hits.position_m[2][i] = cz + (oz + t * dz);
    hits.cosine[i] = std::min(std::abs(facing), 1.0);
    buffer.facing[i] = static_cast<float>(facing);
  }
}

}  // namespace

void find_hits(const TraceableScene::Data& scene, const RayList& rays, Coherence coherence,
               HitBuffer& buffer) {
  load_rays(rays, buffer);
  if (scene.packet_width == 16) {
    intersect_packets<16>(scene, rays.size(), coherence, buffer);
  } else {
    intersect_packets<8>(scene, rays.size(), coherence, buffer);
  }
  buffer.hits.count = static_cast<int>(rays.size());
}

int compact(HitBuffer& buffer, Hits::Column<int>& kept) {
  Hits& hits = buffer.hits;
  const int rays = hits.count;
  const auto missed =
      std::count(hits.instance.begin(), hits.instance.begin() + rays, RTC_INVALID_GEOMETRY_ID);
  if (missed == 0) return rays;
  int count = 0;
  for (int i = 0; i < rays; ++i) {
    kept[count] = i;
    count += hits.instance[i] != RTC_INVALID_GEOMETRY_ID ? 1 : 0;
  }
  hits.count = count;
  // Works in place because kept[j] ≥ j.
  const auto close = [&](auto& column) {
    for (int j = 0; j < count; ++j) column[j] = column[kept[j]];
  };
  close(hits.instance);
  close(hits.triangle);
  for (auto& column : hits.barycentric) close(column);
  for (auto& column : buffer.ray) close(column);
  return count;
}

void locate_hits(const TraceableScene::Data& scene, int depth, HitBuffer& buffer) {
  Hits& hits = buffer.hits;
  const auto& ray = buffer.ray;
  hits.depth = depth;
  const bool one_instance = hits.count > 0 && on_one_instance(hits);
  if (one_instance && scene.flat[hits.instance[0]] != 0) {
    const TrianglePlane& plane = scene.plane(hits.instance[0], 0);
    const std::array<double, 4> same = {plane.normal[0], plane.normal[1], plane.normal[2],
                                        plane.offset_m};
    meet_planes(
        scene.centre_m, [same](size_t k, int) { return same[k]; }, buffer);
  } else {
    load_planes(scene, buffer);
    const auto& planes = buffer.plane;
    meet_planes(
        scene.centre_m, [&planes](size_t k, int i) { return planes[k][i]; }, buffer);
  }
  for (int i = 0; i < hits.count; ++i) {
    hits.front[i] = static_cast<uint8_t>(std::bit_cast<uint32_t>(buffer.facing[i]) >> 31);
    buffer.sample[i] = std::bit_cast<uint32_t>(ray[6][i]);
  }
  buffer.one_side = one_instance && on_one_side(hits);
}

}  // namespace photorque
