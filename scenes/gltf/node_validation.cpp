#include <cmath>

#include "scenes/gltf/nodes.h"
#include "scenes/gltf/validation.h"

namespace photorque::gltf {
namespace {

void check_transform(const Document& document, size_t i) {
  const tinygltf::Node& node = document.model.nodes[i];
  const std::string where = pointer("nodes", i);
  if (!node.matrix.empty()) {
    const auto& m = node.matrix;
    // Exporters round; more than this would be a perspective.
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

// The parent of every node.
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

// With one parent at most, a cycle is a way up that returns. Every node is visited once: `seen`
// holds from which start.
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

// A root that is listed twice, or also a child, would put its triangles there twice.
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
