#include "scenes/gltf_lights.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "core/constants.h"
#include "core/files.h"
#include "scenes/gltf_nodes.h"
#include "scenes/gltf_validation.h"

namespace photorque {
namespace {

using gltf::Document;
using nlohmann::json;

constexpr const char* lights_extension = "KHR_lights_punctual";

// The extension's object in `owner`; an empty one where there is none.
json lights_object(const json& owner) {
  const auto extensions = owner.find("extensions");
  if (extensions == owner.end() || !extensions->is_object()) return json::object();
  const auto found = extensions->find(lights_extension);
  return found != extensions->end() && found->is_object() ? *found : json::object();
}

std::string text_or(const json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : "";
}

// What a light is, without its place.
GltfLight described_light(const Document& document, const json& light, const std::string& where) {
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
    // π/2 as a single number is a little more.
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
  described.name = text_or(light, "name");
  return described;
}

// (x, y, z) with y up becomes (x, −z, y).
Vec3 turned(const Vec3& file) {
  return {file.x(), -file.z(), file.y()};
}

std::vector<GltfLight> placed_lights(const Document& document, double metres_per_unit) {
  const json lights = lights_object(document.json).value("lights", json::array());
  std::vector<GltfLight> all;
  gltf::visit_nodes(document, [&](int index, const std::string& name, const Affine& world) {
    const json& node = document.json["nodes"][static_cast<size_t>(index)];
    const json reference = lights_object(node);
    if (!reference.contains("light")) return;
    const std::string where = "/nodes/" + std::to_string(index) + "/extensions/" + lights_extension;
    const json& number = reference["light"];
    if (!number.is_number_unsigned() || !lights.is_array() ||
        number.get<uint64_t>() >= lights.size()) {
      throw document.wrong(where + "/light", number.dump(), "the number of a light of the file");
    }
    const auto which = number.get<size_t>();
    GltfLight light = described_light(
        document, lights[which],
        std::string("/extensions/") + lights_extension + "/lights/" + std::to_string(which));
    if (!name.empty()) light.name = name;
    if (light.name.empty()) light.name = "light_" + std::to_string(which);
    light.position_m = metres_per_unit * turned(world.translation());
    light.direction = turned(world.linear() * -Vec3::UnitZ()).normalized();
    all.push_back(std::move(light));
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
  std::string known;
  for (const std::string& other : names) known += (known.empty() ? "\"" : ", \"") + other + '"';
  throw source.error(
      "light", '"' + name + '"',
      known.empty() ? "a scene with lights (KHR_lights_punctual)" : "one of " + known);
}

}  // namespace

std::vector<GltfLight> read_gltf_lights(const std::filesystem::path& path, double metres_per_unit) {
  constexpr uint64_t largest_bytes = 4ull << 30;
  const std::string bytes = read_file(path, largest_bytes);
  const GltfOpen open = [&](const std::string& relative_path) -> std::optional<std::string> {
    const std::filesystem::path file = path.parent_path() / relative_path;
    std::error_code failure;
    if (!std::filesystem::is_regular_file(file, failure)) return std::nullopt;
    return read_file(file, largest_bytes);
  };
  gltf::MemoryBudget budget(path.string(), largest_bytes);
  budget.charge(bytes.size(), 1, "");
  const Document document = gltf::read_document(bytes, path.string(), open, &budget);
  gltf::validate_nodes(document);
  return placed_lights(document, metres_per_unit);
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
    // `aim` alone is how the lamps of an array stand to each other, not a point.
    aimed = aimed || (stem == "aim" && key != stem);
    stems.insert(stem);
  }
  const auto fill_in = [&](const std::string& key, SettingsNode node) {
    if (!stems.contains(unit_of_key(key).stem)) keys[key] = std::move(node);
  };
  const bool spot = light.kind == GltfLight::Kind::spot;
  const bool directional = light.kind == GltfLight::Kind::directional;
  if (spot) fill_in("kind", {std::string("led"), where});
  if (directional) fill_in("kind", {std::string("sun"), where});
  if (!directional && !stems.contains("positions")) {
    fill_in("position_m", numbers_node(light.position_m, where));
  }
  if (light.kind != GltfLight::Kind::point && !aimed) {
    fill_in("direction", numbers_node(light.direction, where));
  }
  // A cone is the beam of an LED; lamps of other kinds have beams of their own.
  const auto stated = keys.find("kind");
  const auto* text =
      stated == keys.end() ? nullptr : std::get_if<std::string>(&stated->second.value);
  const std::string kind = text == nullptr ? "" : *text;
  if (spot && (kind == "led" || kind == "led_array") && !stems.contains("profile")) {
    fill_in("profile", {std::string("pillbox"), where});
    fill_in("half_angle_rad", {light.outer_cone_rad, where});
    fill_in("pillbox_measure", {std::string("solid_angle"), where});
  }
  fill_in("name", {light.name, where});
  SettingsNode root;
  root.where = source.where();
  root.value = std::move(keys);
  return Settings(std::make_shared<const SettingsNode>(std::move(root)), source.name());
}

}  // namespace photorque
