// Fuzz target: any bytes as a CCSDS attitude comprehensive message.
#include "attitude/ccsds/acm.h"

#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace photorque;
  const fuzz::FileInMemory file(data, size);
  fuzz::may_refuse([&] { read_acm(file.path()); });
  return 0;
}
