#include "scenes/cad/model.h"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "core/files.h"
#include "core/provenance.h"
#include "core/text/format.h"
#include "core/text/parse.h"
#include "scenes/cad/part.h"
#include "scenes/gltf/writer.h"

namespace photorque {
namespace {

constexpr std::array<std::pair<const char*, double>, 6> units = {
    {{"mm", 1e-3}, {"cm", 1e-2}, {"m", 1.0}, {"um", 1e-6}, {"in", 0.0254}, {"ft", 0.3048}}};

// Assumed optics: half of the light is absorbed, half is scattered.
SettingsNode unknown_optics() {
  return {SettingsNode::Table{{"absorptance", {0.5}}, {"diffuse", {0.5}}}};
}

Vec3 in_body_axes(const Vec3& at, const CadConventions& conventions) {
  return conventions.y_is_up ? Vec3(at.x(), -at.z(), at.y()) : at;
}

std::set<std::string> described_materials(const GltfOptions& options) {
  std::set<std::string> names;
  for (const Settings& material : options.materials) {
    if (material.has("name")) names.insert(material.text("name"));
  }
  return names;
}

GltfWriterModel as_gltf(std::vector<cad::Part> parts, const CadConventions& conventions) {
  GltfWriterModel model;
  model.exact_positions = true;  // the file's numbers are decimal
  for (cad::Part& part : parts) {
    for (Vec3& vertex : part.mesh.vertices_m) vertex = in_body_axes(vertex, conventions);
    const auto known = std::ranges::find(model.materials, part.material, &GltfWriterMaterial::name);
    const auto material = static_cast<int>(known - model.materials.begin());
    if (known == model.materials.end()) {
      model.materials.push_back({part.material, unknown_optics()});
    }
    GltfWriterNode node;
    node.name = part.name;
    node.mesh = static_cast<int>(model.meshes.size());
    node.material = material;
    model.nodes.push_back(std::move(node));
    model.meshes.push_back(std::move(part.mesh));
  }
  return model;
}

}  // namespace

std::optional<CadFormat> cad_format(const std::filesystem::path& path) {
  const std::string ending = lower_case(path.extension().string());
  if (ending == ".stl") return CadFormat::stl;
  if (ending == ".obj") return CadFormat::obj;
  return std::nullopt;
}

double metres_of_unit(const std::string& unit) {
  for (const auto& [name, metres] : units) {
    if (unit == name) return metres;
  }
  return 0.0;
}

std::vector<std::string> cad_units() {
  std::vector<std::string> names;
  for (const auto& [name, metres] : units) names.emplace_back(name);
  return names;
}

GltfModel read_cad_bytes(const std::string& bytes, const std::string& file, CadFormat format,
                         const CadConventions& conventions, const GltfOptions& options) {
  const std::string name = std::filesystem::path(file).stem().string();
  std::vector<cad::Part> parts = format == CadFormat::stl ? cad::read_stl(bytes, file, name)
                                                          : cad::read_obj(bytes, file, name);
  const std::set<std::string> described = described_materials(options);
  std::set<std::string> materials;
  for (cad::Part& part : parts) {
    part.name = clean_text(part.name);
    part.material = clean_text(part.material);
    // STL has no materials: a solid may have the one with its name.
    if (format == CadFormat::stl && described.contains(part.name)) part.material = part.name;
    materials.insert(part.material);
  }
  const std::string text = gltf_text(as_gltf(std::move(parts), conventions));
  GltfOptions inside = options;
  // Each number of the file is multiplied by the unit only here.
  inside.metres_per_unit = conventions.metres_per_unit;
  GltfModel model = read_gltf_bytes(
      text, file, [](const std::string&) { return std::nullopt; }, inside);
  // The input is the file that was read, not the converted model.
  model.inputs.front() = {file, content_hash(bytes)};
  for (const std::string& material : materials) {
    if (described.contains(material)) continue;
    model.notices.push_back("material '" + material +
                            "': the file contains no optical properties; assumed: 0.5 absorbed and "
                            "0.5 scattered, unless a [[material]] of this name states others");
  }
  return model;
}

GltfModel read_cad(const std::filesystem::path& path, const CadConventions& conventions,
                   const GltfOptions& options) {
  const std::string bytes = read_file(path, options.largest_bytes);
  GltfModel model = read_cad_bytes(bytes, path.string(), *cad_format(path), conventions, options);
  model.inputs.front().first = path.filename().string();
  return model;
}

}  // namespace photorque
