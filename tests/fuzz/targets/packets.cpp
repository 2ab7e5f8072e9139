// Fuzz target: any bytes, given to the gate of `serve` as they would come over the network: from
// another sender and from the client, as they are and with a checksum that is right. Nothing but a
// whole packet of the client's kinds, finite and within its bounds, may pass.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <vector>

#include "tools/realtime/gate.h"

namespace {

constexpr uint64_t run_number = 77;
constexpr double most_N_m = 0.5;

void check(const photorque::ClientPacket& packet) {
  const photorque_header& header = packet.command.header;
  if (header.magic != PHOTORQUE_MAGIC || header.version != PHOTORQUE_VERSION) std::abort();
  if (packet.kind != PHOTORQUE_COMMAND) return;
  double squares = 0.0;
  for (const double t : packet.command.torque_body_N_m) squares += t * t;
  if (!(std::sqrt(squares) <= most_N_m)) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace photorque;
  Gate gate(run_number, most_N_m, 1000);
  photorque_header hello{};
  hello.sequence = 1;
  photorque_seal(&hello, PHOTORQUE_HELLO, sizeof hello);
  gate.admit(std::as_bytes(std::span(&hello, 1)), 5, 0);
  std::vector<uint8_t> bytes(data, data + size);
  for (const bool repaired : {false, true}) {
    constexpr size_t at = offsetof(photorque_header, checksum);
    if (repaired && bytes.size() >= sizeof(photorque_header)) {
      const uint32_t sum = photorque_checksum(bytes.data(), static_cast<uint32_t>(bytes.size()));
      std::memcpy(bytes.data() + at, &sum, sizeof sum);
    }
    for (const uint64_t sender : {uint64_t{5}, uint64_t{6}}) {
      if (const auto packet = gate.admit(std::as_bytes(std::span(bytes)), sender, 10)) {
        check(*packet);
      }
    }
  }
  return 0;
}
