#include "raytrace/tracing/shadow.h"

#include <algorithm>
#include <cmath>

#include "core/numerics/connected.h"
#include "core/numerics/divide_convex.h"
#include "raytrace/tracing/traceable_scene_data.h"

namespace photorque {
namespace {

// A convex polygon, large enough for a triangle clipped by two planes.
struct Polygon {
  std::array<Vec3, 5> corner;
  size_t count = 0;
};

// Part of a polygon with sign · z ≥ sign · at.
Polygon cut(const Polygon& polygon, double at, double sign) {
  Polygon kept;
  divide_convex(
      std::span(polygon.corner).first(polygon.count),
      [&](const Vec3& p) { return sign * (p.z() - at); },
      [&](const Vec3& p, double side) {
        if (side >= 0.0) kept.corner[kept.count++] = p;
      });
  return kept;
}

// Distance of the origin from a convex polygon in the xy plane, in either orientation; 0 inside.
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

Ball ball_about(std::span<const TriangleCorners> triangles) {
  Eigen::AlignedBox3d box;
  for (const TriangleCorners& corners : triangles) {
    for (const Vec3& corner : corners) box.extend(corner);
  }
  Ball ball{box.center(), 0.0};
  for (const TriangleCorners& corners : triangles) {
    for (const Vec3& corner : corners) {
      ball.radius_m = std::max(ball.radius_m, (corner - ball.centre_m).norm());
    }
  }
  return ball;
}

// Whether every edge belongs to two triangles that traverse it in opposite directions. Corners at
// the same position count as one.
bool is_closed(std::span<const TriangleCorners> triangles) {
  std::vector<Vec3> corners;
  for (const TriangleCorners& three : triangles) {
    corners.insert(corners.end(), three.begin(), three.end());
  }
  return edges_pair_up(welded(corners));
}

// Half-spaces whose intersection is the body with this surface, shrunk slightly against rounding.
// Empty if the surface is not closed and convex, or has more than 256 triangles.
std::vector<Occluder::Face> faces_of_convex(std::span<const TriangleCorners> triangles) {
  constexpr size_t most = 256;
  if (triangles.size() > most || !is_closed(triangles)) return {};
  const Ball ball = ball_about(triangles);
  const double rounding_m = 1e-6 * ball.radius_m;
  std::vector<Occluder::Face> faces;
  for (const TriangleCorners& corners : triangles) {
    const Vec3 area = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    if (!(area.norm() > rounding_m * rounding_m)) return {};
    Occluder::Face face{area.normalized(), 0.0};
    if (face.normal.dot(corners[0] - ball.centre_m) < 0.0) face.normal = -face.normal;
    face.offset_m = face.normal.dot(corners[0]) - rounding_m;
    for (const TriangleCorners& others : triangles) {
      for (const Vec3& corner : others) {
        if (face.normal.dot(corner) > face.offset_m + 2.0 * rounding_m) return {};
      }
    }
    const bool known = std::any_of(faces.begin(), faces.end(), [&](const Occluder::Face& other) {
      return other.normal.dot(face.normal) > 1.0 - 1e-12 &&
             std::abs(other.offset_m - face.offset_m) < 0.1 * rounding_m;
    });
    if (!known) faces.push_back(face);
  }
  return faces;
}

template <int Width>
void find_in_packets(const TraceableScene::Data& scene, std::span<const ShadowRay> rays,
                     std::span<uint8_t> lit) {
  constexpr auto width = static_cast<size_t>(Width);
  alignas(64) std::array<int, width> valid;
  typename embree_seam::PacketType<Width>::shadow packet;
  embree_seam::initialise<Width>(packet);
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
      packet.tfar[i] = ray.length_m;
    }
    embree_seam::Query::occluded(scene.embree, valid.data(), packet);
    for (size_t i = 0; i < count; ++i) lit[begin + i] = packet.tfar[i] >= 0.0f ? 1 : 0;
  }
}

}  // namespace

