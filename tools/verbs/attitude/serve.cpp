// photorque serve: the platform in real time, connected to hardware and programs.
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>

#include <memory>
#include <utility>

#include "tools/coupling/propagate.h"
#include "tools/realtime/session.h"
#include "tools/runs/optical_run.h"
#include "tools/verbs/verb.h"

namespace photorque::verbs::serve {
namespace {

constexpr double s_to_ns = 1e9;

// Sets a real-time priority and locks the memory, so that it is never paged out.
void take_priority(const Console& console, int priority) {
  // Otherwise the system may wake ordinary threads 50 microseconds late to save power.
  ::prctl(PR_SET_TIMERSLACK, 1UL);
  if (priority == 0) return;
  sched_param wanted{};
  wanted.sched_priority = priority;
  const bool first = ::sched_setscheduler(0, SCHED_FIFO, &wanted) == 0;
  const bool stays = ::mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
  if (first && stays) return;
  console.line(std::string("  without ") + (first ? "" : "real-time priority ") +
               (stays ? "" : "locked memory ") + "(not permitted: ulimit -r, ulimit -l)");
}

void print_serving(const Console& console, const ServeSettings& serve, const std::string& where) {
  const bool lockstep = serve.mode == ServeSettings::Mode::lockstep;
  console.line("serving at " + where + ", " + show(serve.rate_Hz) + " Hz" +
               (lockstep ? ", in lockstep" : ""));
  if (!serve.address.starts_with("127.")) {
    console.line(
        "  every computer that reaches this address can command the platform: packets are not "
        "authenticated");
  }
}

void print_session(const Console& console, const Product& product) {
  console.heading("Real time");
  for (const Quantity& quantity : product.quantities) {
    if (quantity.estimate.value == 0.0 && quantity.name != "ticks_missed") continue;
    console.line("  " + padded(quantity.name, 28) + show(quantity.estimate.value));
  }
}

// The applied commands as a recording for propagate.commands.
Recording commands_recording(Schedule commands, double last_tick_s) {
  // The last command continues to act. A recording needs at least two rows.
  if (commands.time_s.size() == 1 && last_tick_s > commands.time_s.back()) {
    commands.time_s.push_back(last_tick_s);
    commands.held.push_back(commands.held.back());
  }
  Recording recording;
  recording.time_s = commands.time_s;
  for (int axis = 0; axis < 3; ++axis) {
    Channel channel{std::string("command_") + "xyz"[axis] + "_N_m", {}};
    for (const ZeroOrderHold& held : commands.held) {
      channel.values.push_back(held.command_body_N_m[axis]);
    }
    recording.channels.push_back(std::move(channel));
  }
  return recording;
}

// Propagates the experiment tick by tick with a client ([serve]); prints the address before it
// waits. The result contains that of `propagate`, `commands.csv` and, for a paced run, the
// statistics of its deadlines.
RunResult serve_experiment(const RunOptions& options, const Console& console) {
  ServeSettings serve;
  std::shared_ptr<Session> session;
  const auto prepare = [&](const Settings& root, PropagationRun& run) {
    serve = read_serve(root);
    UdpSocket socket(serve.address, serve.port, static_cast<int64_t>(s_to_ns * serve.spin_s));
    print_serving(console, serve, socket.where());
    run.output_rate_Hz = run.options.tick_rate_Hz = serve.rate_Hz;
    run.model.schedule = {};
    session = std::make_shared<Session>(serve, std::move(socket), run.seed, run.initial.time_s,
                                        [console](const std::string& line) { console.line(line); });
    run.commander = [session](const LiveRow& row) { return session->tick(row); };
    take_priority(console, serve.realtime_priority);
  };
  RunResult result = run_propagate(options, console, {}, prepare).result;
  session->finish();
  const Product beside = session->product();
  print_session(console, beside);
  append(result.product, beside);
  const std::string stamp = result.provenance.one_line();
  const auto write = [session, stamp](const std::filesystem::path& path) {
    write_recording(path, commands_recording(session->commands(), session->last_tick_s()), {stamp});
  };
  result.files.push_back({"commands.csv", write, "applied commands, for propagate.commands"});
  return result;
}

}  // namespace

Verb kind() {
  return {
      "serve",
      "Simulation of the platform in real time: sends measurements and receives commands over UDP",
      command_that_writes(experiment_options, serve_experiment),
      {"platform", "environment", "disturbance", "sensors", "propagate", "serve", "light", "array"},
      "[platform]"};
}

}  // namespace photorque::verbs::serve
