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

// State and readings at a tick, before the command of that tick. The readings are bitwise equal to
// the row of the recording with the same index (within 1e-13 for a camera with geometry). They are
// NaN where an instrument is absent or has no value in this row.
struct LiveRow {
  size_t index = 0;
  double time_s = 0.0;
  Quat lab_from_body_seen = Quat::Identity();  // by the camera, with its noise and latency
  Vec3 gyro_rad_s = Vec3::Zero();
  double yaw_rad = 0.0;  // reading of the encoder
  // Values of the interval that ends at this tick. A row of the recording has those of the interval
  // that starts there.
  double battery_current_A = 0.0;
  double array_power_W = 0.0;
  Vec3 command_body_N_m = Vec3::Zero();
  PlatformState truth;
};

// Returns the command until the next tick. It may take any time: the run waits for it.
using LiveCommander = std::function<ZeroOrderHold(const LiveRow& row)>;

// The truth of a row at `state`, with the values in lane `lane` of `now`, for instruments of which
// the camera sees the attitude `seen`.
Truth truth_at(const PlatformState& state, const Quat& seen, const Dynamics::Instants& now,
               int lane);

// A camera that reports at every tick the attitude of `delay_s` before. Before the start of the run
// the body rate is constant.
class LateCamera {
 public:
  LateCamera(const PlatformState& initial, double rate_Hz, double delay_s);

  double tick_s(size_t index) const;
  // Call after every integration step: stores the attitudes that the camera sees within it.
  void follow(const Propagator& motion);
  // The attitude that is reported at the next tick, at which the state is `now`.
  Quat seen(const PlatformState& now);

  void keep(Snapshot& snapshot);

 private:
  PlatformState initial_;
  double rate_Hz_, delay_s_;
  size_t next_look_ = 0;  // tick of the next image
  std::deque<Quat> on_the_way_;
};

// Reads the instruments at the ticks of a run in progress. `dynamics` must outlive it.
class LiveInstruments {
 public:
  LiveInstruments(const Dynamics& dynamics, LateCamera camera, const Sensors& sensors,
                  uint64_t seed)
      : dynamics_(dynamics), camera_(std::move(camera)), recorder_(sensors, seed) {}

  // Call after every integration step.
  void follow(const Propagator& motion) { camera_.follow(motion); }
  // Reads the instruments at the ticks, in order. `held` is the command before the tick. `power` is
  // the state of a power system that is simulated together with the motion.
  LiveRow read(double time_s, std::span<const double> y, const ZeroOrderHold& held,
               const std::optional<PowerState>& power);

 private:
  const Dynamics& dynamics_;
  LateCamera camera_;
  Recorder recorder_;
  size_t next_ = 0;  // next tick to be read
};

}  // namespace photorque
