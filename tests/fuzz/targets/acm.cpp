// Fuzz target: any bytes as a CCSDS attitude comprehensive message; its quaternions, and the
// message written and read again.
#include "attitude/ccsds/acm.h"

#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace photorque;
  const fuzz::FileInMemory file(data, size);
  fuzz::may_refuse([&] {
    const AttitudeComprehensive message = read_acm(file.path());
    for (const AttitudeComprehensive::AttitudeBlock& block : message.attitudes) {
      fuzz::may_refuse([&] {
        if (block.quaternions().size() != block.time_s.size()) std::abort();
      });
    }
    const fuzz::FileInMemory again(kvn_text(message.message));
    fuzz::may_refuse([&] {
      if (read_acm(again.path()).attitudes.size() != message.attitudes.size()) std::abort();
    });
  });
  return 0;
}
