// Fuzz target: any bytes as a table of torque over attitude.
#include "attitude/disturbances/fields/torque_surface.h"

#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace photorque;
  const fuzz::FileInMemory file(data, size);
  fuzz::may_refuse([&] { read_wrench_table(file.path()); });
  return 0;
}
