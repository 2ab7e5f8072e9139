#include "scenes/gltf/optics.h"

#include <algorithm>
#include <array>
#include <set>

#include "core/settings/settings.h"
#include "core/text/format.h"
#include "raytrace/surfaces/bsdf.h"
#include "raytrace/surfaces/glass.h"
#include "scenes/gltf/file/fault.h"

namespace photorque::gltf {
namespace {

using nlohmann::json;

// Grey fractions of a surface, before its coverage is applied.
struct Grey {
  double specular = 0, diffuse = 0, transmitted = 0;
  double alpha = 1;
};

// The metallic-roughness model of glTF with the extensions for transmission and refraction.
struct MetallicRoughness {
  std::vector<double> color;  // red, green, blue, alpha
  double metallic, roughness, transmission, index;

  explicit MetallicRoughness(const json& material) {
    const json pbr = material.value("pbrMetallicRoughness", json::object());
    const json extensions = material.value("extensions", json::object());
    color = pbr.value("baseColorFactor", std::vector<double>{1, 1, 1, 1});
    metallic = pbr.value("metallicFactor", 1.0);
    roughness = pbr.value("roughnessFactor", 1.0);
    transmission = extensions.value("KHR_materials_transmission", json::object())
                       .value("transmissionFactor", 0.0);
    index = extensions.value("KHR_materials_ior", json::object()).value("ior", 1.5);
  }
};

Grey from_metallic_roughness(const MetallicRoughness& m) {
  const double fresnel = (m.index - 1) * (m.index - 1) / ((m.index + 1) * (m.index + 1));
  const double mirror = (1 - m.metallic) * fresnel + m.metallic * luminance(m.color);
  const double below = (1 - m.metallic) * (1 - fresnel) * luminance(m.color);
  return {(1 - m.roughness) * mirror, m.roughness * mirror + (1 - m.transmission) * below,
          m.transmission * below, m.color[3]};
}

Grey from_specular_glossiness(const json& values) {
  const auto diffuse = values.value("diffuseFactor", std::vector<double>{1, 1, 1, 1});
  const auto specular = values.value("specularFactor", std::vector<double>{1, 1, 1});
  const double roughness = 1 - values.value("glossinessFactor", 1.0);
  const double mirror = luminance(specular);
  return {(1 - roughness) * mirror, roughness * mirror + (1 - mirror) * luminance(diffuse), 0,
          diffuse[3]};
}

// Fraction of the surface that is covered by material.
double coverage(const json& material, double alpha) {
  const std::string mode = material.value("alphaMode", "OPAQUE");
  if (mode == "BLEND") return alpha;
  return mode == "MASK" && alpha < material.value("alphaCutoff", 0.5) ? 0.0 : 1.0;
}

// Glass over matt ground, or a clear pane, for a dielectric that states its index and covers the
// whole surface.
std::optional<OpticalSurface> derived_glass(const json& material, int bands,
                                            const std::string& name) {
  const json extensions = material.value("extensions", json::object());
  const MetallicRoughness m(material);
  if (!extensions.contains("KHR_materials_ior") || m.metallic > 0.0 ||
      extensions.contains("KHR_materials_pbrSpecularGlossiness")) {
    return std::nullopt;
  }
  const bool pane = m.transmission == 1.0 && m.roughness == 0.0;
  if (m.index < 1.0 || m.index > 10.0 || (m.transmission > 0.0 && !pane) ||
      coverage(material, m.color[3]) < 1.0) {
    return std::nullopt;
  }
  const double bright = std::min(luminance(m.color), 1.0);
  OpticalSurface base;
  base.name = name;
  for (size_t band = 0; band < static_cast<size_t>(bands); ++band) {
    (pane ? base.transmitted : base.diffuse)[band] = bright;
    base.absorbed[band] = 1.0 - bright;
  }
  const double alpha = m.roughness == 0.0 ? 0.0 : std::max(m.roughness * m.roughness, 1e-3);
  return behind_glass(base, m.index, alpha);
}

// The table `photorque` of the extras, if there is one.
std::optional<Settings> extras_of(const Document& document, int index) {
  if (index < 0) return std::nullopt;
  const json& material = document.json["materials"][static_cast<size_t>(index)];
  const json* const extras = member_of(material, "extras");
  const json* const table = extras ? member_of(*extras, "photorque") : nullptr;
  if (!table) return std::nullopt;
  const std::string where = pointer("materials", index, "extras", "photorque");
  if (!table->is_object()) throw document.wrong(where, describe_json(*table), "an object");
  return Settings(settings_from_json(*table, {document.file}), where);
}

}  // namespace

std::optional<UvTransform> uv_transform(const Document& document, int material) {
  if (material < 0) return std::nullopt;
  const auto at = nlohmann::json::json_pointer(pointer("materials", material,
                                                       "pbrMetallicRoughness", "baseColorTexture",
                                                       "extensions", "KHR_texture_transform"));
  if (!document.json.contains(at)) return std::nullopt;
  const json& extension = document.json[at];
  if (!extension.is_object()) {
    throw document.wrong(at.to_string(), describe_json(extension), "an object");
  }
  const auto pair_of = [&](const char* key, const Vec2& otherwise) -> Vec2 {
    const auto found = extension.find(key);
    if (found == extension.end()) return otherwise;
    if (!found->is_array() || found->size() != 2 || !(*found)[0].is_number() ||
        !(*found)[1].is_number()) {
      throw document.wrong(at.to_string() + pointer(key), describe_json(*found), "two numbers");
    }
    return {(*found)[0].get<double>(), (*found)[1].get<double>()};
  };
  const json turn = extension.value("rotation", json(0.0));
  if (!turn.is_number()) {
    throw document.wrong(at.to_string() + "/rotation", describe_json(turn), "a number");
  }
  // v runs downwards, so a counter-clockwise rotation on the picture is clockwise in (u, v).
  return Eigen::Translation2d(pair_of("offset", Vec2::Zero())) *
         Eigen::Rotation2Dd(-turn.get<double>()) * Eigen::Scaling(pair_of("scale", Vec2::Ones()));
}

SettingsNode settings_from_json(const json& value, const InputLocation& where) {
  SettingsNode node;
  node.where = where;
  if (value.is_null()) throw InputError(where, "", "null", "a value");
  if (value.is_boolean()) {
    node.value = value.get<bool>();
  } else if (value.is_string()) {
    node.value = value.get<std::string>();
  } else if (value.is_number_integer() &&
             !(value.is_number_unsigned() && value.get<uint64_t>() > INT64_MAX)) {
    node.value = value.get<int64_t>();
  } else if (value.is_number()) {
    node.value = value.get<double>();
  } else if (value.is_array()) {
    SettingsNode::Array array;
    for (const json& item : value) array.push_back(settings_from_json(item, where));
    node.value = std::move(array);
  } else {
    SettingsNode::Table table;
    for (const auto& [key, item] : value.items()) table[key] = settings_from_json(item, where);
    node.value = std::move(table);
  }
  return node;
}

OpticalSurface derived_surface(const json& material, int bands, std::string name) {
  const json extensions = material.value("extensions", json::object());
  const auto glossy = extensions.find("KHR_materials_pbrSpecularGlossiness");
  const Grey grey = glossy == extensions.end()
                        ? from_metallic_roughness(MetallicRoughness(material))
                        : from_specular_glossiness(*glossy);
  const double covered = coverage(material, grey.alpha);
  if (const std::optional<OpticalSurface> glass = derived_glass(material, bands, name)) {
    return *glass;
  }
  OpticalSurface surface;
  surface.name = std::move(name);
  for (size_t band = 0; band < static_cast<size_t>(bands); ++band) {
    surface.specular[band] = covered * grey.specular;
    surface.diffuse[band] = covered * grey.diffuse;
    surface.transmitted[band] = 1 - covered + covered * grey.transmitted;
    // Rounding must not let a perfect reflector emit.
    surface.absorbed[band] = std::max(
        0.0, 1 - surface.specular[band] - surface.diffuse[band] - surface.transmitted[band]);
  }
  return surface;
}

OpticalSurface derived_surface(json material, const std::array<double, 3>& picture, int bands,
                               std::string name) {
  json& pbr = material["pbrMetallicRoughness"];
  auto color = pbr.value("baseColorFactor", std::vector<double>{1, 1, 1, 1});
  for (size_t k = 0; k < picture.size(); ++k) color[k] *= picture[k];
  pbr["baseColorFactor"] = color;
  return derived_surface(material, bands, std::move(name));
}

MaterialOverrides read_overrides(const Document& document, const GltfOptions& options,
                                 const SurfaceFiles& files) {
  std::set<std::string> names;
  for (const tinygltf::Material& material : document.model.materials) names.insert(material.name);
  MaterialOverrides overrides;
  for (const Settings& material : options.materials) {
    const std::string name = material.text("name");
    if (!name.empty() && !names.contains(name)) {
      throw material.error("name", "\"" + name + "\"",
                           "a material of " + document.file + ": " + listed_names(names, name));
    }
    if (!overrides.emplace(name, read_sheet(material, options.bands.count(), name, files)).second) {
      throw material.error("name", "\"" + name + "\" a second time", "each material once");
    }
  }
  return overrides;
}

MaterialOptics material_optics(const Document& document, int index, int bands,
                               const MaterialOverrides& overrides, const SurfaceFiles& files) {
  const std::string name =
      index < 0 ? "" : document.model.materials[static_cast<size_t>(index)].name;
  const auto override_of = overrides.find(name);
  if (override_of != overrides.end()) return {override_of->second, OpticsOrigin::experiment};
  if (const std::optional<Settings> extras = extras_of(document, index)) {
    const SheetOptics sheet = read_sheet(*extras, bands, name, files);
    extras->finish();
    return {sheet, OpticsOrigin::extras};
  }
  const json material =
      index < 0 ? json::object() : document.json["materials"][static_cast<size_t>(index)];
  return {{derived_surface(material, bands, name), std::nullopt}, OpticsOrigin::derived};
}

bool has_ignored_texture(const json& material) {
  constexpr std::array textures = {
      "/pbrMetallicRoughness/baseColorTexture", "/pbrMetallicRoughness/metallicRoughnessTexture",
      "/extensions/KHR_materials_transmission/transmissionTexture",
      "/extensions/KHR_materials_pbrSpecularGlossiness/diffuseTexture",
      "/extensions/KHR_materials_pbrSpecularGlossiness/specularGlossinessTexture"};
  return std::any_of(textures.begin(), textures.end(), [&](const char* texture) {
    return material.contains(json::json_pointer(texture));
  });
}

std::string describe_surface(const OpticalSurface& surface) {
  const auto fraction = [](double value) { return std::abs(value) < 1e-12 ? 0.0 : value; };
  std::string text = printed("absorptance %.3g, specular %.3g, diffuse %.3g, transmittance %.3g",
                             fraction(surface.absorbed[0]), fraction(surface.specular[0]),
                             fraction(surface.diffuse[0]), fraction(surface.transmitted[0]));
  if (surface.bsdf) {
    if (surface.bsdf->law) text += " at normal incidence";
    if (!surface.bsdf->description.empty()) text += "; " + surface.bsdf->description;
  }
  return text;
}

}  // namespace photorque::gltf
