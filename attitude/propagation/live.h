// Interface of a run in real time: readings at each tick, commands until the next tick.
#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <span>

#include "attitude/propagation/power_history.h"
#include "attitude/propagation/propagator.h"
#include "attitude/recordings/sensors.h"

namespace photorque {

// The state and readings at a tick, before its command. The readings are bitwise those of the row
// of the recording with this index (for a camera with geometry, to 1e-13). They are NaN if an
// instrument is absent or has no reading in this row.
struct LiveRow {
  size_t index = 0;
  double time_s = 0.0;
  Quat lab_from_body_seen = Quat::Identity();  // by the camera, with its noise and latency
  Vec3 gyro_rad_s = Vec3::Zero();
  double yaw_rad = 0.0;  // of the encoder
  // Values of the interval that ends at this tick. The recording has those of the interval that
  // begins, which depend on the command.
  double battery_current_A = 0.0;
  double array_power_W = 0.0;
  Vec3 command_body_N_m = Vec3::Zero();
  PlatformState truth;
};

// Returns the command until the next tick. The run waits until it returns.
using LiveCommander = std::function<ZeroOrderHold(const LiveRow& row)>;

// The attitude `before_s` seconds before `state`, at the constant rate of `state`.
Quat attitude_before(const PlatformState& state, double before_s);

// The instruments of a run in progress. `dynamics` must outlive it.
class LiveInstruments {
 public:
  LiveInstruments(const Dynamics& dynamics, const PlatformState& initial, double rate_Hz,
                  double camera_delay_s, const Sensors& sensors, uint64_t seed);

  // Call after every integration step: stores the camera images taken within it.
  void follow(const Propagator& motion);
  // Returns the readings at the next tick. `held` is the command of the interval that ends, `power`
  // the state of a simulated power system, if there is one.
  LiveRow read(double time_s, std::span<const double> y, const ZeroOrderHold& held,
               const std::optional<PowerState>& power);

 private:
  double tick_s(size_t index) const;
  Quat seen(const PlatformState& now);

  const Dynamics& dynamics_;
  PlatformState initial_;
  double rate_Hz_, delay_s_;
  Recorder recorder_;
  size_t next_ = 0;       // next tick to be read
  size_t next_look_ = 0;  // tick of the next camera image
  std::deque<Quat> on_the_way_;
};

}  // namespace photorque
