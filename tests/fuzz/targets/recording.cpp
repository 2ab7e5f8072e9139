// Fuzz target: any bytes as a recording of motion, plain or compressed, and as a file of commands.
#include "attitude/recordings/recording.h"

#include <cmath>

#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace photorque;
  const fuzz::FileInMemory file(data, size);
  fuzz::may_refuse([&] {
    const Recording recording = read_recording(file.path(), {.max_cells = 1 << 20});
    for (const double time_s : recording.time_s) {
      if (!std::isfinite(time_s)) std::abort();
    }
  });
  fuzz::may_refuse([&] { read_command_file(file.path()); });
  return 0;
}
