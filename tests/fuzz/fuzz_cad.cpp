// Fuzz target: any bytes, read as STL and as OBJ, give a scene or an InputError. tools/sanitize
// runs it.
#include <cstddef>
#include <cstdint>
#include <string>

#include "scenes/cad/model.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using photorque::CadFormat;
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  photorque::GltfOptions options;
  options.largest_bytes = 1 << 26;
  for (const CadFormat format : {CadFormat::stl, CadFormat::obj}) {
    try {
      photorque::read_cad_bytes(bytes, "fuzz", format, {1e-3, true}, options);
    } catch (const photorque::InputError&) {
      // The one exception that is allowed.
    }
  }
  return 0;
}
