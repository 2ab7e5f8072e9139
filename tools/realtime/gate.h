// Checks of received packets before their use.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "tools/realtime/photorque_serve.h"

namespace photorque {

// Why a packet is refused; names in refusal_names.
enum class Refusal {
  size,        // not that of its kind
  magic,       // not a packet of this protocol
  version,     // of another layout
  kind,        // not one that clients send
  checksum,    // damaged on its way
  not_finite,  // NaN or infinity
  too_large,   // beyond max_torque_N_m
  run,         // for another run
  stranger,    // from another sender than the client
  old,         // sent before an admitted one, or repeated
  count
};
inline constexpr std::array<const char*, static_cast<size_t>(Refusal::count)> refusal_names = {
    "size",       "magic",     "version", "kind",     "checksum",
    "not_finite", "too_large", "run",     "stranger", "old"};

// An admitted packet: its kind and command.
struct ClientPacket {
  bool begins_session = false;  // a hello of another client, or of one that commanded before
  photorque_packet_kind kind = PHOTORQUE_HELLO;
  photorque_command_packet command{};  // a hello and a goodbye have its header alone
};

// Accepts one client at a time: the first that sends a hello, until its goodbye or a silence of
// `silence_ns`. Sequence numbers start with the hello of a session.
class Gate {
 public:
  Gate(uint64_t run, double max_torque_N_m, int64_t silence_ns);

  // `bytes` as they came from `sender` (a number for its address). Never throws; a
  // refused packet has no effect but its count.
  std::optional<ClientPacket> admit(std::span<const std::byte> bytes, uint64_t sender,
                                    int64_t now_ns);

  std::optional<uint64_t> client() const { return client_; }
  // Whether there is a client, and nothing came from it for longer than `silence_ns`.
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
