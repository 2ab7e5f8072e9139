// Fuzz target: any bytes as an STL model.
#include "tests/fuzz/targets/cad.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  photorque::fuzz::try_cad(photorque::CadFormat::stl, data, size);
  return 0;
}
