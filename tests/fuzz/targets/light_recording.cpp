// Fuzz target: any bytes as a recording of light: a scan, a sweep or a run.
#include <cmath>

#include "diagnosis/light/model/recording.h"
#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace photorque;
  const fuzz::FileInMemory file(data, size);
  const bool reported = is_light_recording(file.path());
  fuzz::may_refuse([&] {
    const LightRecording recording = read_light_recording(file.path(), {});
    if (!reported) std::abort();
    if (recording.temperature_K.size() != recording.rows()) std::abort();
    if (recording.part({recording.rows() - 1}).rows() != 1) std::abort();
    for (const double voltage_V : recording.voltage_V) {
      if (!std::isfinite(voltage_V)) std::abort();
    }
  });
  return 0;
}
