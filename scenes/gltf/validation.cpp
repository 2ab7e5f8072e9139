#include "scenes/gltf/validation.h"

#include <algorithm>
#include <cmath>

#include "scenes/gltf/file/accessor.h"
#include "scenes/gltf/nodes.h"

namespace photorque::gltf {
namespace {

std::string text(uint64_t number) {
  return std::to_string(number);
}

bool uses_extension(const Document& document, const char* name) {
  const auto used = document.json.find("extensionsUsed");
  return used != document.json.end() && used->is_array() &&
         std::find(used->begin(), used->end(), name) != used->end();
}

// A row of equal items in a bufferView. Offsets and counts are below 2^53 and strides below 256
// (check_schema), so that the arithmetic does not overflow.
struct Row {
  uint64_t offset = 0, count = 0, stride = 0, item_bytes = 0;
  uint64_t end() const { return offset + (count - 1) * stride + item_bytes; }
};

class Checker {
 public:
  explicit Checker(const Document& document)
      : document_(document),
        model_(document.model),
        quantized_(uses_extension(document, "KHR_mesh_quantization")) {}

  void buffer_view(size_t i) const {
    const tinygltf::BufferView& view = model_.bufferViews[i];
    const uint64_t available = document_.buffers[static_cast<size_t>(view.buffer)].byte_length;
    const std::string where = pointer("bufferViews", i);
    if (view.byteOffset + view.byteLength > available) {
      throw wrong(where + "/byteLength",
                  text(view.byteLength) + " from byte " + text(view.byteOffset),
                  "an end within the " + text(available) + " bytes of the buffer");
    }
    if (view.byteStride > view.byteLength) {
      throw wrong(where + "/byteStride", text(view.byteStride),
                  "at most the byteLength, " + text(view.byteLength));
    }
    // The target is read from the JSON, because tinygltf changes it.
    if (view.byteStride > 0 && document_.json["bufferViews"][i].value("target", 0) ==
                                   TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER) {
      throw wrong(where + "/byteStride", "it on a view of indices", "none");
    }
  }

  void accessor(size_t i) const {
    const tinygltf::Accessor& accessor = model_.accessors[i];
    const ElementLayout layout = layout_of(accessor);
    const std::string where = pointer("accessors", i);
    if (accessor.normalized && (accessor.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT ||
                                accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)) {
      throw wrong(where + "/normalized", "true", "false for this componentType");
    }
    if (accessor.bufferView >= 0) {
      const size_t declared =
          model_.bufferViews[static_cast<size_t>(accessor.bufferView)].byteStride;
      if (declared > 0 && declared < layout.element_bytes) {
        throw wrong(where, "elements of " + text(layout.element_bytes) + " bytes",
                    "at most the stride of " + text(declared));
      }
      const uint64_t alignment = is_matrix(accessor) ? 4 : layout.component_bytes;
      row_fits(where, accessor.bufferView, alignment,
               {accessor.byteOffset, accessor.count, declared > 0 ? declared : layout.element_bytes,
                layout.element_bytes});
    }
    if (accessor.sparse.isSparse) sparse(accessor, layout, where + "/sparse");
  }

  void primitive(size_t mesh, size_t index) const {
    const tinygltf::Primitive& primitive = model_.meshes[mesh].primitives[index];
    const std::string where = pointer("meshes", mesh, "primitives", index);
    const auto position = primitive.attributes.find("POSITION");
    if (position == primitive.attributes.end()) return;
    const tinygltf::Accessor& positions = accessor_of(position->second);
    if (positions.type != TINYGLTF_TYPE_VEC3 || !is_coordinate(positions)) {
      throw wrong(where + "/attributes/POSITION", description(positions),
                  quantized_ ? "VEC3 of 5120 to 5123 or 5126" : "VEC3 of 5126 (float)");
    }
    for (const auto& [name, attribute] : primitive.attributes) {
      if (accessor_of(attribute).count == positions.count) continue;
      throw wrong(where + "/attributes" + pointer(name),
                  text(accessor_of(attribute).count) + " elements",
                  "as many as POSITION, " + text(positions.count));
    }
    texture_coordinates(primitive, where);
    uint64_t corners = positions.count;
    if (primitive.indices >= 0) {
      indices(accessor_of(primitive.indices), where + "/indices");
      corners = accessor_of(primitive.indices).count;
    }
    const bool makes_triangles = primitive.mode == TINYGLTF_MODE_TRIANGLES
                                     ? corners % 3 == 0
                                     : primitive.mode < TINYGLTF_MODE_TRIANGLES || corners >= 3;
    if (!makes_triangles) {
      throw wrong(where, text(corners) + " corners",
                  primitive.mode == TINYGLTF_MODE_TRIANGLES ? "a multiple of 3" : "at least 3");
    }
  }

