// [serve].
#include "tools/keys/tables.h"
#include "tools/realtime/photorque_serve.h"
#include "tools/realtime/session.h"

namespace photorque {
namespace {

Key link_table(const std::string& name, const std::string& what) {
  const Range up_to_an_hour{0.0, 3600.0};
  return Key::table(
      name,
      {Key::number_or("delay_s", 0.0, up_to_an_hour, "the least that a packet takes"),
       Key::number_or("jitter_s", 0.0, up_to_an_hour, "beyond it, as `jitter` says"),
       Key::choice_or("jitter",
                      {{"exponential", "of this mean"},
                       {"uniform", "up to this"},
                       {"gaussian", "the absolute value of one of this scale"}},
                      0, "how the delay is spread"),
       Key::number_or("loss", 0.0, Range::fraction(), "fraction of packets, each by itself"),
       Key::number_or(
           "burst_begin", 0.0, Range::fraction(),
           "Gilbert and Elliott's two states: probability per packet that a burst begins"),
       Key::number_or("burst_end", 1.0, {0.0, 1.0, true, false}, "that it ends"),
       Key::number_or("burst_loss", 1.0, Range::fraction(), "that a packet is lost in it"),
       Key::flag_or("reorder", true, "packets may overtake each other"),
       Key::text("trace", "a CSV with `delay_s`, measured delays taken in turn instead (−1: lost)")
           .usually_is("none")},
      what);
}

}  // namespace

Key serve_table() {
  const ServeSettings usual;
  return Key::table(
      "serve",
      {Key::choice_or(
           "mode",
           {{"paced", "by the clock"}, {"lockstep", "every tick waits for the client's answer"}}, 0,
           "what the ticks follow"),
       Key::number_or("rate_Hz", usual.rate_Hz, {0.1, 1e5},
                      "ticks; also the rows of `recording.csv`"),
       Key::text_or("address", usual.address, "where UDP listens, IPv4"),
       Key::integer_or("port", PHOTORQUE_PORT, 0, 65535,
                       "of UDP; 0: any that is free, which the first line says"),
       Key::flag_or("wait_for_client", true, "before the first tick"),
       Key::number_or("client_timeout_s", usual.client_timeout_s, {1e-3, 1e6},
                      "for the first hello and, in lockstep, for every answer; then the run ends "
                      "with status 3"),
       Key::number_or("max_torque_N_m", usual.max_torque_N_m, Range::positive(),
                      "commands beyond are refused"),
       Key::number("hold_s", Range::positive(),
                   "a command that is not renewed for so long becomes zero")
           .usually_is("never"),
       Key::number("deadline_s", Range::positive(),
                   "a tick that is served later than this counts as missed")
           .usually_is("a step"),
       Key::choice_or("on_miss",
                      {{"catch_up", "the next ticks follow at once"},
                       {"slip", "the clock is set back"},
                       {"stop", "the run ends"}},
                      0, "what follows a missed tick"),
       Key::number_or("spin_s", usual.spin_s, {0.0, 1.0},
                      "before a tick it looks again and again instead of sleeping; costs processor "
                      "time, saves the time of waking up"),
       Key::integer_or("realtime_priority", 0, 0, 99,
                       "above 0: SCHED_FIFO and locked memory, where the system permits it"),
       Key::flag_or("send_truth", false, "the true attitude and rate in every measurement"),
       link_table("to_client", "a simulated link for measurements"),
       link_table("from_client", "a simulated link for commands")},
      "a run in real time");
}

}  // namespace photorque
