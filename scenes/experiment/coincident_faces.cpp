#include "scenes/experiment/coincident_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace photorque {
namespace {

using PlaneKey = std::array<int64_t, 4>;
using Corners = std::array<Vec2, 3>;

struct Face {
  PlaneKey plane;
  uint32_t instance, triangle;
};

std::array<Vec3, 3> corners_of(const Scene& scene, uint32_t instance, uint32_t triangle) {
  const Instance& of = scene.instances[instance];
  const Mesh& mesh = scene.meshes[of.mesh];
  std::array<Vec3, 3> corners;
  for (size_t k = 0; k < 3; ++k) {
    corners[k] = of.body_from_mesh * mesh.vertices_m[mesh.triangles[triangle][k]];
  }
  if (of.body_from_mesh.linear().determinant() < 0.0) std::swap(corners[1], corners[2]);
  return corners;
}

Vec3 normal_of(const std::array<Vec3, 3>& corners) {
  return (corners[1] - corners[0]).cross(corners[2] - corners[0]).stableNormalized();
}

// By plane, then by instance.
std::vector<Face> sorted_faces(const Scene& scene) {
  constexpr double direction_step = 1e-5, step_of_size = 2e-7;
  const double step_m = step_of_size * std::max(scene.radius_m(), 1e-30);
  std::vector<Face> faces;
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const auto triangles =
        static_cast<uint32_t>(scene.meshes[scene.instances[i].mesh].triangles.size());
    for (uint32_t t = 0; t < triangles; ++t) {
      const auto corners = corners_of(scene, i, t);
      const Vec3 normal = normal_of(corners);
      Face face{{}, i, t};
      for (int k = 0; k < 3; ++k) {
        face.plane[static_cast<size_t>(k)] = std::llround(normal[k] / direction_step);
      }
      face.plane[3] = std::llround(normal.dot(corners[0]) / step_m);
      faces.push_back(face);
    }
  }
  std::ranges::sort(faces, [](const Face& a, const Face& b) {
    return std::tie(a.plane, a.instance, a.triangle) < std::tie(b.plane, b.instance, b.triangle);
  });
  return faces;
}

// Along two axes of the plane.
Corners flat(const Scene& scene, const Face& face, const Vec3& u, const Vec3& v) {
  Corners corners;
  const auto solid = corners_of(scene, face.instance, face.triangle);
  for (size_t k = 0; k < 3; ++k) corners[k] = {u.dot(solid[k]), v.dot(solid[k])};
  return corners;
}

// Whether a line along one of the first triangle's sides has each on a side of its own.
bool side_parts(const Corners& a, const Corners& b) {
  constexpr double touch = 1e-6;  // of the side's length
  for (size_t k = 0; k < 3; ++k) {
    const Vec2 side = a[(k + 1) % 3] - a[k];
    const Vec2 across(-side.y(), side.x());
    double least_a = 0.0, most_a = 0.0, least_b = 0.0, most_b = 0.0;
    for (size_t c = 0; c < 3; ++c) {
      const double at_a = across.dot(a[c] - a[k]), at_b = across.dot(b[c] - a[k]);
      least_a = c == 0 ? at_a : std::min(least_a, at_a);
      most_a = c == 0 ? at_a : std::max(most_a, at_a);
      least_b = c == 0 ? at_b : std::min(least_b, at_b);
      most_b = c == 0 ? at_b : std::max(most_b, at_b);
    }
    const double slack = touch * side.squaredNorm();
    if (most_a - slack <= least_b || most_b - slack <= least_a) return true;
  }
  return false;
}

}  // namespace

std::vector<CoincidentFaces> coincident_faces(const Scene& scene) {
  size_t pairs_left = 10'000'000;
  const std::vector<Face> faces = sorted_faces(scene);
  std::map<std::pair<uint32_t, uint32_t>, size_t> found;
  for (size_t begin = 0, end = 0; begin < faces.size(); begin = end) {
    while (end < faces.size() && faces[end].plane == faces[begin].plane) ++end;
    if (faces[begin].instance == faces[end - 1].instance) continue;
    const Vec3 normal = normal_of(corners_of(scene, faces[begin].instance, faces[begin].triangle));
    const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
    std::vector<Corners> corners;
    for (size_t i = begin; i < end; ++i) corners.push_back(flat(scene, faces[i], u, v));
    for (size_t i = begin; i < end; ++i) {
      for (size_t j = i + 1; j < end && pairs_left > 0; ++j) {
        if (faces[i].instance == faces[j].instance) continue;
        --pairs_left;
        const Corners &a = corners[i - begin], &b = corners[j - begin];
        if (side_parts(a, b) || side_parts(b, a)) continue;
        ++found[{faces[i].instance, faces[j].instance}];
      }
    }
  }
  std::vector<CoincidentFaces> all;
  for (const auto& [pair, count] : found) all.push_back({pair.first, pair.second, count});
  std::ranges::stable_sort(all, [](const CoincidentFaces& a, const CoincidentFaces& b) {
    return a.triangles > b.triangles;
  });
  return all;
}

}  // namespace photorque
