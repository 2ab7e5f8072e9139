// Fuzz target: any bytes as a CCSDS orbit ephemeris message, and as an attitude parameter message.
#include "attitude/recordings/apm.h"
#include "attitude/recordings/oem.h"
#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace photorque;
  const fuzz::FileInMemory file(data, size);
  fuzz::may_refuse([&] {
    const OrbitEphemeris orbit(file.path());
    for (const double at_s : {0.0, 0.5 * orbit.duration_s(), orbit.duration_s()}) {
      if (!orbit.at(at_s)[0].allFinite()) std::abort();
    }
  });
  fuzz::may_refuse([&] {
    const AttitudeParameters attitude = read_apm(file.path());
    if (!(std::abs(attitude.lab_from_body.norm() - 1.0) < 1e-9)) std::abort();
  });
  return 0;
}
