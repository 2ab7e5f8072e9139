// What an experiment says about a run in real time: the table [serve].
#pragma once

#include <string>

#include "core/settings/settings.h"
#include "tools/realtime/clock.h"
#include "tools/realtime/link.h"

namespace photorque {

struct ServeSettings {
  enum class Mode {
    paced,     // by the clock
    lockstep,  // every tick waits for the client's answer; no clock
  };
  Mode mode = Mode::paced;
  double rate_Hz = 160.0;
  std::string address = "127.0.0.1";
  int port = 0;
  bool wait_for_client = true;  // before the first tick
  double client_timeout_s = 60.0;
  double max_torque_N_m = 1.0;
  double hold_s = 0.0;  // after which a command that is not renewed ends; infinity: never
  double deadline_s = 0.0;
  OnMiss on_miss = OnMiss::catch_up;
  double spin_s = 50e-6;
  int realtime_priority = 0;
  bool send_truth = false;
  LinkSettings to_client, from_client;
};

// Reads [serve], which may be absent: mode ("paced", "lockstep"), rate_Hz (160), address ("127.0.0.1"),
// port (4160; 0: any), wait_for_client (true), client_timeout_s (60), max_torque_N_m (1), hold_s (none), deadline_s (a
// step), on_miss ("catch_up", "slip", "stop"), spin_s (50e-6), realtime_priority (0),
// send_truth (false), and the links [serve.to_client] and [serve.from_client].
ServeSettings read_serve(const Settings& root);

}  // namespace photorque
