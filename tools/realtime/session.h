// A run in real time with its client: the table [serve] and the session.
#pragma once

#include <functional>
#include <string>

#include "attitude/propagation/live.h"
#include "core/product.h"
#include "core/settings/typed_keys.h"
#include "tools/realtime/clock.h"
#include "tools/realtime/gate.h"
#include "tools/realtime/link.h"
#include "tools/realtime/udp.h"

namespace photorque {

// Settings of a run in real time: the table [serve].

struct ServeSettings {
  enum class Mode {
    paced,     // by the clock
    lockstep,  // every tick waits for the client's answer; no clock
  };
  Mode mode = Mode::paced;
  double rate_Hz = 0.0;
  std::string address;
  int port = 0;
  bool wait_for_client = true;  // wait for a client before the first tick
  double client_timeout_s = 0.0;
  double silence_s = 0.0;  // paced: silence after which the client's torque ends
  double max_torque_N_m = 0.0;
  double hold_s = 0.0;  // time after which a command ends unless it is renewed; infinity: never
  double deadline_s = 0.0;
  OnMiss on_miss = OnMiss::catch_up;
  double spin_s = 0.0;
  int realtime_priority = 0;
  bool send_truth = false;
  LinkSettings to_client, from_client;
};

// Reads [serve], which may be absent, with [serve.to_client] and [serve.from_client].
ServeSettings read_serve(const Settings& root);
Key serve_table();

// A run in real time with its client: at every tick it sends a measurement and receives commands.
class Session {
 public:
  // `seed` is that of the simulated links, `start_s` the run's initial time. `report` receives one
  // line per event (a session begins, its client becomes silent or leaves).
  Session(const ServeSettings& settings, UdpSocket socket, uint64_t seed, double start_s,
          std::function<void(const std::string&)> report);

  // The run's LiveCommander. At tick k it
  //   paced: waits until start + k steps and receives packets meanwhile; sends the measurement;
  //   lockstep: sends the measurement and waits for its answer;
  // then returns the newest command that has passed the link. Throws NumericalError if a client
  // does not connect or answer within client_timeout_s, or if OnMiss::stop ends the run.
  ZeroOrderHold tick(const LiveRow& row);

  // Sends the end of the run to the client.
  void finish();

  // Commands as applied; with them `propagate` can repeat the run.
  const Schedule& commands() const { return acted_; }
  double last_tick_s() const { return start_s_ + tick_s_; }
  // Deadlines, packets and rejections.
  Product product() const;

 private:
  bool is_paced() const { return settings_.mode == ServeSettings::Mode::paced; }
  double now_s() const;
  void await_client();
  void wait_until_due(size_t tick);
  void send_arrived(double now_s, bool is_late);
  void send(const photorque_measurement_packet& packet, uint32_t flags);
  void await_answer();
  bool take_in(int64_t until_ns);
  void end_command();
  void note(const std::string& event);
  void end_after_silence();
  void command(double now_s);
  photorque_measurement_packet packet_of(const LiveRow& row) const;

  ServeSettings settings_;
  UdpSocket socket_;
  double start_s_;
  uint64_t run_;
  Gate gate_;
  TickClock clock_;
  SimulatedLink<photorque_measurement_packet> to_client_;
  SimulatedLink<photorque_command_packet> from_client_;
  photorque_measurement_packet last_sent_{};
  photorque_command_packet acting_{};  // sequence 0: no command
  double acting_since_s_ = 0.0;
  uint64_t tick_ = 0;
  double tick_s_ = 0.0;  // time of the run since its start
  int64_t returned_ns_ = 0;
  bool client_left_ = false, answered_ = false, fell_silent_ = false;
  size_t packets_of_tick_ = 0;
  std::function<void(const std::string&)> report_;
  Table events_;
  uint64_t sessions_ = 0, silences_ = 0, full_ticks_ = 0;
  uint64_t sequence_ = 0, sent_ = 0, received_ = 0, overtaken_ = 0, unanswered_ = 0;
  Schedule acted_;
};

}  // namespace photorque
