// Fuzz target: any bytes, read as glTF, give a scene and lamps or an InputError. tools/sanitize
// runs it.
#include <cstddef>
#include <cstdint>
#include <string>

#include "scenes/gltf/lights.h"
#include "scenes/gltf/reader.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using photorque::GltfOptions;
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  const photorque::GltfOpen zeros = [](const std::string&) -> std::optional<std::string> {
    return std::string(4096, '\0');
  };
  GltfOptions options;
  options.largest_bytes = 1 << 26;
  try {
    photorque::read_gltf_bytes(bytes, "fuzz", zeros, options);
  } catch (const photorque::InputError&) {
    // The one exception that is allowed.
  }
  try {
    photorque::read_gltf_lights_bytes(bytes, "fuzz", zeros, 1.0, options.largest_bytes);
  } catch (const photorque::InputError&) {
    // Likewise.
  }
  return 0;
}
