// Fuzz target: any bytes as a lamp table in EULUMDAT format.
#include "tests/fuzz/targets/photometric.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  photorque::fuzz::try_photometric(photorque::read_eulumdat, data, size);
  return 0;
}
