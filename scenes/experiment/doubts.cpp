#include "scenes/experiment/doubts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>

#include "core/constants.h"

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

namespace {

constexpr size_t max_named = 3;

std::string coincidence_line(const Scene& scene) {
  const std::vector<CoincidentFaces> all = coincident_faces(scene);
  if (all.empty()) return "";
  std::ostringstream line;
  line << "faces lie in each other, and rounding decides which of them meets the light: ";
  for (size_t i = 0; i < std::min(all.size(), max_named); ++i) {
    line << (i > 0 ? "; " : "") << scene.instances[all[i].first].path << " and "
         << scene.instances[all[i].second].path << " (" << all[i].triangles
         << " pairs of triangles)";
  }
  if (all.size() > max_named) line << "; and " << all.size() - max_named << " more pairs of parts";
  return line.str();
}

Eigen::AlignedBox3d box_of(const Scene& scene, const Instance& instance) {
  Eigen::AlignedBox3d box;
  for (const Vec3& vertex : scene.meshes[instance.mesh].vertices_m) {
    box.extend(instance.body_from_mesh * vertex);
  }
  return box;
}

// How often a closed surface goes round a point: 1 inside, 0 outside, 1/2 on a face of it. The sum
// of the solid angles of its triangles over 4π.
// Source: A. van Oosterom, J. Strackee, IEEE Trans. Biomed. Eng. 30 (1983) 125, eq. 8.
double winding(const Scene& scene, const Instance& instance, const Vec3& point_m) {
  const Mesh& mesh = scene.meshes[instance.mesh];
  double half_angles = 0.0;
  for (const auto& triangle : mesh.triangles) {
    std::array<Vec3, 3> to;
    std::array<double, 3> length{};
    for (size_t k = 0; k < 3; ++k) {
      to[k] = instance.body_from_mesh * mesh.vertices_m[triangle[k]] - point_m;
      length[k] = to[k].norm();
    }
    half_angles += std::atan2(to[0].dot(to[1].cross(to[2])),
                              length[0] * length[1] * length[2] + to[0].dot(to[1]) * length[2] +
                                  to[0].dot(to[2]) * length[1] + to[1].dot(to[2]) * length[0]);
  }
  return std::abs(half_angles) / (2.0 * pi);
}

bool is_opaque(const Scene& scene, const Instance& instance) {
  const auto lets_through = [](const OpticalSurface& surface) {
    return std::ranges::any_of(surface.transmitted, [](double part) { return part > 0.0; });
  };
  return !lets_through(scene.surfaces[instance.front_surface]) &&
         !lets_through(scene.surfaces[instance.back_surface]);
}

void add_lamps_inside(const Scene& scene, std::span<const Beam> beams,
                      const RigidTransform& lab_from_body, std::vector<std::string>& lines) {
  constexpr double inside = 0.75;
  size_t triangles_left = 100'000'000, named = 0;
  const RigidTransform body_from_lab = lab_from_body.inverse();
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    if (!mesh.encloses || !is_opaque(scene, instance)) continue;
    const Eigen::AlignedBox3d box = box_of(scene, instance);
    for (const Beam& beam : beams) {
      const Vec3 at_m = body_from_lab.point(beam.lab_from_emitter.translation_m);
      if (!box.contains(at_m) || mesh.triangles.size() > triangles_left) continue;
      triangles_left -= mesh.triangles.size();
      if (winding(scene, instance, at_m) < inside || named++ >= max_named) continue;
      lines.push_back("the lamp " + beam.name + " stands inside the closed part " + instance.path +
                      ", and its light stays there");
    }
  }
}

void add_unresolved_parts(const Scene& scene, std::vector<std::string>& lines) {
  // Rays start so far above the surface that they leave (TraceableScene), as a part of the scene.
  constexpr double offset_of_size = 5e-7, offsets = 20.0;
  Eigen::AlignedBox3d all;
  std::vector<double> size_m;
  for (const Instance& instance : scene.instances) {
    const Eigen::AlignedBox3d box = box_of(scene, instance);
    size_m.push_back(box.diagonal().norm());
    all.extend(box);
  }
  const double least_m =
      offsets * offset_of_size * (all.center().cwiseAbs().maxCoeff() + 0.5 * all.diagonal().norm());
  size_t count = 0, smallest = 0;
  for (size_t i = 0; i < size_m.size(); ++i) {
    if (size_m[i] >= least_m) continue;
    if (count++ == 0 || size_m[i] < size_m[smallest]) smallest = i;
  }
  if (count == 0) return;
  std::ostringstream line;
  line.precision(2);
  line << count << " part(s) are smaller than " << least_m
       << " m, which is what single precision resolves in a scene of this size; the smallest is "
       << scene.instances[smallest].path << ", " << size_m[smallest] << " m";
  lines.push_back(line.str());
}

}  // namespace

std::vector<std::string> doubts_about(const Scene& scene, std::span<const Beam> beams,
                                      const RigidTransform& lab_from_body) {
  std::vector<std::string> lines;
  if (std::string line = coincidence_line(scene); !line.empty()) lines.push_back(std::move(line));
  add_lamps_inside(scene, beams, lab_from_body, lines);
  add_unresolved_parts(scene, lines);
  return lines;
}

}  // namespace photorque
