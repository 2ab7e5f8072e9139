// Fuzz target: any bytes as a CCSDS attitude ephemeris message; its attitudes, and the message
// written and read again.
#include "attitude/recordings/aem.h"

#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace photorque;
  const fuzz::FileInMemory file(data, size);
  fuzz::may_refuse([&] {
    const AttitudeEphemeris message = read_aem(file.path());
    for (const AttitudeEphemeris::Segment& segment : message.segments) {
      fuzz::may_refuse([&] {
        if (segment.attitudes().size() != segment.rows.size()) std::abort();
      });
    }
    const fuzz::FileInMemory again(kvn_text(to_kvn(message)));
    // Names that were empty are not written, and then missed.
    fuzz::may_refuse([&] {
      if (read_aem(again.path()).segments.size() != message.segments.size()) std::abort();
    });
  });
  return 0;
}
