#include "tools/realtime/gate.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>

namespace photorque {

// The layout in memory is that of the packet.
static_assert(std::endian::native == std::endian::little);
static_assert(sizeof(photorque_header) == 48);
static_assert(sizeof(photorque_command_packet) == 72);
static_assert(sizeof(photorque_measurement_packet) == 256);

Gate::Gate(uint64_t run, double max_torque_N_m, int64_t silence_ns)
    : run_(run), max_torque_N_m_(max_torque_N_m), silence_ns_(silence_ns) {}

bool Gate::is_silent(int64_t now_ns) const {
  return client_ && now_ns - last_received_ns_ > silence_ns_;
}

uint64_t Gate::total_refused() const {
  return std::accumulate(refused_.begin(), refused_.end(), uint64_t{0});
}

// First fault of the packet; empty if it is valid. `packet` is filled as far as it is valid.
std::optional<Refusal> Gate::fault_of(std::span<const std::byte> bytes,
                                      ClientPacket& packet) const {
  if (bytes.size() < sizeof(photorque_header) || bytes.size() > sizeof packet.command) {
    return Refusal::size;
  }
  std::memcpy(&packet.command, bytes.data(), bytes.size());
  const photorque_header& header = packet.command.header;
  if (header.magic != PHOTORQUE_MAGIC) return Refusal::magic;
  if (header.version != PHOTORQUE_VERSION) return Refusal::version;
  const bool commands = header.kind == PHOTORQUE_COMMAND;
  if (!commands && header.kind != PHOTORQUE_HELLO && header.kind != PHOTORQUE_GOODBYE) {
    return Refusal::kind;
  }
  packet.kind = static_cast<photorque_packet_kind>(header.kind);
  const size_t wanted = commands ? sizeof(photorque_command_packet) : sizeof(photorque_header);
  if (bytes.size() != wanted || header.size != wanted) return Refusal::size;
  if (header.checksum != photorque_checksum(bytes.data(), header.size)) return Refusal::checksum;
  if (!commands) return {};
  double squares = 0.0;
  for (const double t : packet.command.torque_body_N_m) squares += t * t;
  if (!std::isfinite(squares)) return Refusal::not_finite;
  if (std::sqrt(squares) > max_torque_N_m_) return Refusal::too_large;
  return {};
}

// Reason why this sender may not send this packet now; empty if it may.
std::optional<Refusal> Gate::reason_to_refuse(const ClientPacket& packet, uint64_t sender,
                                              int64_t now_ns) const {
  const photorque_header& header = packet.command.header;
  const bool is_hello = packet.kind == PHOTORQUE_HELLO;
  if (header.run != run_ && !(is_hello && header.run == 0)) return Refusal::run;
  if (!client_ || *client_ != sender) {
    const bool is_free = !client_ || is_silent(now_ns);
    return is_hello && is_free ? std::optional<Refusal>{} : Refusal::stranger;
  }
  // A client that restarted at the same address begins a new sequence.
  if (header.sequence <= last_sequence_ && !(is_hello && header.run == 0)) return Refusal::old;
  return {};
}

std::optional<ClientPacket> Gate::admit(std::span<const std::byte> bytes, uint64_t sender,
                                        int64_t now_ns) {
  ClientPacket packet;
  std::optional<Refusal> fault = fault_of(bytes, packet);
  if (!fault) fault = reason_to_refuse(packet, sender, now_ns);
  if (fault) {
    ++refused_[static_cast<size_t>(*fault)];
    return {};
  }
  const bool begins_anew = has_commanded_ && packet.command.header.run == 0;
  packet.begins_session = packet.kind == PHOTORQUE_HELLO && (client_ != sender || begins_anew);
  if (packet.begins_session) has_commanded_ = false;
  if (packet.kind == PHOTORQUE_COMMAND) has_commanded_ = true;
  client_ = sender;
  last_sequence_ = packet.command.header.sequence;
  last_received_ns_ = now_ns;
  if (packet.kind == PHOTORQUE_GOODBYE) client_.reset();
  return packet;
}

}  // namespace photorque
