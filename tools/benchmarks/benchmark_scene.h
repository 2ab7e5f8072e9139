// Functions that build the benchmarks' scenes.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/errors.h"
#include "raytrace/scene.h"
#include "sources/lamps/kind.h"

namespace photorque {

// Adds a mesh and one instance of it, named `node`, at the origin.
inline void add_part(Scene& scene, Mesh mesh, const std::string& node) {
  Instance instance;
  instance.node = instance.path = node;
  instance.mesh = static_cast<uint32_t>(scene.meshes.size());
  scene.meshes.push_back(std::move(mesh));
  scene.instances.push_back(instance);
}

// A square sheet of `cells`² squares about the z axis, facing up. Its height depends on x and y as
// fractions of the side, from -0.5 to 0.5.
template <class Height>
Mesh sheet(double side_m, int cells, const Height& height_m) {
  Mesh mesh;
  for (int j = 0; j <= cells; ++j) {
    for (int i = 0; i <= cells; ++i) {
      const double x = i / static_cast<double>(cells) - 0.5,
                   y = j / static_cast<double>(cells) - 0.5;
      mesh.vertices_m.emplace_back(side_m * x, side_m * y, height_m(x, y));
    }
  }
  const auto row = static_cast<uint32_t>(cells) + 1;
  for (uint32_t j = 0; j + 1 < row; ++j) {
    for (uint32_t i = 0; i + 1 < row; ++i) {
      const uint32_t at = j * row + i, up = at + row;
      mesh.triangles.push_back({at, at + 1, up + 1});
      mesh.triangles.push_back({at, up + 1, up});
    }
  }
  return mesh;
}

inline std::vector<Beam> make_beams(const std::string& kind, SettingsNode::Table keys,
                                    const SourceContext& context = {}) {
  for (const SourceKind& known : all_source_kinds()) {
    if (known.name == kind) return known.make(Settings(SettingsNode{std::move(keys)}), context);
  }
  throw InputError({}, "kind", kind, "a kind of source");
}

inline SettingsNode vector_node(const Vec3& v) {
  return {SettingsNode::Array{{v.x()}, {v.y()}, {v.z()}}};
}

// Adds an LED of 1 W and 3 deg that faces the plane z = 0, obliquely towards the z axis.
inline void add_led(std::vector<Beam>& beams, const Vec3& at_m, double aperture_diameter_m) {
  for (Beam& beam :
       make_beams("led", {{"power_W", {1.0}},
                          {"aperture_diameter_m", {aperture_diameter_m}},
                          {"profile", {"gaussian"}},
                          {"fwhm_deg", {3.0}},
                          {"wavelength_nm", {730.0}},
                          {"position_m", vector_node(at_m)},
                          {"aim_m", vector_node(Vec3(0.5 * at_m.x(), 0.5 * at_m.y(), 0))}})) {
    beams.push_back(std::move(beam));
  }
}

}  // namespace photorque
