#include "raytrace/tracing/shadow.h"

#include <algorithm>
#include <cmath>

#include "raytrace/tracing/traceable_scene_data.h"

namespace photorque {
namespace {

// A convex polygon that a triangle cut by two planes can be.
struct Polygon {
  std::array<Vec3, 5> corner;
  size_t count = 0;
};

// The part of a polygon with sign · z ≥ sign · at.
Polygon cut(const Polygon& polygon, double at, double sign) {
  Polygon kept;
  for (size_t i = 0; i < polygon.count; ++i) {
    const Vec3& a = polygon.corner[i];
    const Vec3& b = polygon.corner[i + 1 == polygon.count ? 0 : i + 1];
    const double from = sign * (a.z() - at), to = sign * (b.z() - at);
    if (from >= 0.0) kept.corner[kept.count++] = a;
    if ((from < 0.0) != (to < 0.0) && from != 0.0 && to != 0.0) {
      kept.corner[kept.count++] = a + from / (from - to) * (b - a);
    }
  }
  return kept;
}

// Distance of the origin from a convex polygon in the xy plane, either orientation; 0 inside.
double distance_from_origin(const Polygon& polygon) {
  bool left = false, right = false;
  double nearest2 = INFINITY;
  for (size_t i = 0; i < polygon.count; ++i) {
    const Vec2 a = polygon.corner[i].head<2>();
    const Vec2 edge = polygon.corner[i + 1 == polygon.count ? 0 : i + 1].head<2>() - a;
    const double side = edge.x() * a.y() - edge.y() * a.x();
    left = left || side > 0.0;
    right = right || side < 0.0;
    const double length2 = edge.squaredNorm();
    const double along = length2 > 0.0 ? std::clamp(-a.dot(edge) / length2, 0.0, 1.0) : 0.0;
    nearest2 = std::min(nearest2, (a + along * edge).squaredNorm());
  }
  return left && right ? std::sqrt(nearest2) : 0.0;
}

template <int Width>
void find_in_packets(const TraceableScene::Data& scene, std::span<const ShadowRay> rays,
                     std::span<uint8_t> lit) {
  constexpr auto width = static_cast<size_t>(Width);
  alignas(64) std::array<int, width> valid;
  typename embree_seam::PacketType<Width>::shadow packet;
  for (size_t begin = 0; begin < rays.size(); begin += width) {
    const size_t count = std::min(width, rays.size() - begin);
    for (size_t i = 0; i < width; ++i) {
      const ShadowRay& ray = rays[begin + std::min(i, count - 1)];
      valid[i] = i < count ? -1 : 0;
      packet.org_x[i] = ray.origin_m[0];
      packet.org_y[i] = ray.origin_m[1];
      packet.org_z[i] = ray.origin_m[2];
      packet.dir_x[i] = ray.direction[0];
      packet.dir_y[i] = ray.direction[1];
      packet.dir_z[i] = ray.direction[2];
      packet.tnear[i] = 0.0f;
      packet.tfar[i] = ray.length_m;
      packet.time[i] = 0.0f;
      packet.mask[i] = 0xffffffffu;
      packet.id[i] = 0;
      packet.flags[i] = 0;
    }
    embree_seam::Query::occluded(scene.embree, valid.data(), packet);
    for (size_t i = 0; i < count; ++i) lit[begin + i] = packet.tfar[i] >= 0.0f ? 1 : 0;
  }
}

}  // namespace

std::vector<TriangleCorners> triangles_above(const Scene& scene, const Vec3& plane_point_m,
                                             const Vec3& plane_normal) {
  // A triangle below this height is in the plane, to single precision.
  const Eigen::AlignedBox3d box = scene.box();
  const double min_m = box.isEmpty() ? 0.0 : 1e-6 * 0.5 * box.diagonal().norm();
  std::vector<TriangleCorners> above;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    for (const auto& triangle : mesh.triangles) {
      TriangleCorners corners;
      bool reaches = false;
      for (size_t k = 0; k < 3; ++k) {
        corners[k] = instance.body_from_mesh * mesh.vertices_m[triangle[k]];
        reaches = reaches || plane_normal.dot(corners[k] - plane_point_m) > min_m;
      }
      if (reaches) above.push_back(corners);
    }
  }
  return above;
}

Shaft::Shaft(const Ball& from, const Ball& to) : start_m_(from.centre_m) {
  const Vec3 between = to.centre_m - from.centre_m;
  const double length = between.norm();
  axis_ = length > 0.0 ? Vec3(between / length) : Vec3::UnitZ();
  across_ = axis_.unitOrthogonal();
  aside_ = axis_.cross(across_);
  low_m_ = -from.radius_m;
  high_m_ = length + to.radius_m;
  // The cone about both balls; where one holds the other, the larger ball's cylinder.
  const double slope = length > 0.0 ? (to.radius_m - from.radius_m) / length : 1.0;
  if (std::abs(slope) < 0.7) {
    const double slant = 1.0 / std::sqrt(1.0 - slope * slope);
    radius_m_ = from.radius_m * slant;
    widening_ = slope * slant;
  } else {
    radius_m_ = std::max(from.radius_m, to.radius_m);
    widening_ = 0.0;
  }
}

bool Shaft::may_meet(const TriangleCorners& triangle) const {
  Polygon polygon;
  double lowest = INFINITY, highest = -INFINITY;
  for (const Vec3& corner : triangle) {
    const Vec3 from_start = corner - start_m_;
    polygon.corner[polygon.count] = {across_.dot(from_start), aside_.dot(from_start),
                                     axis_.dot(from_start)};
    lowest = std::min(lowest, polygon.corner[polygon.count].z());
    highest = std::max(highest, polygon.corner[polygon.count].z());
    ++polygon.count;
  }
  if (highest < low_m_ || lowest > high_m_) return false;
  if (lowest < low_m_) polygon = cut(polygon, low_m_, 1.0);
  if (highest > high_m_) polygon = cut(polygon, high_m_, -1.0);
  double widest = 0.0;
  for (size_t i = 0; i < polygon.count; ++i) {
    widest = std::max(widest, radius_m_ + widening_ * polygon.corner[i].z());
  }
  return polygon.count > 0 && distance_from_origin(polygon) <= widest;
}

void find_shadows(const TraceableScene& scene, std::span<const ShadowRay> rays,
                  std::span<uint8_t> lit) {
  if (scene.data().packet_width == 16) {
    find_in_packets<16>(scene.data(), rays, lit);
  } else {
    find_in_packets<8>(scene.data(), rays, lit);
  }
}

double shadow_ray_offset_m(const TraceableScene& scene) {
  return scene.data().ray_offset_m;
}

double scene_diameter_m(const TraceableScene& scene) {
  return 2.0 * scene.data().radius_m;
}

const Vec3& scene_centre_m(const TraceableScene& scene) {
  return scene.data().centre_m;
}

}  // namespace photorque
