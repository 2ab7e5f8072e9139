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
  fuzz::may_refuse(
      [&] { read_gltf_lights_bytes(bytes, "fuzz", zeros, 1.0, options.largest_bytes); });
  // What a sweep takes for parts of a model.
  files_named_in("/nowhere/model.gltf", bytes);
  files_named_in("/nowhere/model.glb", bytes);
  return 0;
}
