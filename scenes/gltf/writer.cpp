#include "scenes/gltf/writer.h"

#include <algorithm>
#include <bit>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/text/format.h"
#include "scenes/gltf/geometry.h"

namespace photorque {
namespace {

using Json = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "glTF buffers are little-endian");

// glTF 2.0, sections 3.6 and 3.7.
constexpr int type_float = 5126, type_unsigned_short = 5123, type_unsigned_int = 5125;
constexpr int target_vertices = 34962, target_indices = 34963;

Json to_json(const SettingsNode& node) {
  if (const auto* flag = std::get_if<bool>(&node.value)) return *flag;
  if (const auto* whole = std::get_if<int64_t>(&node.value)) return *whole;
  if (const auto* real = std::get_if<double>(&node.value)) return *real;
  if (const auto* text = std::get_if<std::string>(&node.value)) return *text;
  if (const auto* array = std::get_if<SettingsNode::Array>(&node.value)) {
    Json items = Json::array();
    for (const auto& item : *array) items.push_back(to_json(item));
    return items;
  }
  Json items = Json::object();
  for (const auto& [key, item] : std::get<SettingsNode::Table>(node.value))
    items[key] = to_json(item);
  return items;
}

// Converts body (x, y, z) to glTF (x, z, −y).
Vec3 to_gltf_axes(const Vec3& body) {
  return {body.x(), body.z(), -body.y()};
}

// The binary buffer, with its views and accessors.
class Buffer {
 public:
  // Appends rows of `columns` numbers; returns the accessor's index.
  template <typename T>
  size_t add(const std::vector<T>& numbers, int component_type, size_t columns, int target) {
    const auto bytes = std::as_bytes(std::span(numbers));
    views_.push_back({{"buffer", 0},
                      {"byteOffset", bytes_.size()},
                      {"byteLength", bytes.size()},
                      {"target", target}});
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    constexpr const char* types[] = {"", "SCALAR", "VEC2", "VEC3"};
    accessors_.push_back({{"bufferView", views_.size() - 1},
                          {"componentType", component_type},
                          {"count", numbers.size() / columns},
                          {"type", types[columns]}});
    return accessors_.size() - 1;
  }

  Json& accessor(size_t index) { return accessors_[index]; }

  void write_to(Json& document) const {
    document["accessors"] = accessors_;
    document["bufferViews"] = views_;
    document["buffers"] =
        Json::array({{{"byteLength", bytes_.size()},
                      {"uri", "data:application/octet-stream;base64," + base64(bytes_)}}});
  }

 private:
  std::vector<std::byte> bytes_;
  Json views_ = Json::array();
  Json accessors_ = Json::array();
};

// The attribute POSITION and, if positions are exact and need it, gltf::position_rest.
Json position_attributes(Buffer& buffer, const std::vector<Vec3>& vertices_m, bool exact) {
  std::vector<float> numbers, rests;
  Eigen::Vector3f low = Eigen::Vector3f::Constant(1e30f), high = -low;
  for (const Vec3& vertex : vertices_m) {
    const Eigen::Vector3f position = to_gltf_axes(vertex).cast<float>();
    low = low.cwiseMin(position);
    high = high.cwiseMax(position);
    for (const float x : position) numbers.push_back(x + 0.0f);  // no negative zeros
    if (!exact) continue;
    const Vec3 rest_m = to_gltf_axes(vertex) - position.cast<double>();
    for (const double x : rest_m) rests.push_back(static_cast<float>(x));
  }
  const size_t index = buffer.add(numbers, type_float, 3, target_vertices);
  buffer.accessor(index)["min"] = {low.x() + 0.0f, low.y() + 0.0f, low.z() + 0.0f};
  buffer.accessor(index)["max"] = {high.x() + 0.0f, high.y() + 0.0f, high.z() + 0.0f};
  Json attributes = {{"POSITION", index}};
  if (std::ranges::any_of(rests, [](float rest) { return rest != 0.0f; })) {
    attributes[gltf::position_rest] = buffer.add(rests, type_float, 3, target_vertices);
  }
  return attributes;
}

size_t add_indices(Buffer& buffer, const Mesh& mesh) {
  std::vector<uint32_t> wide;
  for (const auto& triangle : mesh.triangles)
    wide.insert(wide.end(), triangle.begin(), triangle.end());
  constexpr size_t max_for_short = 65535;  // 65535 itself restarts a primitive
  if (mesh.vertices_m.size() > max_for_short) {
    return buffer.add(wide, type_unsigned_int, 1, target_indices);
  }
  const std::vector<uint16_t> narrow(wide.begin(), wide.end());
  return buffer.add(narrow, type_unsigned_short, 1, target_indices);
}

Json primitive_json(Buffer& buffer, const Mesh& mesh, int material, bool exact) {
  Json primitive = {{"attributes", position_attributes(buffer, mesh.vertices_m, exact)}};
  primitive["indices"] = add_indices(buffer, mesh);
  if (material >= 0) primitive["material"] = material;
  return primitive;
}

Json material_json(const GltfWriterMaterial& material) {
  Json json = {{"name", material.name},
               {"pbrMetallicRoughness",
                {{"baseColorFactor", {0.5, 0.5, 0.5, 1.0}},
                 {"metallicFactor", 0.0},
                 {"roughnessFactor", 0.5}}}};
  if (material.optics) json["extras"]["photorque"] = to_json(*material.optics);
  return json;
}

// Writes nodes and roots, and the glTF meshes (a mesh with its material) that the nodes use.
void write_nodes(const GltfWriterModel& model, Json& document, Buffer& buffer) {
  std::map<std::pair<int, int>, size_t> mesh_indices;
  Json nodes = Json::array(), meshes = Json::array(), roots = Json::array();
  for (size_t i = 0; i < model.nodes.size(); ++i) {
    const GltfWriterNode& node = model.nodes[i];
    const Vec3 translation_m = to_gltf_axes(node.translation_m);
    Json json = {{"name", node.name}};
    if (!translation_m.isZero(0.0)) {
      json["translation"] = {translation_m.x(), translation_m.y(), translation_m.z()};
    }
    if (node.mesh >= 0) {
      const auto [entry, is_new] =
          mesh_indices.try_emplace({node.mesh, node.material}, meshes.size());
      if (is_new) {
        const Mesh& mesh = model.meshes[static_cast<size_t>(node.mesh)];
        const Json primitives =
            Json::array({primitive_json(buffer, mesh, node.material, model.exact_positions)});
        meshes.push_back({{"name", node.name}, {"primitives", primitives}});
      }
      json["mesh"] = entry->second;
    }
    nodes.push_back(std::move(json));
    if (node.parent < 0) {
      roots.push_back(i);
    } else {
      nodes[static_cast<size_t>(node.parent)]["children"].push_back(i);
    }
  }
  document["scene"] = 0;
  document["scenes"] = Json::array({{{"nodes", roots}}});
  document["nodes"] = std::move(nodes);
  document["meshes"] = std::move(meshes);
}

}  // namespace

std::string gltf_text(const GltfWriterModel& model) {
  Json document;
  document["asset"] = {{"version", "2.0"}, {"generator", "photorque"}};
  Buffer buffer;
  write_nodes(model, document, buffer);
  Json materials = Json::array();
  for (const GltfWriterMaterial& material : model.materials)
    materials.push_back(material_json(material));
  if (!materials.empty()) document["materials"] = std::move(materials);
  buffer.write_to(document);
  return document.dump(1) + "\n";
}

}  // namespace photorque