std::vector<Occluder> occluders_above(const Scene& scene, const Vec3& plane_point_m,
                                      const Vec3& plane_normal) {
  constexpr size_t together = 16;  // triangles per occluder for parts that are not convex
  // Triangles below this height count as in the plane (single precision).
  const Eigen::AlignedBox3d box = scene.box();
  const double min_m = box.isEmpty() ? 0.0 : 1e-6 * 0.5 * box.diagonal().norm();
  std::vector<Occluder> occluders;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    std::vector<TriangleCorners> all, above;
    for (const auto& triangle : mesh.triangles) {
      TriangleCorners& corners = all.emplace_back();
      bool reaches = false;
      for (size_t k = 0; k < 3; ++k) {
        corners[k] = instance.body_from_mesh * mesh.vertices_m[triangle[k]];
        reaches = reaches || plane_normal.dot(corners[k] - plane_point_m) > min_m;
      }
      if (reaches) above.push_back(corners);
    }
    if (above.empty()) continue;
    std::vector<Occluder::Face> faces = faces_of_convex(all);
    const size_t most = faces.empty() ? together : above.size();
    for (size_t first = 0; first < above.size(); first += most) {
      const auto some = std::span(above).subspan(first, std::min(most, above.size() - first));
      occluders.push_back({{some.begin(), some.end()}, ball_about(some), faces});
    }
  }
  return occluders;
}

Shaft::Shaft(const Ball& from, const Ball& to) : start_m_(from.centre_m), end_(to) {
  const Vec3 between = to.centre_m - from.centre_m;
  const double length = between.norm();
  axis_ = length > 0.0 ? Vec3(between / length) : Vec3::UnitZ();
  across_ = axis_.unitOrthogonal();
  aside_ = axis_.cross(across_);
  low_m_ = -from.radius_m;
  high_m_ = length + to.radius_m;
  first_m_ = from.radius_m;
  last_m_ = length - to.radius_m;
  // Cone around both balls. If one ball contains the other, a cylinder with the larger radius.
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

bool Shaft::may_meet(const Ball& ball) const {
  const Vec3 from_start = ball.centre_m - start_m_;
  const double along = axis_.dot(from_start), r = ball.radius_m;
  if (along + r < low_m_ || along - r > high_m_) return false;
  const double widest = radius_m_ + std::max(widening_ * std::max(along - r, low_m_),
                                             widening_ * std::min(along + r, high_m_));
  const double reach = widest + r;
  return (from_start - along * axis_).squaredNorm() <= reach * reach;
}

bool Shaft::may_meet(const Occluder& occluder) const {
  return may_meet(occluder.ball) &&
         std::any_of(occluder.triangles.begin(), occluder.triangles.end(),
                     [&](const TriangleCorners& triangle) { return may_meet(triangle); });
}

// A disc at a position along the axis is inside a half-space if a linear inequality of the position
// holds.
bool Shaft::is_blocked_by(const Occluder& occluder) const {
  if (occluder.faces.empty()) return false;
  double low = first_m_, high = last_m_;
  bool outside = false;
  for (const Occluder::Face& face : occluder.faces) {
    const double beyond_m = face.normal.dot(end_.centre_m) - end_.radius_m - face.offset_m;
    outside = outside || beyond_m > 1e-3 * occluder.ball.radius_m;
    const double cosine = face.normal.dot(axis_);
    const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
    const double gap = face.offset_m - face.normal.dot(start_m_) - radius_m_ * sine;
    const double growth = cosine + widening_ * sine;  // gap ≥ growth · place
    if (growth > 0.0) {
      high = std::min(high, gap / growth);
    } else if (growth < 0.0) {
      low = std::max(low, gap / growth);
    } else if (gap < 0.0) {
      return false;
    }
  }
  return outside && low <= high;
}

ShadowRay shadow_ray(const Vec3& origin_m, const Vec3& direction, double length_m) {
  ShadowRay ray{};
  Eigen::Map<Eigen::Vector3f>(ray.origin_m) = origin_m.cast<float>();
  Eigen::Map<Eigen::Vector3f>(ray.direction) = direction.cast<float>();
  ray.length_m = static_cast<float>(length_m);
  return ray;
}

void find_shadows(const TraceableScene& scene, std::span<const ShadowRay> rays,
                  std::span<uint8_t> lit) {
  if (scene.data().packet_width == 16) {
    find_in_packets<16>(scene.data(), rays, lit);
  } else {
    find_in_packets<8>(scene.data(), rays, lit);
  }
}

std::vector<uint8_t> unshadowed(const TraceableScene& scene, std::span<const ShadowRay> rays) {
  std::vector<uint8_t> clear(rays.size());
  for (size_t begin = 0; begin < rays.size(); begin += shadow_batch) {
    const size_t count = std::min<size_t>(rays.size() - begin, shadow_batch);
    find_shadows(scene, rays.subspan(begin, count), std::span(clear).subspan(begin, count));
  }
  return clear;
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
