// Checks of received packets.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "tools/realtime/photorque_serve.h"

namespace photorque {

// Reason for rejecting a packet; names in refusal_names.
enum class Refusal {
  size,        // differs from that of its kind
  magic,       // not a packet of this protocol
  version,     // another layout
  kind,        // not one that clients send
  checksum,    // damaged in transit
  not_finite,  // contains NaN or infinity
  too_large,   // exceeds max_torque_N_m
  run,         // for another run
  stranger,    // from another sender than the client
  old,         // sent before an accepted packet, or repeated
  count
};
inline constexpr std::array<const char*, static_cast<size_t>(Refusal::count)> refusal_names = {
    "size",       "magic",     "version", "kind",     "checksum",
    "not_finite", "too_large", "run",     "stranger", "old"};

// An accepted packet.
struct ClientPacket {
  // A hello of another client, or of a client that has sent commands before.
  bool begins_session = false;
  photorque_packet_kind kind = PHOTORQUE_HELLO;
  photorque_command_packet command{};  // a hello and a goodbye have only its header
};

// Accepts one client at a time: the first that sends a hello, until its goodbye or until it is
// silent for `silence_ns`. Sequence numbers restart with the hello of a session.
class Gate {
 public:
  Gate(uint64_t run, double max_torque_N_m, int64_t silence_ns);

  // Checks `bytes` from `sender` (its address as a number). Never throws. A rejected packet only
  // increases a counter.
  std::optional<ClientPacket> admit(std::span<const std::byte> bytes, uint64_t sender,
                                    int64_t now_ns);

  std::optional<uint64_t> client() const { return client_; }
  // Whether there is a client from which nothing was received for longer than `silence_ns`.
  bool is_silent(int64_t now_ns) const;
  const std::array<uint64_t, refusal_names.size()>& refused() const { return refused_; }
  uint64_t total_refused() const;

 private:
  std::optional<Refusal> fault_of(std::span<const std::byte> bytes, ClientPacket& packet) const;
  std::optional<Refusal> reason_to_refuse(const ClientPacket& packet, uint64_t sender,
                                          int64_t now_ns) const;

  uint64_t run_;
  double max_torque_N_m_;
  int64_t silence_ns_;
  std::optional<uint64_t> client_;
  bool has_commanded_ = false;  // since its hello
  uint64_t last_sequence_ = 0;
  int64_t last_received_ns_ = 0;
  std::array<uint64_t, refusal_names.size()> refused_{};
};

}  // namespace photorque
