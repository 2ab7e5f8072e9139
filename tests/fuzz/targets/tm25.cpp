// Fuzz target: any bytes as a file of rays in IES TM-25 format.
#include "tests/fuzz/targets/rays.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  photorque::fuzz::try_rays(photorque::read_tm25, data, size);
  return 0;
}
