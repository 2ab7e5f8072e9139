// A client of `serve` over UDP with the C header and POSIX alone.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <functional>
#include <thread>
#include <vector>

#include "tests/tools/command_test.h"
#include "tools/realtime/photorque_serve.h"

namespace photorque {

using ClientTorque = std::array<double, 3>;
// Decides at every measurement.
using ClientLaw = std::function<ClientTorque(const photorque_measurement_packet&)>;

class ServeClient {
 public:
  explicit ServeClient(int port) : socket_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<uint16_t>(port));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(socket_, reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
    const timeval longest{0, 200000};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &longest, sizeof longest);
  }
  ~ServeClient() { ::close(socket_); }
  ServeClient(const ServeClient&) = delete;
  ServeClient& operator=(const ServeClient&) = delete;

  // Answers every tick until the run is over or so many have come; what came, in order.
  std::vector<photorque_measurement_packet> follow(const ClientLaw& law, size_t most = SIZE_MAX) {
    std::vector<photorque_measurement_packet> all;
    for (int silent = 0; silent < 50; ++silent) {
      if (run_ == 0) send_header(PHOTORQUE_HELLO);
      photorque_measurement_packet packet{};
      const ssize_t size = ::recv(socket_, &packet, sizeof packet, 0);
      if (size != sizeof packet || packet.header.checksum != photorque_checksum(&packet, size)) {
        continue;
      }
      silent = 0;
      run_ = packet.header.run;
      if ((packet.flags & PHOTORQUE_LAST) != 0) return all;
      if (!all.empty() && packet.header.sequence <= all.back().header.sequence) continue;
      all.push_back(packet);
      command(law(packet), packet.now_tick);
      if (all.size() == most) return all;
    }
    ADD_FAILURE() << "the server fell silent";
    return all;
  }
  void send_header(uint16_t kind) {
    photorque_header header{};
    header.sequence = ++sequence_;
    header.run = run_;
    photorque_seal(&header, kind, sizeof header);
    send_bytes(&header, sizeof header);
  }
  void command(const ClientTorque& torque_N_m, uint64_t tick) {
    photorque_command_packet packet{};
    packet.header.sequence = ++sequence_;
    packet.header.run = run_;
    packet.header.tick = tick;
    std::copy(torque_N_m.begin(), torque_N_m.end(), packet.torque_body_N_m);
    photorque_seal(&packet.header, PHOTORQUE_COMMAND, sizeof packet);
    send_bytes(&packet, sizeof packet);
  }
  void send_bytes(const void* bytes, size_t size) const { ::send(socket_, bytes, size, 0); }

 private:
  int socket_;
  uint64_t sequence_ = 0, run_ = 0;
};

class ServeCommand : public CommandTest {
 protected:
  // Runs `photorque serve ARGUMENTS` on a free port with a client; what the client received.
  std::vector<photorque_measurement_packet> serve(const std::string& arguments,
                                                  const ClientLaw& law) {
    std::vector<photorque_measurement_packet> all;
    serve_to(arguments, [&](ServeClient& client) { all = client.follow(law); });
    return all;
  }
  // Serves a client with arbitrary actions.
  void serve_to(const std::string& arguments, const std::function<void(ServeClient&)>& act) {
    std::filesystem::remove(at("stdout"));
    std::thread server([&] { outcome_ = run("serve " + arguments + " --set serve.port=0"); });
    const int port = port_when_known();
    if (port > 0) {
      ServeClient client(port);
      act(client);
    }
    server.join();
    EXPECT_EQ(outcome_.status, 0) << outcome_.err;
  }
  // From the line "serving at 127.0.0.1:PORT, …".
  int port_when_known() const {
    for (int i = 0; i < 3000; ++i) {
      const std::string output = file_text(at("stdout"));
      const size_t found = output.find("127.0.0.1:");
      if (found != std::string::npos && output.find('\n', found) != std::string::npos) {
        return std::atoi(output.c_str() + found + 10);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return 0;
  }

  Outcome outcome_;
};

}  // namespace photorque
