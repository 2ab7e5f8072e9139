// Fuzz target: any bytes as a lamp table in IES LM-63 format.
#include "tests/fuzz/targets/photometric.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  photorque::fuzz::try_photometric(photorque::read_ies, data, size);
  return 0;
}
