// Fuzz target: any bytes as glTF, plain, binary and compressed, give a scene and lamps or an
// InputError. gltf_mutator.cpp changes what stands in it, not only its bytes.
#include "scenes/experiment/named_files.h"
#include "scenes/gltf/lights.h"
#include "scenes/gltf/reader.h"
#include "tests/fuzz/target.h"

namespace {

void check(const photorque::Scene& scene) {
  for (const photorque::Mesh& mesh : scene.meshes) {
    for (const photorque::Vec3& vertex_m : mesh.vertices_m) {
      if (!vertex_m.allFinite()) std::abort();
    }
    for (const auto& triangle : mesh.triangles) {
      for (const uint32_t corner : triangle) {
        if (corner >= mesh.vertices_m.size()) std::abort();
      }
    }
  }
  for (const photorque::OpticalSurface& surface : scene.surfaces) {
    for (const auto* fractions :
         {&surface.absorbed, &surface.specular, &surface.diffuse, &surface.transmitted}) {
      for (const double fraction : *fractions) {
        if (!(fraction >= -1e-9 && fraction <= 1.0 + 1e-9)) std::abort();
      }
    }
  }
}

photorque::Settings settings_of(const char* key, const std::string& text) {
  photorque::SettingsNode node;
  node.value = photorque::SettingsNode::Table{{key, {text}}};
  return photorque::Settings(std::make_shared<const photorque::SettingsNode>(node));
}

// Keys that an experiment's lamps take from a model's.
void place_sources(const std::vector<photorque::GltfLight>& lights) {
  for (const photorque::GltfLight& light : lights) {
    photorque::fuzz::may_refuse([&] {
      photorque::source_at_light(settings_of("light", light.name), lights);
      photorque::profile_of_lights(lights, light.profile_name);
    });
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace photorque;
  const std::string bytes = fuzz::text_of(data, size);
  const GltfOpen zeros = [](const std::string&) -> std::optional<std::string> {
    return std::string(4096, '\0');
  };
  GltfOptions options;
  options.largest_bytes = 1 << 24;
  options.picture = [](const std::string& picture) -> BaseColours {
    if (picture.size() < 4) throw InputError({"picture"}, "", "nothing", "a picture");
    return {1, 1, {0.2F, 0.5F, 0.8F}};
  };
  fuzz::may_refuse([&] { check(read_gltf_bytes(bytes, "fuzz", zeros, options).scene); });
  fuzz::may_refuse([&] {
    place_sources(read_gltf_lights_bytes(bytes, "fuzz", zeros, 1.0, options.largest_bytes));
  });
  // A material of this name is the experiment's.
  if (bytes.find("\"overridden\"") != std::string::npos) {
    options.materials = {settings_of("name", "overridden")};
    fuzz::may_refuse([&] { check(read_gltf_bytes(bytes, "fuzz", zeros, options).scene); });
  }
  // Files that a sweep counts as parts of a model.
  files_named_in("/nowhere/model.gltf", bytes);
  files_named_in("/nowhere/model.glb", bytes);
  return 0;
}
