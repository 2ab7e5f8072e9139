#include "scenes/platforms/generator.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"

namespace photorque {
namespace {

// ---- Shapes: each function reads the lengths of one shape and checks that they form a solid.

Mesh box_from(const Settings& part, int segments) {
  const Vec3 size_m = part.vector3("size_m");
  if ((size_m.array() <= 0.0).any()) throw part.error("size_m", "a length <= 0", "lengths > 0");
  if (!part.has("hole_radius_m")) return box_solid(size_m);
  const double widest_m = 0.49 * std::min(size_m.x(), size_m.y());
  return box_with_hole_solid(size_m, part.number("hole_radius_m", {0.0, widest_m, true, false}),
                             segments);
}

Mesh sheet_from(const Settings& part, int /*segments*/) {
  const std::vector<double> size_m = part.numbers("size_m", Range::positive());
  if (size_m.size() != 2)
    throw part.error("size_m", std::to_string(size_m.size()) + " lengths", "2");
  return sheet({size_m[0], size_m[1]});
}

Mesh cylinder_from(const Settings& part, int segments) {
  const double bottom_m = part.number("radius_m", Range::positive());
  const double top_m = part.number_or("top_radius_m", bottom_m, Range::positive());
  const double height_m = part.number("height_m", Range::positive());
  const double inner_m =
      part.number_or("inner_radius_m", 0.0, {0.0, std::min(bottom_m, top_m), false, true});
  return cylinder_solid(bottom_m, top_m, height_m, inner_m, segments);
}

Mesh ball_from(const Settings& part, int segments) {
  const double radius_m = part.number("radius_m", Range::positive());
  const double low_m = part.number_or("low_m", -radius_m, {-radius_m, radius_m, false, true});
  const double high_m = part.number_or("high_m", radius_m, {low_m, radius_m, true, false});
  return ball_solid(radius_m, low_m, high_m, segments);
}

Mesh shell_from(const Settings& part, int segments) {
  const double radius_m = part.number("radius_m", Range::positive());
  const double thickness_m = part.number("thickness_m", {0.0, radius_m, true, true});
  const double inner_m = radius_m - thickness_m;
  const double high_m = part.number("high_m", {-inner_m, inner_m, true, true});
  return shell_solid(radius_m, thickness_m, high_m, segments);
}

Mesh dish_from(const Settings& part, int segments) {
  const double radius_m = part.number("radius_m", Range::positive());
  const double focal_length_m = part.number("focal_length_m", Range::positive());
  const double thickness_m = part.number("thickness_m", Range::positive());
  return dish_solid(radius_m, focal_length_m, thickness_m, segments);
}

Mesh solid_from(const Settings& part, int segments) {
  struct Shape {
    const char* name;
    Mesh (*make)(const Settings&, int);
  };
  static constexpr Shape shapes[] = {{"box", box_from},           {"sheet", sheet_from},
                                     {"cylinder", cylinder_from}, {"ball", ball_from},
                                     {"shell", shell_from},       {"dish", dish_from}};
  std::vector<std::string> names;
  for (const Shape& shape : shapes) names.emplace_back(shape.name);
  return shapes[part.choice("shape", names)].make(part, segments);
}

// ---- Materials

struct Material {
  GltfWriterMaterial look;
  double density_kg_m3 = 0.0;  // 0: no density is given
};

Material material_from(const Settings& table) {
  Material material;
  material.look.name = table.text("name");
  material.look.base_colour = table.vector3("base_colour");
  if ((material.look.base_colour.array() < 0.0).any() ||
      (material.look.base_colour.array() > 1.0).any()) {
    throw table.error("base_colour", "a component outside [0, 1]", "3 numbers in [0, 1]");
  }
  material.look.metallic = table.number_or("metallic", 0.0, Range::fraction());
  material.look.roughness = table.number_or("roughness", 0.5, Range::fraction());
  material.density_kg_m3 = table.number_or("density_kg_m3", 0.0, Range::positive());
  if (table.has("optics")) material.look.optics = table.raw("optics");
  return material;
}

// ---- Parts

RigidTransform turned_about_z(double angle_rad, const RigidTransform& placed) {
  const RigidTransform turn{Quat(Eigen::AngleAxisd(angle_rad, Vec3::UnitZ())), Vec3::Zero()};
  return turn * placed;
}

std::vector<RigidTransform> placements_of(const Settings& part) {
  const Vec3 position_m = part.vector3_or("position_m", Vec3::Zero());
  const Vec3 axis = part.vector3_or("axis", Vec3::UnitZ());
  if (axis.norm() < 1e-9) throw part.error("axis", "a zero vector", "a vector of non-zero length");
  const RigidTransform placed = axis.isApprox(Vec3::UnitZ())
                                    ? RigidTransform{Quat::Identity(), position_m}
                                    : frame_looking_along(axis, position_m);
  if (!part.has("copies_deg")) return {placed};
  std::vector<RigidTransform> all;
  for (const double angle_rad : part.numbers("copies_deg")) {
    all.push_back(turned_about_z(angle_rad, placed));
  }
  return all;
}

double mass_from(const Settings& part, const Material& material, double volume_m3) {
  if (volume_m3 == 0.0) return 0.0;
  if (part.has("mass_kg")) return part.number("mass_kg", Range::positive());
  if (material.density_kg_m3 > 0.0) return material.density_kg_m3 * volume_m3;
  throw part.error("mass_kg", "nothing", "mass_kg, or density_kg_m3 of its material");
}

void add_part(const Settings& table, const std::vector<Material>& materials, int segments,
              PlatformModel& platform) {
  std::vector<std::string> names;
  for (const Material& material : materials) names.push_back(material.look.name);
  const size_t material = table.choice("material", names);
  const std::string node = table.text("node");
  Mesh mesh = solid_from(table, segments);
  const SolidMoments moments = moments_of(mesh);
  const double mass_kg = mass_from(table, materials[material], moments.volume_m3);

  const std::vector<RigidTransform> placements = placements_of(table);
  for (size_t i = 0; i < placements.size(); ++i) {
    const std::string suffix = table.has("copies_deg") ? "_" + std::to_string(i + 1) : "";
    for (const PlatformPart& other : platform.parts) {
      if (other.node == node + suffix)
        throw table.error("node", "a second " + other.node, "a name that no other part has");
      if (other.node.starts_with(node + suffix + "/")) {
        throw table.error("node", "a part after its child " + other.node, "parents first");
      }
    }
    platform.parts.push_back(
        {node + suffix, platform.meshes.size(), material, placements[i], mass_kg});
    if (mass_kg > 0.0) {
      platform.mass = platform.mass + mass_properties(moments, mass_kg, placements[i]);
    }
  }
  platform.meshes.push_back(std::move(mesh));
}

}  // namespace

PlatformModel generate_platform(const Settings& parameters) {
  PlatformModel platform;
  platform.title = parameters.text("title");
  const std::vector<std::string> topologies = {"dumbbell", "tabletop", "hollow", "free"};
  platform.topology = topologies[parameters.choice("topology", topologies)];
  const int segments = static_cast<int>(parameters.integer_or("segments", 48, 12, 512));

  std::vector<Material> materials;
  for (const Settings& table : parameters.tables("material")) {
    materials.push_back(material_from(table));
    platform.materials.push_back(materials.back().look);
  }
  const std::vector<Settings> parts = parameters.tables("part");
  if (parts.empty()) throw parameters.error("part", "nothing", "at least one [[part]]");
  for (const Settings& part : parts) add_part(part, materials, segments, platform);
  parameters.finish();
  return platform;
}

}  // namespace photorque
