// Platforms and spacecraft from a parameter file: simple solids with materials and masses become a
// glTF scene and the mass properties of the whole.
//
// The parameter file (TOML, body frame, see core/settings/settings.h for units) holds
//   title, topology    texts; topology is one of dumbbell, tabletop, hollow, free
//   segments           corners of a full circle, 12 to 512 (48)
//   [[material]]       name, base_colour [3], metallic, roughness, density_kg_m3 (optional),
//                      optics (a table, written to the material's extras.photorque)
//   [[part]]           node     path of names from the root: "platform/top_plate/solar_array"
//                      shape    and its lengths, see below
//                      material a name
//                      mass_kg  of each copy; without it, the material's density counts; a sheet
//                               has none
//                      position_m [0, 0, 0] of the shape's origin, axis [0, 0, 1] along which its z
//                      points, and copies_deg: angles about body z at which to repeat the part,
//                      nodes then end in _1, _2, ...
// Shapes (z is their axis, the origin their centre unless stated otherwise):
//   box       size_m [3], hole_radius_m (optional, along z)
//   sheet     size_m [2]: a rectangle facing +z with texture coordinates, for layers of cells
//   cylinder  radius_m, height_m, top_radius_m (radius_m), inner_radius_m (0)
//   ball      radius_m, low_m (−radius), high_m (radius): planes that cut it; origin its centre
//   shell     radius_m (outside), thickness_m, high_m: the plane that opens it; origin its centre
//   dish      radius_m (of the rim), focal_length_m, thickness_m; origin the vertex, opens to +z
#pragma once

#include <string>
#include <vector>

#include "core/settings/settings.h"
#include "scenes/gltf/writer.h"
#include "scenes/platforms/generator_solids.h"

namespace photorque {

struct PlatformPart {
  std::string node;  // full path
  size_t mesh = 0;
  size_t material = 0;
  RigidTransform body_from_part;
  double mass_kg = 0.0;
};

struct PlatformModel {
  std::string title;
  std::string topology;
  std::vector<Mesh> meshes;
  std::vector<GltfWriterMaterial> materials;
  std::vector<PlatformPart> parts;
  MassProperties mass;  // of all parts, body frame, inertia about its origin
};

// Builds the platform. Throws InputError for parameters that make no solid, two parts of one node,
// a parent after its child, an unknown material or shape, a part without mass, and every key that
// is not read.
PlatformModel generate_platform(const Settings& parameters);

// The platform as a scene: one glTF node for every name in the parts' paths, a child placed
// relative to its parent. The asset's extras give the mass properties, a node's extras its mass.
GltfWriterModel to_gltf(const PlatformModel& platform);

// The [platform] table of an experiment, with the centre of mass as a comment.
std::string platform_table_toml(const PlatformModel& platform);

}  // namespace photorque
