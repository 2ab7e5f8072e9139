// The generated platform as a scene, and its mass properties as text and data.
#include <map>
#include <sstream>

#include "scenes/platforms/generator.h"

namespace photorque {
namespace {

SettingsNode node_of(double number) {
  // Six digits suffice for a mass, and do not depend on the mathematical library.
  std::ostringstream text;
  text.precision(6);
  text << number;
  SettingsNode node;
  node.value = std::stod(text.str());
  return node;
}

SettingsNode node_of(const Vec3& vector) {
  SettingsNode node;
  node.value = SettingsNode::Array{node_of(vector.x()), node_of(vector.y()), node_of(vector.z())};
  return node;
}

// Sets lengths below 1e-9 of the platform's size, which are rounding errors, to zero.
Vec3 without_rounding(const Vec3& v, double scale) {
  return (v.array().abs() < 1e-9 * scale).select(Vec3::Zero(), v);
}

Mat3 shown_inertia(const PlatformModel& platform) {
  Mat3 inertia_kg_m2 = platform.mass.inertia_kg_m2;
  const double scale = inertia_kg_m2.trace();
  for (int i = 0; i < 3; ++i) inertia_kg_m2.col(i) = without_rounding(inertia_kg_m2.col(i), scale);
  return inertia_kg_m2;
}

SettingsNode mass_extras(const PlatformModel& platform) {
  const Mat3 inertia_kg_m2 = shown_inertia(platform);
  SettingsNode rows;
  rows.value =
      SettingsNode::Array{node_of(Vec3(inertia_kg_m2.row(0))), node_of(Vec3(inertia_kg_m2.row(1))),
                          node_of(Vec3(inertia_kg_m2.row(2)))};
  SettingsNode title;
  title.value = platform.title;
  SettingsNode extras;
  extras.value = SettingsNode::Table{
      {"title", title},
      {"mass_kg", node_of(platform.mass.mass_kg)},
      {"centre_of_mass_body_m", node_of(without_rounding(platform.mass.centre_m, 1.0))},
      {"inertia_body_kg_m2", rows}};
  return extras;
}

// The node at `path`, made with its parents where it does not exist.
int node_at(const std::string& path, GltfWriterModel& model, std::map<std::string, int>& indices,
            std::vector<RigidTransform>& body_from_node, const RigidTransform* placed) {
  if (const auto known = indices.find(path); known != indices.end()) return known->second;
  const size_t slash = path.rfind('/');
  GltfWriterNode node;
  RigidTransform body_from_parent;
  if (slash != std::string::npos) {
    node.parent = node_at(path.substr(0, slash), model, indices, body_from_node, nullptr);
    body_from_parent = body_from_node[static_cast<size_t>(node.parent)];
  }
  node.name = path.substr(slash == std::string::npos ? 0 : slash + 1);
  const RigidTransform body_from_this = placed == nullptr ? body_from_parent : *placed;
  if (placed != nullptr) node.parent_from_node = body_from_parent.inverse() * body_from_this;
  const int index = static_cast<int>(model.nodes.size());
  indices[path] = index;
  model.nodes.push_back(std::move(node));
  body_from_node.push_back(body_from_this);
  return index;
}

}  // namespace

GltfWriterModel to_gltf(const PlatformModel& platform) {
  GltfWriterModel model;
  model.meshes = platform.meshes;
  model.materials = platform.materials;
  model.extras = mass_extras(platform);
  std::map<std::string, int> indices;
  std::vector<RigidTransform> body_from_node;
  for (const PlatformPart& part : platform.parts) {
    const int index = node_at(part.node, model, indices, body_from_node, &part.body_from_part);
    GltfWriterNode& node = model.nodes[static_cast<size_t>(index)];
    node.mesh = static_cast<int>(part.mesh);
    node.material = static_cast<int>(part.material);
    SettingsNode extras;
    extras.value = SettingsNode::Table{{"mass_kg", node_of(part.mass_kg)}};
    node.extras = std::move(extras);
  }
  return model;
}

std::string platform_table_toml(const PlatformModel& platform) {
  const Mat3 inertia_kg_m2 = shown_inertia(platform);
  const Vec3 centre_m = without_rounding(platform.mass.centre_m, 1.0);
  std::ostringstream text;
  text.precision(6);
  const auto row = [&text](const Vec3& v) {
    text << "[" << v.x() << ", " << v.y() << ", " << v.z() << "]";
  };
  text << "[platform]\n# centre of mass, body axes [m]: ";
  row(centre_m);
  text << "\ntopology = \"" << platform.topology << "\"\nmass_kg = " << platform.mass.mass_kg
       << "\ninertia_kg_m2 = [";
  for (int i = 0; i < 3; ++i) {
    if (i > 0) text << ", ";
    row(inertia_kg_m2.row(i));
  }
  text << "]\n";
  return text.str();
}

}  // namespace photorque
