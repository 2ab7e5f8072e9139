// KHR_draco_mesh_compression: primitives compressed with Draco. The only place for this library.
// Source: KhronosGroup/glTF, extensions/2.0/Khronos/KHR_draco_mesh_compression.
#include <draco/compression/decode.h>

#include <cstring>
#include <map>
#include <new>
#include <stdexcept>
#include <tuple>

#include "scenes/gltf/file/document.h"

namespace photorque::gltf {
namespace {

using nlohmann::json;

constexpr const char* extension_name = "KHR_draco_mesh_compression";

// Accessors of a decoded primitive.
struct Plain {
  size_t position = 0, indices = 0;
  std::optional<size_t> uv;
};

double largest_of(int component_type) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return 127.0;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 255.0;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return 32767.0;
    default:
      return 65535.0;
  }
}

class Decoder {
 public:
  Decoder(Document* document, MemoryBudget* budget) : document_(*document), budget_(*budget) {}

  // Replaces the primitive's geometry if it has only Draco data.
  void decode(size_t mesh, size_t index) {
    json& primitive = document_.json["meshes"][mesh]["primitives"][index];
    const json* const extension = extension_of(primitive, extension_name);
    if (!extension) return;
    where_ = pointer("meshes", mesh, "primitives", index, "extensions", extension_name);
    if (has_plain_positions(primitive)) return;
    const Plain plain = plain_of(*extension, primitive);
    primitive["attributes"] = json{{"POSITION", plain.position}};
    if (plain.uv) primitive["attributes"]["TEXCOORD_0"] = *plain.uv;
    primitive["indices"] = plain.indices;
    primitive["mode"] = TINYGLTF_MODE_TRIANGLES;
    primitive["extensions"].erase(extension_name);
  }

 private:
  const json* accessor_of(const json& primitive, const char* attribute) const {
    const json* const attributes = member_of(primitive, "attributes");
    const json* const index = attributes ? member_of(*attributes, attribute) : nullptr;
    const json* const accessors = member_of(document_.json, "accessors");
    if (!index || !index->is_number_unsigned() || !accessors ||
        index->get<uint64_t>() >= accessors->size()) {
      return nullptr;
    }
    return &(*accessors)[index->get<size_t>()];
  }

  bool has_plain_positions(const json& primitive) const {
    const json* const accessor = accessor_of(primitive, "POSITION");
    return accessor != nullptr &&
           (accessor->contains("bufferView") || accessor->contains("sparse"));
  }

  std::optional<uint32_t> id_of(const json& extension, const char* attribute) const {
    const json* const attributes = member_of(extension, "attributes");
    if (!attributes || !member_of(*attributes, attribute)) return std::nullopt;
    return static_cast<uint32_t>(
        extension_number(document_, *attributes, attribute, where_ + "/attributes"));
  }

  Plain plain_of(const json& extension, const json& primitive) {
    const uint64_t view = extension_number(document_, extension, "bufferView", where_);
    const auto position = id_of(extension, "POSITION");
    if (!position) throw document_.wrong(where_ + "/attributes", "no POSITION", "positions");
    const auto uv = accessor_of(primitive, "TEXCOORD_0") != nullptr ? id_of(extension, "TEXCOORD_0")
                                                                    : std::nullopt;
    const auto key = std::tuple(view, *position, uv.value_or(~0u));
    const auto known = decoded_.find(key);
    if (known != decoded_.end()) return known->second;
    const std::unique_ptr<draco::Mesh> mesh = decoded_mesh(view);
    budget_.charge(mesh->num_points(), 5 * sizeof(float), where_);
    budget_.charge(mesh->num_faces(), 3 * sizeof(uint32_t), where_);
    Plain plain;
    plain.position = add_attribute(*mesh, *position, 3, accessor_of(primitive, "POSITION"));
    if (uv) plain.uv = add_attribute(*mesh, *uv, 2, accessor_of(primitive, "TEXCOORD_0"));
    plain.indices = add_indices(*mesh);
    decoded_.emplace(key, plain);
    return plain;
  }

