// Fuzz target: any bytes as a table of measured scattering.
#include "scenes/surfaces/settings.h"
#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace photorque;
  fuzz::may_refuse([&] { coverage_notice(read_brdf(fuzz::text_of(data, size), "fuzz")); });
  return 0;
}
