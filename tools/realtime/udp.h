// Packets over UDP.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "tools/realtime/photorque_serve.h"

namespace photorque {

// Received bytes. Longer packets are truncated, but `size` is their full size.
struct ReceivedBytes {
  std::array<std::byte, 128> bytes{};
  size_t size = 0;
  uint64_t sender = 0;
};

// A non-blocking socket. Copies share it; the last one closes it.
class UdpSocket {
 public:
  // Binds to address and port (0: any free one). In the last `spin_ns` of a wait the socket is
  // polled without sleeping. Throws InputError (key serve.address) on failure.
  UdpSocket(const std::string& address, int port, int64_t spin_ns);

  // Sends a packet to the client. A closed port at the client is not an error.
  void send(const photorque_measurement_packet& packet, uint64_t client) const;
  // The next packet that is available or arrives until `until_ns` (CLOCK_MONOTONIC).
  std::optional<ReceivedBytes> receive(int64_t until_ns) const;
  // Address as text: "127.0.0.1:4160".
  const std::string& where() const { return where_; }
  static std::string text_of(uint64_t client);

 private:
  int64_t spin_ns_;
  std::shared_ptr<const int> socket_;
  std::string where_;
};

}  // namespace photorque
