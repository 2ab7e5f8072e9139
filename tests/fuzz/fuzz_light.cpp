// Fuzz target: any bytes, read as a recording of light (scan, sweep or run) and as a table of light
// pressure in the SPAD layout, give that or an InputError. The reader of recordings takes a file,
// so the bytes go through one in memory.
#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "core/errors.h"
#include "diagnosis/light/recordings/recording.h"
#include "receivers/wrench/spad.h"

namespace {

void read_recording_at(const std::filesystem::path& path) {
  using namespace photorque;
  const bool told = is_light_recording(path);
  try {
    const LightRecording recording = read_light_recording(path, {});
    if (!told) std::abort();
    if (recording.temperature_K.size() != recording.rows()) std::abort();
    for (const double voltage_V : recording.voltage_V) {
      if (!std::isfinite(voltage_V)) std::abort();
    }
  } catch (const InputError&) {
    // The one exception that is allowed.
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const int file = memfd_create("fuzz", 0);
  if (file < 0 || write(file, data, size) != static_cast<ssize_t>(size)) std::abort();
  read_recording_at("/proc/self/fd/" + std::to_string(file));
  close(file);
  try {
    photorque::parse_spad(std::string(reinterpret_cast<const char*>(data), size), "fuzz");
  } catch (const photorque::InputError&) {
    // Likewise.
  }
  return 0;
}
