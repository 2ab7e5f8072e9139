// Inputs and outputs of a co-simulation unit: names, units, positions.
#pragma once

#include <array>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "attitude/propagation/live.h"
#include "attitude/recordings/sensors.h"
#include "tools/runs/options.h"

namespace photorque {

struct UnitVariable {
  enum class Kind { time, input, output, flag };
  uint32_t reference = 0;  // value reference of the FMI standard
  std::string name;        // as the columns of recording.csv and time_history.csv
  Kind kind = Kind::output;
  std::string unit;  // as in modelDescription.xml; empty: a pure number
  std::string meaning;
};

// Value references; outputs follow in the order of UnitOutputs::values.
constexpr uint32_t time_reference = 0, first_input_reference = 1, first_output_reference = 10;

// All variables except those of instruments that the platform lacks.
std::vector<UnitVariable> unit_variables(const Sensors& sensors);

// Outputs at a tick. Readings with a lower rate than the ticks are held in between.
class UnitOutputs {
 public:
  static constexpr size_t numbers = 17, flags = 2;

  // Takes the outputs of a tick.
  void take(const LiveRow& row);
  // The output with this reference; null if there is none.
  const double* number(uint32_t reference) const;
  const bool* flag(uint32_t reference) const;

 private:
  std::array<double, numbers> numbers_{};
  std::array<bool, flags> flags_{};
};

// The platform as a co-simulation unit: a run of `propagate` that waits at every tick.

// Properties of an experiment as a unit.
struct UnitDescription {
  double rate_Hz = 0.0;  // ticks: [serve] rate_Hz
  double max_torque_N_m = 0.0;
  // [propagate] initial_time_s, and the end of the duration_s after it
  double start_s = 0.0, stop_s = 0.0;
  std::vector<UnitVariable> variables;
};
// Throws InputError for errors in the platform of the experiment.
UnitDescription describe_unit(const RunOptions& options);

// One run. The propagation runs in a separate thread, which waits for every command. The
// computation is the same as in `serve` in lockstep and in `propagate`: the effect of a command
// depends only on the ticks.
class CoSimulation {
 public:
  CoSimulation(RunOptions options, double rate_Hz);
  ~CoSimulation();
  CoSimulation(const CoSimulation&) = delete;
  CoSimulation& operator=(const CoSimulation&) = delete;

  // Begins at `start_s`; commands after `stop_s` are not possible. `commands` of an earlier run are
  // applied first, before the function returns. InputError and NumericalError of the run are thrown
  // here and by advance_to(), and end it.
  void begin(double start_s, double stop_s, std::vector<Vec3> commands = {});
  // Applies the command at all ticks before `time_s`, and advances to the last tick at or before
  // it.
  void advance_to(double time_s, const Vec3& command_body_N_m);

  const UnitOutputs& outputs() const { return outputs_; }
  // Time of the last tick, or of the end of the run if this is earlier (tilt limit).
  double tick_s() const { return tick_s_; }
  // Whether the platform has reached its stop.
  bool ended() const { return ended_; }
  // Commands of all ticks so far.
  const std::vector<Vec3>& commands() const { return commands_; }
  // Messages of the run since the last call, one per line.
  std::vector<std::string> take_messages();

 private:
  enum class Turn { run, importer };
  void run(double start_s, double stop_s);
  ZeroOrderHold at_tick(const LiveRow& row);
  void await_tick();
  void abandon();

  RunOptions options_;
  double rate_Hz_, start_s_ = 0.0;
  std::thread thread_;
  std::mutex mutex_;
  std::condition_variable changed_;
  // The members below may be accessed only by the thread whose turn it is.
  Turn turn_ = Turn::importer;
  bool abandoned_ = false, ended_ = false;
  std::exception_ptr failure_;
  UnitOutputs outputs_;
  double tick_s_ = 0.0;
  size_t given_ = 0;  // number of commands known in advance
  std::vector<Vec3> commands_;
  std::vector<std::string> words_;
};

}  // namespace photorque
