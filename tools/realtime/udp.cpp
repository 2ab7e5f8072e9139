// Packets over UDP: one non-blocking socket.
#include "tools/realtime/udp.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>
#include <cerrno>
#include <cstring>
#include <memory>

#include "core/errors.h"
#include "tools/realtime/clock.h"

namespace photorque {

namespace {

// A file descriptor that is closed by its last owner.
std::shared_ptr<const int> owned(int descriptor) {
  return {new int(descriptor), [](const int* one) {
            ::close(*one);
            delete one;
          }};
}

// Address and port as one number.
uint64_t number_of(const sockaddr_in& address) {
  return (uint64_t{ntohl(address.sin_addr.s_addr)} << 16) | ntohs(address.sin_port);
}

sockaddr_in address_of(uint64_t number) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(static_cast<uint32_t>(number >> 16));
  address.sin_port = htons(static_cast<uint16_t>(number & 0xffff));
  return address;
}

std::optional<ReceivedBytes> receive_now(int socket) {
  ReceivedBytes got;
  sockaddr_in from{};
  socklen_t from_size = sizeof from;
  // With MSG_TRUNC, the result is the size of the packet, even if it exceeds the buffer.
  const ssize_t size =
      ::recvfrom(socket, got.bytes.data(), got.bytes.size(), MSG_DONTWAIT | MSG_TRUNC,
                 reinterpret_cast<sockaddr*>(&from), &from_size);
  if (size < 0) return {};
  got.size = static_cast<size_t>(size);
  got.sender = number_of(from);
  return got;
}

void sleep_for_packet(int socket, int64_t longest_ns) {
  constexpr int64_t second_ns = 1'000'000'000;
  const timespec timeout{longest_ns / second_ns, longest_ns % second_ns};
  pollfd wanted{socket, POLLIN, 0};
  ::ppoll(&wanted, 1, &timeout, nullptr);
}

}  // namespace

UdpSocket::UdpSocket(const std::string& address, int port, int64_t spin_ns) : spin_ns_(spin_ns) {
  const auto fail = [&](const std::string& found, const std::string& expected) {
    return InputError({}, "serve.address", found, expected);
  };
  sockaddr_in own{};
  own.sin_family = AF_INET;
  own.sin_port = htons(static_cast<uint16_t>(port));
  if (::inet_pton(AF_INET, address.c_str(), &own.sin_addr) != 1) {
    throw fail("\"" + address + "\"", "an IPv4 address in numbers, such as 127.0.0.1");
  }
  const int raw = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (raw < 0) throw fail(std::strerror(errno), "a UDP socket");
  socket_ = owned(raw);
  if (::bind(raw, reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0) {
    throw fail(address + ":" + std::to_string(port) + ", " + std::strerror(errno),
               "an address of this machine and a port that is free");
  }
  socklen_t size = sizeof own;
  ::getsockname(raw, reinterpret_cast<sockaddr*>(&own), &size);
  where_ = address + ":" + std::to_string(ntohs(own.sin_port));
}

std::string UdpSocket::text_of(uint64_t client) {
  const sockaddr_in from = address_of(client);
  char text[INET_ADDRSTRLEN] = {};
  ::inet_ntop(AF_INET, &from.sin_addr, text, sizeof text);
  return std::string(text) + ":" + std::to_string(ntohs(from.sin_port));
}

void UdpSocket::send(const photorque_measurement_packet& packet, uint64_t client) const {
  const sockaddr_in to = address_of(client);
  ::sendto(*socket_, &packet, sizeof packet, MSG_DONTWAIT | MSG_NOSIGNAL,
           reinterpret_cast<const sockaddr*>(&to), sizeof to);
}

std::optional<ReceivedBytes> UdpSocket::receive(int64_t until_ns) const {
  for (;;) {
    if (std::optional<ReceivedBytes> got = receive_now(*socket_)) return got;
    const int64_t left_ns = until_ns - monotonic_ns();
    if (left_ns <= 0) return {};
    if (left_ns > spin_ns_) sleep_for_packet(*socket_, left_ns - spin_ns_);
  }
}

}  // namespace photorque
