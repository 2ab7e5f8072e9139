// A run that is observed and commanded while it proceeds: the readings at a tick, and the commands
// until the next.
#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <span>

#include "attitude/propagation/power_history.h"
#include "attitude/propagation/propagator.h"
#include "attitude/recordings/sensors.h"

namespace photorque {

// The state and readings at a tick, before its command. The readings are those of the recording's
// row of the same index, to the bit (of a camera with geometry to 1e-13); NaN where an instrument
// is absent or says nothing in this row.
struct LiveRow {
  size_t index = 0;
  double time_s = 0.0;
  Quat lab_from_body_seen = Quat::Identity();  // by the camera, with its noise and latency
  Vec3 gyro_rad_s = Vec3::Zero();
  double yaw_rad = 0.0;  // of the encoder
  // Values of the interval that ends at this tick. Rows of the recording have those of the next
  // one.
  double battery_current_A = 0.0;
  double array_power_W = 0.0;
  Vec3 command_body_N_m = Vec3::Zero();
  PlatformState truth;
};

// Decides the command until the next tick. It may wait as long as necessary: the run waits with it.
using LiveCommander = std::function<ZeroOrderHold(const LiveRow& row)>;

// The attitude so long before `state`, turning as it does there.
Quat attitude_before(const PlatformState& state, double before_s);

// The instruments at the ticks of a run that goes on. `dynamics` must outlive it.
class LiveInstruments {
 public:
  LiveInstruments(const Dynamics& dynamics, const PlatformState& initial, double rate_Hz,
                  double camera_delay_s, const Sensors& sensors, uint64_t seed);

  // After every step of the motion: the camera's readings within it.
  void follow(const Propagator& motion);
  // At the ticks, in order. `held` is what was commanded before; `power` is that of a power system
  // beside the motion.
  LiveRow read(double time_s, std::span<const double> y, const ZeroOrderHold& held,
               const std::optional<PowerState>& power);

 private:
  double tick_s(size_t index) const;
  Quat seen(const PlatformState& now);

  const Dynamics& dynamics_;
  PlatformState initial_;
  double rate_Hz_, delay_s_;
  Recorder recorder_;
  size_t next_ = 0;       // tick to be read
  size_t next_look_ = 0;  // tick whose look of the camera comes next
  std::deque<Quat> on_the_way_;
};

}  // namespace photorque
