#include "tools/fmi/unit.h"

#include <exception>
#include <utility>

#include "core/errors.h"
#include "tools/coupling/propagate.h"
#include "tools/realtime/settings.h"
#include "tools/runs/attitude_run.h"

namespace photorque {
namespace {

// Of a tick: sums of communication steps are not exact.
constexpr double same_tick = 1e-6;

}  // namespace

UnitDescription describe_unit(const RunOptions& options) {
  UnitDescription unit;
  const AttitudeExperiment experiment(options);
  const PropagationRun run = read_propagation(experiment.settings());
  const ServeSettings serve = read_serve(experiment.settings());
  unit.rate_Hz = serve.rate_Hz;
  unit.max_torque_N_m = serve.max_torque_N_m;
  unit.start_s = run.initial.time_s;
  unit.stop_s = run.initial.time_s + run.duration_s;
  unit.variables = unit_variables(run.sensors);
  return unit;
}

CoSimulation::CoSimulation(RunOptions options, double rate_Hz)
    : options_(std::move(options)), rate_Hz_(rate_Hz) {}

CoSimulation::~CoSimulation() {
  abandon();
}

void CoSimulation::abandon() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    abandoned_ = true;
    turn_ = Turn::run;
  }
  changed_.notify_all();
  thread_.join();
}

void CoSimulation::begin(double start_s, double stop_s, std::vector<Vec3> commands) {
  abandon();
  constexpr double most_ticks = 2e7;
  if (!((stop_s - start_s) * rate_Hz_ < most_ticks)) {
    throw InputError({}, "stopTime", std::to_string(stop_s),
                     "at most 20 million ticks after the start");
  }
  abandoned_ = ended_ = false;
  failure_ = nullptr;
  outputs_ = {};
  start_s_ = tick_s_ = start_s;
  commands_ = std::move(commands);
  given_ = commands_.size();
  turn_ = Turn::run;
  thread_ = std::thread([this, start_s, stop_s] { run(start_s, stop_s); });
  await_tick();
}

// In the thread.
void CoSimulation::run(double start_s, double stop_s) {
  try {
    const auto prepare = [&](const Settings&, PropagationRun& propagation) {
      propagation.output_rate_Hz = propagation.options.tick_rate_Hz = rate_Hz_;
      propagation.model.schedule = {};
      propagation.initial.time_s = start_s;
      // One tick more than is asked for, so that the last is a tick as well.
      propagation.duration_s = std::max(0.0, stop_s - start_s) + 1.5 / rate_Hz_;
      propagation.history_rows = 2;
      propagation.commander = [this](const LiveRow& row) { return at_tick(row); };
    };
    ConsoleSinks sinks;
    sinks.line = [this](const std::string& line) { words_.push_back(line); };
    const MotionRun motion = run_propagate(options_, Console(sinks), {}, prepare);
    const PropagationResult& result = motion.coupled->motion;
    if (!result.events.empty()) tick_s_ = result.events.back().time_s;
  } catch (...) {
    failure_ = std::current_exception();
  }
  const std::lock_guard lock(mutex_);
  ended_ = true;
  turn_ = Turn::importer;
  changed_.notify_all();
}

// In the thread: what holds from this tick on.
ZeroOrderHold CoSimulation::at_tick(const LiveRow& row) {
  outputs_.take(row);
  tick_s_ = row.time_s;
  ZeroOrderHold held;
  if (row.index >= given_) {
    std::unique_lock lock(mutex_);
    turn_ = Turn::importer;
    changed_.notify_all();
    changed_.wait(lock, [&] { return turn_ == Turn::run; });
    if (abandoned_) throw NumericalError("the run was ended");
  }
  held.command_body_N_m = commands_[row.index];
  return held;
}

void CoSimulation::await_tick() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return turn_ == Turn::importer; });
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void CoSimulation::advance_to(double time_s, const Vec3& command_body_N_m) {
  const auto next_s = [&] {
    return start_s_ + static_cast<double>(commands_.size() + 1) / rate_Hz_;
  };
  while (!ended_ && next_s() <= time_s + same_tick / rate_Hz_) {
    commands_.push_back(command_body_N_m);
    {
      const std::lock_guard lock(mutex_);
      turn_ = Turn::run;
    }
    changed_.notify_all();
    await_tick();
  }
}

std::vector<std::string> CoSimulation::take_words() {
  return std::exchange(words_, {});
}

}  // namespace photorque
