#include "scenes/gltf/nodes.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <ranges>

#include "scenes/gltf/file/accessor.h"

namespace photorque::gltf {
namespace {

constexpr size_t deepest_hierarchy = 1000;

std::vector<int> roots_of(const Document& document) {
  const tinygltf::Model& model = document.model;
  if (!model.scenes.empty()) {
    return model.scenes[static_cast<size_t>(std::max(model.defaultScene, 0))].nodes;
  }
  std::vector<bool> is_child(model.nodes.size(), false);
  for (const tinygltf::Node& node : model.nodes) {
    for (const int child : node.children) is_child[static_cast<size_t>(child)] = true;
  }
  std::vector<int> roots;
  for (size_t i = 0; i < is_child.size(); ++i) {
    if (!is_child[i]) roots.push_back(static_cast<int>(i));
  }
  return roots;
}

// Rejects meshes that are deformed for drawing: the traced shape would differ from the drawn one.
void refuse_deformation(const Document& document, int index) {
  const tinygltf::Node& node = document.model.nodes[static_cast<size_t>(index)];
  const tinygltf::Mesh& mesh = document.model.meshes[static_cast<size_t>(node.mesh)];
  if (node.skin >= 0) {
    throw document.wrong(pointer("nodes", index, "skin"), "a skinned mesh",
                         "rigid meshes (apply the pose before exporting)");
  }
  const bool morphs = std::any_of(mesh.primitives.begin(), mesh.primitives.end(),
                                  [](const auto& primitive) { return !primitive.targets.empty(); });
  const std::vector<double>& weights = node.weights.empty() ? mesh.weights : node.weights;
  const auto is_zero = [](double weight) { return weight == 0.0; };
  if (morphs && !std::all_of(weights.begin(), weights.end(), is_zero)) {
    throw document.wrong(node.weights.empty() ? pointer("meshes", node.mesh, "weights")
                                              : pointer("nodes", index, "weights"),
                         "morph targets with weights",
                         "rigid meshes (apply the shape before exporting)");
  }
}

}  // namespace

Affine parent_from_node(const tinygltf::Node& node) {
  Affine transform = Affine::Identity();
  if (!node.matrix.empty()) {
    transform.matrix() = Eigen::Map<const Eigen::Matrix4d>(node.matrix.data());  // by columns
    transform.makeAffine();
    return transform;
  }
  const auto& t = node.translation;
  const auto& q = node.rotation;  // x, y, z, w
  const auto& s = node.scale;
  if (!t.empty()) transform.translate(Vec3(t[0], t[1], t[2]));
  if (!q.empty()) transform.rotate(Quat(q[3], q[0], q[1], q[2]).normalized());
  if (!s.empty()) transform.scale(Vec3(s[0], s[1], s[2]));
  return transform;
}

bool is_unit(const Quat& rotation) {
  return std::abs(rotation.norm() - 1.0) <= 0.01;
}

bool is_invertible(const Affine& transform) {
  const Mat3 axes = transform.linear();
  // Determinant of the normalised axes: it measures how far they are from one plane.
  const double lengths = axes.col(0).norm() * axes.col(1).norm() * axes.col(2).norm();
  return transform.matrix().allFinite() && std::isnormal(lengths) &&
         std::abs(axes.determinant()) > 1e-12 * lengths;
}

void visit_nodes(const Document& document, MemoryBudget* budget,
                 const std::function<void(const NodeVisit&)>& visit) {
  std::vector<NodeVisit> waiting;  // an explicit stack, because files determine the depth
  for (const int root : std::views::reverse(roots_of(document))) {
    waiting.push_back({root, 1, "", Affine::Identity()});
  }
  while (!waiting.empty()) {
    NodeVisit next = std::move(waiting.back());
    waiting.pop_back();
    const tinygltf::Node& node = document.model.nodes[static_cast<size_t>(next.node)];
    const std::string where = pointer("nodes", next.node);
    if (next.depth > deepest_hierarchy) {
      throw document.wrong(where, "a hierarchy deeper than " + std::to_string(deepest_hierarchy),
                           "a shallower one");
    }
    if (!next.path.empty()) next.path += "/";
    next.path += node.name.empty() ? "node_" + std::to_string(next.node) : node.name;
    next.world_from_node = next.world_from_node * parent_from_node(node);
    if (!is_invertible(next.world_from_node)) {
      throw document.wrong(where, "a product of transforms that is singular or overflows",
                           "an invertible one");
    }
    budget->charge(node.children.size(), sizeof(NodeVisit) + next.path.size(), where);
    for (const int child : std::views::reverse(node.children)) {
      waiting.push_back({child, next.depth + 1, next.path, next.world_from_node});
    }
    visit(next);
  }
}

std::vector<Placement> place_meshes(const Document& document, MemoryBudget* budget) {
  std::vector<Placement> placements;
  visit_nodes(document, budget, [&](const NodeVisit& visit) {
    const tinygltf::Node& node = document.model.nodes[static_cast<size_t>(visit.node)];
    if (node.mesh < 0) return;
    refuse_deformation(document, visit.node);
    const std::string name = node.name.empty() ? "node_" + std::to_string(visit.node) : node.name;
    for (const Affine& node_from_mesh : gpu_instances(document, visit.node, budget)) {
      budget->charge(1, sizeof(Placement) + name.size() + visit.path.size(),
                     pointer("nodes", visit.node));
      placements.push_back(
          {visit.node, node.mesh, name, visit.path, visit.world_from_node * node_from_mesh});
    }
  });
  return placements;
}

namespace {

constexpr const char* extension = "EXT_mesh_gpu_instancing";

// Reader of an attribute, if the node has it.
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

}  // namespace

std::vector<Affine> gpu_instances(const Document& document, int node, MemoryBudget* budget) {
  const nlohmann::json* const found =
      extension_of(document.json["nodes"][static_cast<size_t>(node)], extension);
  if (!found) return {Affine::Identity()};
  const nlohmann::json& attributes = (*found)["attributes"];
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
    if (translation) instances[i].translate(translation->vector3(i));
    bool is_valid = true;
    if (rotation) {
      const Vec3 imaginary = rotation->vector3(i);
      const Quat turn(rotation->number(i, 3), imaginary[0], imaginary[1], imaginary[2]);
      is_valid = is_unit(turn);
      instances[i].rotate(turn.normalized());
    }
    if (scale) instances[i].scale(scale->vector3(i));
    if (!is_valid || !is_invertible(instances[i])) {
      throw document.wrong(where, "instance " + std::to_string(i) + ", singular or not finite",
                           "invertible transforms with unit quaternions");
    }
  }
  return instances;
}

}  // namespace photorque::gltf