  std::unique_ptr<draco::Mesh> decoded_mesh(uint64_t view) const {
    const std::string_view bytes = bytes_of_view(document_, where_ + "/bufferView", view);
    draco::DecoderBuffer buffer;
    buffer.Init(bytes.data(), bytes.size());
    std::string reason;
    try {
      auto mesh = draco::Decoder().DecodeMeshFromBuffer(&buffer);
      if (mesh.ok() && mesh.value()->num_faces() > 0) return std::move(mesh).value();
      reason = mesh.ok() ? "no triangles" : mesh.status().error_msg_string();
    } catch (const std::bad_alloc&) {
      reason = "sizes beyond the memory";
    } catch (const std::length_error&) {
      reason = "sizes beyond the memory";
    }
    throw document_.wrong(where_, "data that cannot be decoded (" + reason + ")", "a Draco mesh");
  }

  size_t add_attribute(const draco::Mesh& mesh, uint32_t id, int components, const json* declared) {
    const draco::PointAttribute* const attribute = mesh.GetAttributeByUniqueId(id);
    if (attribute == nullptr || attribute->num_components() != components) {
      throw document_.wrong(where_ + "/attributes", "no such attribute " + std::to_string(id),
                            std::to_string(components) + " components");
    }
    const int type = declared ? declared->value("componentType", 0) : 0;
    const bool scaled = declared && declared->value("normalized", false) &&
                        !attribute->normalized() && type != TINYGLTF_COMPONENT_TYPE_FLOAT;
    const double scale = scaled ? 1.0 / largest_of(type) : 1.0;
    std::string bytes(mesh.num_points() * components * sizeof(float), '\0');
    for (uint32_t p = 0; p < mesh.num_points(); ++p) {
      float values[3] = {};
      const draco::AttributeValueIndex at = attribute->mapped_index(draco::PointIndex(p));
      if (at.value() >= attribute->size() ||
          !attribute->ConvertValue<float>(at, static_cast<int8_t>(components), values)) {
        throw document_.wrong(where_, "a vertex without a value", "one for every vertex");
      }
      for (int c = 0; c < components; ++c) {
        const auto value = static_cast<float>(scale * values[c]);
        std::memcpy(&bytes[(p * components + c) * sizeof(float)], &value, sizeof value);
      }
    }
    return add_accessor(std::move(bytes), TINYGLTF_COMPONENT_TYPE_FLOAT,
                        components == 3 ? "VEC3" : "VEC2", mesh.num_points());
  }

  size_t add_indices(const draco::Mesh& mesh) {
    std::string bytes(mesh.num_faces() * 3 * sizeof(uint32_t), '\0');
    for (uint32_t f = 0; f < mesh.num_faces(); ++f) {
      const draco::Mesh::Face& face = mesh.face(draco::FaceIndex(f));
      for (size_t k = 0; k < 3; ++k) {
        const uint32_t corner = face[k].value();
        std::memcpy(&bytes[(3 * f + k) * sizeof(uint32_t)], &corner, sizeof corner);
      }
    }
    return add_accessor(std::move(bytes), TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, "SCALAR",
                        3 * mesh.num_faces());
  }

  size_t add_accessor(std::string bytes, int component_type, const char* type, size_t count) {
    const size_t length = bytes.size();
    const size_t buffer = add_buffer(&document_, std::move(bytes));
    json& views = document_.json["bufferViews"];
    views.push_back(json{{"buffer", buffer}, {"byteLength", length}});
    json& accessors = document_.json["accessors"];
    accessors.push_back(json{{"bufferView", views.size() - 1},
                             {"componentType", component_type},
                             {"count", count},
                             {"type", type}});
    return accessors.size() - 1;
  }

  Document& document_;
  MemoryBudget& budget_;
  std::string where_;  // location of the extension that is being decoded
  std::map<std::tuple<uint64_t, uint32_t, uint32_t>, Plain> decoded_;
};

}  // namespace

void decode_draco_primitives(Document* document, MemoryBudget* budget) {
  if (!document->json.contains("meshes")) return;
  Decoder decoder(document, budget);
  const size_t meshes = document->json["meshes"].size();
  for (size_t m = 0; m < meshes; ++m) {
    const size_t primitives = document->json["meshes"][m]["primitives"].size();
    for (size_t p = 0; p < primitives; ++p) decoder.decode(m, p);
  }
}

}  // namespace photorque::gltf
