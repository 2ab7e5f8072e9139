#include "scenes/gltf/lights.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "core/constants.h"
#include "core/files.h"
#include "core/settings/settings.h"
#include "core/transform.h"
#include "scenes/gltf/nodes.h"
#include "scenes/gltf/validation.h"
#include "sources/lamps/settings.h"

namespace photorque {
namespace {

using gltf::Document;
using nlohmann::json;

constexpr const char* punctual_extension = "KHR_lights_punctual";
constexpr const char* profile_extension = "EXT_lights_ies";

// The extension's object in `owner`; an empty object if there is none.
json lights_object(const json& owner, const char* extension) {
  const json* const found = gltf::extension_of(owner, extension);
  return found && found->is_object() ? *found : json::object();
}

std::string text_or(const json& object, const char* key) {
  const json* const found = gltf::member_of(object, key);
  return found && found->is_string() ? found->get<std::string>() : "";
}

// An element of an extension's list of lights.
struct ListedLight {
  json light;
  size_t number;
  std::string where;  // JSON pointer
};

// The light that a node places; empty if it places none.
std::optional<ListedLight> light_at(const Document& document, int node, const char* extension) {
  const json reference =
      lights_object(document.json["nodes"][static_cast<size_t>(node)], extension);
  if (!reference.contains("light")) return std::nullopt;
  const json& number = reference["light"];
  const json lights = lights_object(document.json, extension).value("lights", json::array());
  if (!number.is_number_unsigned() || !lights.is_array() ||
      number.get<uint64_t>() >= lights.size()) {
    throw document.wrong(gltf::pointer("nodes", node, "extensions", extension, "light"),
                         number.dump(), "the number of a light of the file");
  }
  const auto which = number.get<size_t>();
  return ListedLight{lights[which], which, gltf::pointer("extensions", extension, "lights", which)};
}

// A light without its position.
GltfLight described_light(const Document& document, const ListedLight& listed) {
  const auto& [light, number, where] = listed;
  constexpr double widest_rad = 0.5 * pi, usual_rad = 0.25 * pi;
  GltfLight described;
  const std::string type = text_or(light, "type");
  if (type == "spot") {
    described.kind = GltfLight::Kind::spot;
    described.outer_cone_rad = usual_rad;
    const json spot = light.value("spot", json::object());
    if (spot.is_object() && spot.contains("outerConeAngle")) {
      const json& angle = spot["outerConeAngle"];
      described.outer_cone_rad = angle.is_number() ? angle.get<double>() : 0.0;
    }
    // π/2 in single precision is slightly larger than π/2.
    if (!(described.outer_cone_rad > 0.0 && described.outer_cone_rad <= widest_rad * (1 + 1e-6))) {
      throw document.wrong(where + "/spot/outerConeAngle", std::to_string(described.outer_cone_rad),
                           "above 0, at most π/2");
    }
    described.outer_cone_rad = std::min(described.outer_cone_rad, widest_rad);
  } else if (type == "directional") {
    described.kind = GltfLight::Kind::directional;
  } else if (type != "point") {
    throw document.wrong(where + "/type", '"' + type + '"', "\"point\", \"spot\", \"directional\"");
  }
  return described;
}

GltfLight described_profile(const Document& document, const ListedLight& listed,
                            const GltfOpen& open, gltf::MemoryBudget* budget) {
  const auto& [light, number, where] = listed;
  GltfLight described;
  described.kind = GltfLight::Kind::profile;
  described.profile_name = std::filesystem::path(document.file).filename().string() + where;
  if (light.is_object() && light.contains("bufferView")) {
    described.profile_bytes =
        gltf::bytes_of_view(document, where + "/bufferView", light["bufferView"]);
  } else {
    const std::string uri = text_or(light, "uri");
    if (!uri.starts_with("data:")) described.profile_name = uri;
    described.profile_bytes =
        gltf::load_uri({light, where, {"application/x-ies-lm-63", "application/octet-stream"}},
                       document.file, open, budget);
  }
  return described;
}

// Converts (x, y, z) with y up to (x, −z, y).
Vec3 turned(const Vec3& file) {
  return {file.x(), -file.z(), file.y()};
}

// Rotation angle [rad] of a lamp about its `direction` that turns its x axis to `across`.
double turn_towards(const Vec3& direction, const Vec3& across) {
  const RigidTransform lab_from_lamp = lamp_frame(direction, Vec3::Zero());
  const Vec3 seen = lab_from_lamp.rotation.conjugate() * across;
  return std::atan2(seen.y(), seen.x());
}

std::vector<GltfLight> placed_lights(const Document& document, double metres_per_unit,
                                     const GltfOpen& open, gltf::MemoryBudget* budget) {
  std::vector<GltfLight> all;
  gltf::visit_nodes(document, budget, [&](const gltf::NodeVisit& visit) {
    const int node = visit.node;
    const Affine& world = visit.world_from_node;
    const std::string& name = document.model.nodes[static_cast<size_t>(node)].name;
    const auto place = [&](GltfLight light, const ListedLight& listed) {
      light.name = !name.empty() ? name : text_or(listed.light, "name");
      if (light.name.empty()) light.name = "light_" + std::to_string(listed.number);
      light.position_m = metres_per_unit * turned(world.translation());
      light.direction = turned(world.linear() * -Vec3::UnitZ()).normalized();
      light.turn_rad = turn_towards(light.direction, turned(world.linear() * Vec3::UnitX()));
      all.push_back(std::move(light));
    };
    if (const auto listed = light_at(document, node, punctual_extension)) {
      place(described_light(document, *listed), *listed);
    }
    if (const auto listed = light_at(document, node, profile_extension)) {
      place(described_profile(document, *listed, open, budget), *listed);
    }
  });
  return all;
}

SettingsNode numbers_node(const Vec3& values, const InputLocation& where) {
  SettingsNode::Array array;
  for (const double x : values) array.push_back({x, where});
  return {std::move(array), where};
}

const GltfLight& light_named(const Settings& source, const std::vector<GltfLight>& lights) {
  const std::string name = source.text("light");
  std::set<std::string> names;
  const GltfLight* found = nullptr;
  size_t count = 0;
  for (const GltfLight& light : lights) {
    names.insert(light.name);
    if (light.name != name) continue;
    found = &light;
    ++count;
  }
  if (count == 1) return *found;
  if (count > 1) {
    throw source.error("light", '"' + name + "\", the name of " + std::to_string(count) + " lamps",
                       "a name that one lamp of the scene has");
  }
  throw source.error("light", '"' + name + '"',
                     names.empty() ? "a scene with lights (KHR_lights_punctual, EXT_lights_ies)"
                                   : "one of " + listed_names(names, name));
}

}  // namespace

std::vector<GltfLight> read_gltf_lights(const std::filesystem::path& path, double metres_per_unit,
                                        bool may_leave_folder) {
  constexpr uint64_t largest_bytes = 4ull << 30;
  return read_gltf_lights_bytes(read_file(path, largest_bytes), path.string(),
                                files_beside(path.parent_path(), largest_bytes, may_leave_folder),
                                metres_per_unit, largest_bytes);
}

std::vector<GltfLight> read_gltf_lights_bytes(const std::string& bytes, const std::string& file,
                                              const GltfOpen& open, double metres_per_unit,
                                              uint64_t largest_bytes) {
  gltf::MemoryBudget budget(file, largest_bytes);
  budget.charge(bytes.size(), 1, "");
  const Document document = gltf::read_document(bytes, file, open, &budget);
  gltf::validate_nodes(document);
  return placed_lights(document, metres_per_unit, open, &budget);
}

Settings source_at_light(const Settings& source, const std::vector<GltfLight>& lights) {
  const GltfLight& light = light_named(source, lights);
  const InputLocation where = source.raw("light").where;
  SettingsNode::Table keys;
  std::set<std::string> stems;
  bool aimed = false;
  for (const std::string& key : source.keys()) {
    if (key == "light") continue;
    keys[key] = source.raw(key);
    const std::string stem(unit_of_key(key).stem);
    // `aim` alone states the relative directions of the lamps of an array, not a point.
    aimed = aimed || (stem == "aim" && key != stem);
    stems.insert(stem);
  }
  const auto fill_in = [&](const std::string& key, SettingsNode node) {
    if (!stems.contains(unit_of_key(key).stem)) keys[key] = std::move(node);
  };
  const bool spot = light.kind == GltfLight::Kind::spot;
  const bool directional = light.kind == GltfLight::Kind::directional;
  const bool profile = light.kind == GltfLight::Kind::profile;
  if (spot) fill_in("kind", {std::string("led"), where});
  if (directional) fill_in("kind", {std::string("sun"), where});
  if (profile) fill_in("kind", {std::string("ies"), where});
  if (!directional && !stems.contains("positions")) {
    fill_in("position_m", numbers_node(light.position_m, where));
  }
  bool aimed_here = false;
  if (light.kind != GltfLight::Kind::point && !aimed) {
    fill_in("direction", numbers_node(light.direction, where));
    aimed_here = !stems.contains("direction");
  }
  // The cone becomes the beam of an LED; lamps of other kinds define their own beams.
  const auto stated = keys.find("kind");
  const auto* text =
      stated == keys.end() ? nullptr : std::get_if<std::string>(&stated->second.value);
  const std::string kind = text == nullptr ? "" : *text;
  if (spot && (kind == "led" || kind == "led_array") && !stems.contains("profile")) {
    fill_in("profile", {std::string("pillbox"), where});
    fill_in("half_angle_rad", {light.outer_cone_rad, where});
    fill_in("pillbox_measure", {std::string("solid_angle"), where});
  }
  if (profile && kind == "ies" && !stems.contains("intensity")) {
    fill_in("file", {light.profile_name, where});
    if (aimed_here) fill_in("turn_rad", {light.turn_rad, where});
  }
  fill_in("name", {light.name, where});
  SettingsNode root;
  root.where = source.where();
  root.value = std::move(keys);
  return Settings(std::move(root), source.name());
}

std::optional<std::string> profile_of_lights(const std::vector<GltfLight>& lights,
                                             const std::string& file) {
  for (const GltfLight& light : lights) {
    if (light.kind == GltfLight::Kind::profile && light.profile_name == file) {
      return light.profile_bytes;
    }
  }
  return std::nullopt;
}

}  // namespace photorque
