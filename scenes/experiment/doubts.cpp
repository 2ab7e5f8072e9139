#include <array>
#include <cmath>
#include <set>

#include "core/constants.h"
#include "core/text/format.h"
#include "scenes/experiment/experiment.h"

namespace photorque {
namespace {

constexpr double inside = 0.75;  // winding number, with a margin for rounding

// Winding number of a closed surface about a point: 1 inside, 0 outside, 1/2 on a face. It is the
// sum of the solid angles of its triangles divided by 4π.
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

// Calls `found` with each closed opaque part and each lamp inside of it.
template <class Found>
void find_lamps_inside(const Scene& scene, std::span<const Beam> beams,
                       const RigidTransform& lab_from_body, const Found& found) {
  size_t triangles_left = 100'000'000;
  const RigidTransform body_from_lab = lab_from_body.inverse();
  for (uint32_t part = 0; part < scene.instances.size(); ++part) {
    const Instance& instance = scene.instances[part];
    const Mesh& mesh = scene.meshes[instance.mesh];
    if (!mesh.encloses || scene.transmits(instance)) continue;
    const Eigen::AlignedBox3d box = scene.box_of(instance);
    for (const Beam& beam : beams) {
      const Vec3 at_m = body_from_lab.point(beam.lab_from_emitter.translation_m);
      if (!box.contains(at_m) || mesh.triangles.size() > triangles_left) continue;
      triangles_left -= mesh.triangles.size();
      if (winding(scene, instance, at_m) >= inside) found(part, beam);
    }
  }
}

// Whether a part encloses all others, of which there are some. A point of each is tested, a little
// in front of its first triangle and behind it, since a sheet may lie on a face of the part.
bool is_chamber(const Scene& scene, uint32_t part) {
  constexpr double little = 1e-4;  // of the triangle's size
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& other = scene.instances[i];
    const Mesh& mesh = scene.meshes[other.mesh];
    if (i == part || mesh.triangles.empty()) continue;
    std::array<Vec3, 3> p;
    for (size_t k = 0; k < 3; ++k) {
      p[k] = other.body_from_mesh * mesh.vertices_m[mesh.triangles.front()[k]];
    }
    const Vec3 centre_m = (p[0] + p[1] + p[2]) / 3.0;
    const Vec3 normal = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
    for (const double side : {-1.0, 1.0}) {
      const Vec3 at_m = centre_m + side * little * (p[1] - p[0]).norm() * normal;
      if (winding(scene, scene.instances[part], at_m) < inside) return false;
    }
  }
  return scene.instances.size() > 1;
}

}  // namespace

void open_chambers(Scene& scene, std::span<const Beam> beams, const RigidTransform& lab_from_body) {
  std::set<uint32_t> chambers;
  find_lamps_inside(scene, beams, lab_from_body, [&](uint32_t part, const Beam&) {
    if (is_chamber(scene, part)) chambers.insert(scene.instances[part].mesh);
  });
  for (const uint32_t mesh : chambers) scene.meshes[mesh].encloses = false;
}

std::vector<std::string> geometry_warnings(const Scene& scene, std::span<const Beam> beams,
                                           const RigidTransform& lab_from_body) {
  std::vector<std::string> lines;
  constexpr size_t max_named = 3;
  size_t named = 0;
  find_lamps_inside(scene, beams, lab_from_body, [&](uint32_t part, const Beam& beam) {
    if (named++ >= max_named) return;
    lines.push_back("the lamp " + beam.name + " stands inside the closed part " +
                    scene.instances[part].path + ", and its light stays there");
  });
  // A ray starts at this offset above its surface, as a fraction of the scene's size (see
  // TraceableScene).
  constexpr double offset_of_size = 5e-7, offsets = 20.0;
  Eigen::AlignedBox3d all;
  std::vector<double> size_m;
  for (const Instance& instance : scene.instances) {
    const Eigen::AlignedBox3d box = scene.box_of(instance);
    size_m.push_back(box.diagonal().norm());
    all.extend(box);
  }
  const double least_m = offsets * offset_of_size * 0.5 * all.diagonal().norm();
  size_t count = 0, smallest = 0;
  for (size_t i = 0; i < size_m.size(); ++i) {
    if (size_m[i] >= least_m) continue;
    if (count++ == 0 || size_m[i] < size_m[smallest]) smallest = i;
  }
  if (count == 0) return lines;
  lines.push_back(
      printed("%zu part(s) are smaller than %.2g m, which is what single precision resolves in a "
              "scene of this size; the smallest is %s, %.2g m",
              count, least_m, scene.instances[smallest].path.c_str(), size_m[smallest]));
  return lines;
}

}  // namespace photorque
