// Fuzz target: any bytes as a table of light pressure in the SPAD layout.
#include "receivers/wrench/spad.h"

#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace photorque;
  fuzz::may_refuse([&] { parse_spad(fuzz::text_of(data, size), "fuzz"); });
  return 0;
}
