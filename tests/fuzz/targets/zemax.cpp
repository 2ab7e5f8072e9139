// Fuzz target: any bytes as a file of rays in Zemax binary format.
#include "tests/fuzz/targets/rays.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  photorque::fuzz::try_rays(photorque::read_zemax_rays, data, size);
  return 0;
}