 private:
  InputError wrong(const std::string& where, const std::string& found,
                   const std::string& expected) const {
    return document_.wrong(where, found, expected);
  }

  // Whether the accessor may hold coordinates: floats or, with KHR_mesh_quantization, bytes and
  // shorts.
  bool is_coordinate(const tinygltf::Accessor& accessor) const {
    return accessor.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT ||
           (quantized_ && accessor.componentType <= TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT);
  }

  const tinygltf::Accessor& accessor_of(int index) const {
    return model_.accessors[static_cast<size_t>(index)];
  }

  static bool is_matrix(const tinygltf::Accessor& accessor) {
    return accessor.type == TINYGLTF_TYPE_MAT2 || accessor.type == TINYGLTF_TYPE_MAT3 ||
           accessor.type == TINYGLTF_TYPE_MAT4;
  }

  std::string description(const tinygltf::Accessor& accessor) const {
    const auto i = static_cast<size_t>(&accessor - model_.accessors.data());
    const nlohmann::json& json = document_.json["accessors"][i];
    return json["type"].get<std::string>() + " of " + json["componentType"].dump() +
           (accessor.normalized ? " normalized" : "");
  }

  void row_fits(const std::string& where, int view_index, uint64_t alignment,
                const Row& row) const {
    const tinygltf::BufferView& view = model_.bufferViews[static_cast<size_t>(view_index)];
    if (row.offset % alignment != 0 || (view.byteOffset + row.offset) % alignment != 0) {
      throw wrong(where + "/byteOffset",
                  text(row.offset) + " in a view at " + text(view.byteOffset),
                  "multiples of " + text(alignment));
    }
    if (row.end() > view.byteLength) {
      throw wrong(where, text(row.count) + " elements that end at byte " + text(row.end()),
                  "an end within the " + text(view.byteLength) + " bytes of bufferView " +
                      std::to_string(view_index));
    }
  }

  void sparse(const tinygltf::Accessor& accessor, const ElementLayout& layout,
              const std::string& where) const {
    const auto& sparse = accessor.sparse;
    const auto count = static_cast<uint64_t>(sparse.count);
    if (sparse.count < 1 || count > accessor.count) {
      throw wrong(where + "/count", std::to_string(sparse.count),
                  "at most the accessor's " + text(accessor.count));
    }
    for (const auto& [view, part] : {std::pair(sparse.indices.bufferView, "/indices"),
                                     std::pair(sparse.values.bufferView, "/values")}) {
      if (model_.bufferViews[static_cast<size_t>(view)].byteStride > 0) {
        throw wrong(where + part + "/bufferView", "a view with a byteStride", "one without");
      }
    }
    const auto index_bytes = static_cast<uint64_t>(
        tinygltf::GetComponentSizeInBytes(static_cast<uint32_t>(sparse.indices.componentType)));
    row_fits(where + "/indices", sparse.indices.bufferView, index_bytes,
             {static_cast<uint64_t>(sparse.indices.byteOffset), count, index_bytes, index_bytes});
    row_fits(where + "/values", sparse.values.bufferView, layout.component_bytes,
             {static_cast<uint64_t>(sparse.values.byteOffset), count, layout.element_bytes,
              layout.element_bytes});
  }

  void texture_coordinates(const tinygltf::Primitive& primitive, const std::string& where) const {
    const auto found = primitive.attributes.find("TEXCOORD_0");
    if (found == primitive.attributes.end()) return;
    const tinygltf::Accessor& uv = accessor_of(found->second);
    const bool is_integer = uv.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                            uv.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
    if (uv.type != TINYGLTF_TYPE_VEC2 || !(is_coordinate(uv) || (is_integer && uv.normalized))) {
      throw wrong(where + "/attributes/TEXCOORD_0", description(uv),
                  "VEC2 of 5126 (float), or of 5121 or 5123 normalized");
    }
  }

  void indices(const tinygltf::Accessor& accessor, const std::string& where) const {
    const bool is_unsigned = accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                             accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                             accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    if (accessor.type != TINYGLTF_TYPE_SCALAR || !is_unsigned || accessor.normalized) {
      throw wrong(where, description(accessor), "SCALAR of 5121, 5123 or 5125, not normalized");
    }
    if (accessor.bufferView >= 0 &&
        model_.bufferViews[static_cast<size_t>(accessor.bufferView)].byteStride > 0) {
      throw wrong(where, "a bufferView with a byteStride", "indices without one");
    }
  }

