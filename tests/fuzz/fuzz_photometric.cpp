// Fuzz target: any bytes, read as an IES LM-63, an EULUMDAT and an IES TM-33 file, give a table
// that can be interpolated and written back, or an InputError.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "core/errors.h"
#include "sources/photometry/file.h"
#include "sources/profiles/tabulated_intensity.h"

namespace {

template <typename Reader>
void try_to_read(const Reader& reader, const std::string& bytes) {
  using namespace photorque;
  try {
    const PhotometricFile file = reader(bytes, "fuzz");
    constexpr size_t slow = 20000;  // larger tables take their time, which is no fault
    if (file.table.intensity.size() > slow) return;
    const TabulatedIntensity intensity(file.table);
    if (!(intensity.at(0.3, 0.2) >= 0.0)) std::abort();
    if (read_ies(write_ies(file), "written").table.intensity != file.table.intensity) std::abort();
  } catch (const InputError&) {
    // The one exception that is allowed.
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  try_to_read(photorque::read_ies, bytes);
  try_to_read(photorque::read_eulumdat, bytes);
  try_to_read(photorque::read_tm33, bytes);
  return 0;
}
