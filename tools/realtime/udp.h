// The way in and out: UDP.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "tools/realtime/photorque_serve.h"

namespace photorque {

// Bytes as they came; longer packets are cut, which their size then tells.
struct ReceivedBytes {
  std::array<std::byte, 128> bytes{};
  size_t size = 0;
  uint64_t sender = 0;
};

struct Transport {
  // To the client; nobody is told when it is not there.
  std::function<void(const photorque_measurement_packet& packet, uint64_t client)> send;
  // The next packet that is there or comes until `until_ns` (CLOCK_MONOTONIC).
  std::function<std::optional<ReceivedBytes>(int64_t until_ns)> receive;
  std::string where;  // for people: "127.0.0.1:4160"
};

// Binds to address and port (0: any that is free). In the last `spin_ns` before the end of a wait
// it looks again and again instead of sleeping. InputError (key serve.address) where that cannot
// be.
Transport udp_transport(const std::string& address, int port, int64_t spin_ns);

}  // namespace photorque
