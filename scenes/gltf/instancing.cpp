#include "scenes/gltf/instancing.h"

#include <optional>

#include "scenes/gltf/file/accessor.h"
#include "scenes/gltf/nodes.h"

namespace photorque::gltf {
namespace {

constexpr const char* extension = "EXT_mesh_gpu_instancing";

// An attribute, if the node has it.
std::optional<AccessorReader> attribute(const Document& document, const nlohmann::json& attributes,
                                        const char* name, const std::string& where,
                                        MemoryBudget* budget) {
  const auto found = attributes.find(name);
  if (found == attributes.end()) return std::nullopt;
  const int index = found->get<int>();
  const tinygltf::Accessor& accessor = document.model.accessors[static_cast<size_t>(index)];
  const bool is_rotation = name == std::string("ROTATION");
  const bool is_float = accessor.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT;
  const bool is_packed =
      accessor.normalized && (accessor.componentType == TINYGLTF_COMPONENT_TYPE_BYTE ||
                              accessor.componentType == TINYGLTF_COMPONENT_TYPE_SHORT);
  if (accessor.type != (is_rotation ? TINYGLTF_TYPE_VEC4 : TINYGLTF_TYPE_VEC3) ||
      !(is_float || (is_rotation && is_packed))) {
    throw document.wrong(
        where + pointer(name), "an accessor of another type",
        is_rotation ? "VEC4 of float, or of normalized signed bytes or shorts" : "VEC3 of float");
  }
  return AccessorReader(document, index, budget);
}

Vec3 vector(const AccessorReader& reader, size_t i) {
  return {reader.number(i, 0), reader.number(i, 1), reader.number(i, 2)};
}

}  // namespace

std::vector<Affine> gpu_instances(const Document& document, int node, MemoryBudget* budget) {
  const nlohmann::json& json = document.json["nodes"][static_cast<size_t>(node)];
  const auto extensions = json.find("extensions");
  if (extensions == json.end() || !extensions->contains(extension)) return {Affine::Identity()};
  const nlohmann::json& attributes = (*extensions)[extension]["attributes"];
  const std::string where = pointer("nodes", node, "extensions", extension, "attributes");

  const auto translation = attribute(document, attributes, "TRANSLATION", where, budget);
  const auto rotation = attribute(document, attributes, "ROTATION", where, budget);
  const auto scale = attribute(document, attributes, "SCALE", where, budget);
  std::optional<size_t> count;
  for (const auto* reader : {&translation, &rotation, &scale}) {
    if (!*reader) continue;
    if (count && *count != (*reader)->count()) {
      throw document.wrong(where, std::to_string((*reader)->count()) + " elements",
                           "as many as the other attributes, " + std::to_string(*count));
    }
    count = (*reader)->count();
  }
  if (!count) return {Affine::Identity()};

  budget->charge(*count, sizeof(Affine), where);
  std::vector<Affine> instances(*count, Affine::Identity());
  for (size_t i = 0; i < *count; ++i) {
    if (translation) instances[i].translate(vector(*translation, i));
    bool is_valid = true;
    if (rotation) {
      const Vec3 imaginary = vector(*rotation, i);
      const Quat turn(rotation->number(i, 3), imaginary[0], imaginary[1], imaginary[2]);
      is_valid = is_unit(turn);
      instances[i].rotate(turn.normalized());
    }
    if (scale) instances[i].scale(vector(*scale, i));
    if (!is_valid || !is_invertible(instances[i])) {
      throw document.wrong(where, "instance " + std::to_string(i) + ", singular or not finite",
                           "invertible transforms with unit quaternions");
    }
  }
  return instances;
}

}  // namespace photorque::gltf
