// Fuzz target: any bytes, read as a ray file of each format, give rays that a lamp can hold,
// or an InputError.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "core/errors.h"
#include "sources/lamps/rays.h"
#include "sources/rayfiles/set.h"

namespace {

template <typename Reader>
void try_to_read(const Reader& reader, const std::string& bytes) {
  using namespace photorque;
  try {
    const RaySet set = reader(bytes, "fuzz");
    const RayLamp lamp(1.0, set);
    const double intensity = lamp.relative_intensity(0.1);
    if (!(intensity >= 0.0 && intensity <= 1.0)) std::abort();
    if (read_tm25(write_tm25(set), "written").rays.size() != set.rays.size()) std::abort();
  } catch (const InputError&) {
    // The one exception that is allowed.
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  try_to_read(photorque::read_tm25, bytes);
  try_to_read(photorque::read_zemax_rays, bytes);
  try_to_read(photorque::read_lighttools_rays, bytes);
  return 0;
}
