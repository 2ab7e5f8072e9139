// Fuzz target: any bytes, read as a recording, a CCSDS attitude message, a table of numbers, of
// torque or of measured scattering, give that or an InputError. Most of these readers take a file,
// so the bytes go through one in memory.
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "attitude/ccsds/acm.h"
#include "attitude/ccsds/aem.h"
#include "attitude/disturbances/fields/torque_surface.h"
#include "attitude/recordings/recording.h"
#include "core/errors.h"
#include "core/text/columns.h"
#include "scenes/surfaces/brdf_file.h"

namespace {

template <typename Reader>
void try_to_read(const Reader& reader, const std::filesystem::path& path) {
  try {
    reader(path);
  } catch (const photorque::InputError&) {
    // The one exception that is allowed.
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace photorque;
  const int file = memfd_create("fuzz", 0);
  if (file < 0 || write(file, data, size) != static_cast<ssize_t>(size)) std::abort();
  const std::filesystem::path path = "/proc/self/fd/" + std::to_string(file);
  try_to_read([](const auto& at) { return read_recording(at); }, path);
  try_to_read([](const auto& at) { return read_aem(at); }, path);
  try_to_read([](const auto& at) { return read_acm(at); }, path);
  try_to_read([](const auto& at) { return read_wrench_table(at); }, path);
  try_to_read([](const auto& at) { return read_column_names(at); }, path);
  close(file);
  try_to_read(
      [&](const auto&) {
        return read_brdf(std::string(reinterpret_cast<const char*>(data), size), "fuzz");
      },
      path);
  return 0;
}
