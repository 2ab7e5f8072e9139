// Fuzz target: any bytes as a CCSDS attitude ephemeris message.
#include "attitude/recordings/aem.h"

#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace photorque;
  const fuzz::FileInMemory file(data, size);
  fuzz::may_refuse([&] { read_aem(file.path()); });
  return 0;
}
