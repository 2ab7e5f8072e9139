#include "tools/fmi/unit.h"

#include <cmath>
#include <exception>
#include <utility>

#include "core/errors.h"
#include "tools/coupling/propagate.h"
#include "tools/realtime/session.h"
#include "tools/runs/attitude_run.h"

namespace photorque {

namespace {

constexpr uint32_t first_flag_reference =
    first_output_reference + static_cast<uint32_t>(UnitOutputs::numbers);

// Index of the first number of each quantity.
enum Place : uint32_t {
  place_attitude = 0,
  place_gyro = 4,
  place_yaw = 7,
  place_current = 8,
  place_power = 9,
  place_true_attitude = 10,
  place_true_rate = 14,
};

}  // namespace

std::vector<UnitVariable> unit_variables(const Sensors& sensors) {
  using Kind = UnitVariable::Kind;
  std::vector<UnitVariable> all = {{time_reference, "time", Kind::time, "s", "of the simulation"}};
  const auto add = [&](uint32_t place, const std::string& name, const std::string& unit,
                       const std::string& meaning) {
    all.push_back({first_output_reference + place, name, Kind::output, unit, meaning});
  };
  const std::string axes = "xyz", parts = "wxyz";
  for (uint32_t i = 0; i < 3; ++i) {
    all.push_back({first_input_reference + i, std::string("command_") + axes[i] + "_N_m",
                   Kind::input, "N.m", "commanded torque about a body axis, held between ticks"});
  }
  if (sensors.camera) {
    for (uint32_t i = 0; i < 4; ++i) {
      add(place_attitude + i, std::string("q_") + parts[i], "",
          "attitude by the camera: turns body vectors into the lab");
    }
    all.push_back({first_flag_reference, "camera_is_new", Kind::flag, "",
                   "the camera has read at this tick; else its last reading is held"});
  }
  if (sensors.gyro) {
    for (uint32_t i = 0; i < 3; ++i) {
      add(place_gyro + i, std::string("gyro_") + axes[i] + "_rad_s", "rad/s",
          "rate by the gyro, body axes");
    }
    all.push_back({first_flag_reference + 1, "gyro_is_new", Kind::flag, "",
                   "the gyro has read at this tick; else its last reading is held"});
  }
  if (sensors.encoder) add(place_yaw, "yaw_rad", "rad", "azimuth of body x by the encoder");
  add(place_current, "battery_current_A", "A", "drawn from the battery until this tick");
  add(place_power, "array_power_W", "W", "of the solar array until this tick");
  for (uint32_t i = 0; i < 4; ++i) {
    add(place_true_attitude + i, std::string("true_q_") + parts[i], "",
        "the true attitude: turns body vectors into the lab");
  }
  for (uint32_t i = 0; i < 3; ++i) {
    add(place_true_rate + i, std::string("true_rate_") + axes[i] + "_rad_s", "rad/s",
        "the true rate, body axes");
  }
  return all;
}

void UnitOutputs::take(const LiveRow& row) {
  const auto put = [&](size_t place, double value) { numbers_[place] = value; };
  const auto put_attitude = [&](size_t place, const Quat& q) {
    put(place, q.w()), put(place + 1, q.x()), put(place + 2, q.y()), put(place + 3, q.z());
  };
  const auto put_vector = [&](size_t place, const Vec3& v) {
    for (int i = 0; i < 3; ++i) put(place + static_cast<size_t>(i), v[i]);
  };
  flags_[0] = std::isfinite(row.lab_from_body_seen.w());
  flags_[1] = std::isfinite(row.gyro_rad_s.x());
  if (flags_[0]) put_attitude(place_attitude, row.lab_from_body_seen);
  if (flags_[1]) put_vector(place_gyro, row.gyro_rad_s);
  if (std::isfinite(row.yaw_rad)) put(place_yaw, row.yaw_rad);
  put(place_current, std::isfinite(row.battery_current_A) ? row.battery_current_A : 0.0);
  put(place_power, std::isfinite(row.array_power_W) ? row.array_power_W : 0.0);
  put_attitude(place_true_attitude, row.truth.lab_from_body);
  put_vector(place_true_rate, row.truth.rate_body_rad_s);
}

const double* UnitOutputs::number(uint32_t reference) const {
  const uint32_t place = reference - first_output_reference;
  return place < numbers ? &numbers_[place] : nullptr;
}

const bool* UnitOutputs::flag(uint32_t reference) const {
  const uint32_t place = reference - first_flag_reference;
  return place < flags ? &flags_[place] : nullptr;
}

namespace {

// Tolerance as a fraction of a tick, because sums of communication steps are not exact.
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

// Runs in the separate thread.
void CoSimulation::run(double start_s, double stop_s) {
  try {
    const auto prepare = [&](const Settings&, PropagationRun& propagation) {
      propagation.output_rate_Hz = propagation.options.tick_rate_Hz = rate_Hz_;
      propagation.model.schedule = {};
      propagation.initial.time_s = start_s;
      // One tick more than required, so that the last instant is a tick, too.
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

// Called in the separate thread: returns the commands from this tick on.
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

std::vector<std::string> CoSimulation::take_messages() {
  return std::exchange(words_, {});
}

}  // namespace photorque