  const Document& document_;
  const tinygltf::Model& model_;
  bool quantized_;
};

}  // namespace

void validate_accessors(const Document& document) {
  const Checker checker(document);
  for (size_t i = 0; i < document.model.bufferViews.size(); ++i) checker.buffer_view(i);
  for (size_t i = 0; i < document.model.accessors.size(); ++i) checker.accessor(i);
}

void validate_primitives(const Document& document) {
  const Checker checker(document);
  for (size_t m = 0; m < document.model.meshes.size(); ++m) {
    const size_t count = document.model.meshes[m].primitives.size();
    for (size_t p = 0; p < count; ++p) checker.primitive(m, p);
  }
}

namespace {

void check_transform(const Document& document, size_t i) {
  const tinygltf::Node& node = document.model.nodes[i];
  const std::string where = pointer("nodes", i);
  if (!node.matrix.empty()) {
    const auto& m = node.matrix;
    // Tolerance for rounding by exporters; larger values would be a perspective.
    constexpr double tolerance = 1e-6;
    if (std::hypot(std::hypot(m[3], m[7]), std::hypot(m[11], m[15] - 1.0)) > tolerance) {
      throw document.wrong(where + "/matrix", "a last row other than 0, 0, 0, 1",
                           "an affine transform");
    }
  }
  const auto& q = node.rotation;
  if (!q.empty() && !is_unit(Quat(q[3], q[0], q[1], q[2]))) {
    throw document.wrong(where + "/rotation",
                         "a length of " + std::to_string(Quat(q[3], q[0], q[1], q[2]).norm()),
                         "a unit quaternion");
  }
  if (!is_invertible(parent_from_node(node))) {
    throw document.wrong(where + (node.matrix.empty() ? "/scale" : "/matrix"),
                         "a transform that flattens (zero scale) or overflows",
                         "an invertible one");
  }
}

constexpr int none = -1;

// Parent of every node.
std::vector<int> parents_of(const Document& document) {
  const std::vector<tinygltf::Node>& nodes = document.model.nodes;
  std::vector<int> parents(nodes.size(), none);
  for (size_t i = 0; i < nodes.size(); ++i) {
    for (size_t c = 0; c < nodes[i].children.size(); ++c) {
      int& parent = parents[static_cast<size_t>(nodes[i].children[c])];
      if (parent != none) {
        throw document.wrong(pointer("nodes", i, "children", c),
                             "node " + std::to_string(nodes[i].children[c]) +
                                 ", already a child of node " + std::to_string(parent),
                             "a node without another parent");
      }
      parent = static_cast<int>(i);
    }
  }
  return parents;
}

// Each node has at most one parent, so that a cycle is found by following the parents. Every node
// is visited once; `seen` contains the start from which it was reached.
void refuse_cycles(const Document& document, const std::vector<int>& parents) {
  std::vector<int> seen(parents.size(), none);
  for (size_t start = 0; start < parents.size(); ++start) {
    const int mark = static_cast<int>(start);
    for (int node = mark; node != none; node = parents[static_cast<size_t>(node)]) {
      int& visit = seen[static_cast<size_t>(node)];
      if (visit == mark) {
        throw document.wrong(pointer("nodes", node, "children"), "a node below itself",
                             "a hierarchy without cycles");
      }
      if (visit != none) break;
      visit = mark;
    }
  }
}

// A root that is listed twice, or that is also a child, would place its triangles twice.
void check_roots(const Document& document, const std::vector<int>& parents) {
  const std::vector<tinygltf::Scene>& scenes = document.model.scenes;
  for (size_t s = 0; s < scenes.size(); ++s) {
    std::vector<bool> listed(parents.size(), false);
    for (size_t r = 0; r < scenes[s].nodes.size(); ++r) {
      const auto root = static_cast<size_t>(scenes[s].nodes[r]);
      if (parents[root] != none || listed[root]) {
        throw document.wrong(
            pointer("scenes", s, "nodes", r),
            "node " + std::to_string(root) +
                (listed[root] ? " a second time"
                              : ", a child of node " + std::to_string(parents[root])),
            "root nodes, each once");
      }
      listed[root] = true;
    }
  }
}

}  // namespace

void validate_nodes(const Document& document) {
  for (size_t i = 0; i < document.model.nodes.size(); ++i) check_transform(document, i);
  const std::vector<int> parents = parents_of(document);
  refuse_cycles(document, parents);
  check_roots(document, parents);
}

}  // namespace photorque::gltf
