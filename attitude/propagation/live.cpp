#include "attitude/propagation/live.h"

#include <array>
#include <vector>

#include "core/snapshot.h"

namespace photorque {

Truth truth_at(const PlatformState& state, const Quat& seen, const Dynamics::Instants& now,
               int lane) {
  return {.time_s = state.time_s,
          .lab_from_body_seen = seen,
          .rate_body_rad_s = state.rate_body_rad_s,
          .yaw_rad = yaw_rad(state),
          .gyro_rad_s = lane_of(now.gyro_rad_s, lane),
          .camera_error_rad = lane_of(now.camera_error_rad, lane),
          .command_body_N_m = lane_of(now.command_body_N_m, lane),
          .command_lab_N = lane_of(now.command_lab_N, lane),
          .battery_current_A = now.battery_current_A[lane],
          .array_power_W = now.array_power_W[lane]};
}

LateCamera::LateCamera(const PlatformState& initial, double rate_Hz, double delay_s)
    : initial_(to_state(initial.time_s, to_vector(initial))), rate_Hz_(rate_Hz), delay_s_(delay_s) {
  while (delay_s_ > 0.0 && tick_s(next_look_) - delay_s_ <= initial_.time_s) ++next_look_;
}

double LateCamera::tick_s(size_t index) const {
  return initial_.time_s + static_cast<double>(index) / rate_Hz_;
}

void LateCamera::follow(const Propagator& motion) {
  if (!(delay_s_ > 0.0)) return;
  std::vector<Lanes> y(static_cast<size_t>(motion.dynamics().size()));
  for (; tick_s(next_look_) - delay_s_ < motion.step_end_s(); ++next_look_) {
    const double look_s = tick_s(next_look_) - delay_s_;
    motion.dense(look_s, y.data());
    on_the_way_.push_back(to_state(look_s, lane_of(y, 0)).lab_from_body);
  }
}

Quat LateCamera::seen(const PlatformState& now) {
  if (!(delay_s_ > 0.0)) return now.lab_from_body;
  const double before_s = initial_.time_s - (now.time_s - delay_s_);
  if (before_s >= 0.0) {
    return initial_.lab_from_body * turn_by(-before_s * initial_.rate_body_rad_s);
  }
  const Quat first = on_the_way_.front();
  on_the_way_.pop_front();
  return first;
}

void LateCamera::keep(Snapshot& snapshot) {
  snapshot(next_look_);
  snapshot.each(on_the_way_, [&](Quat& seen) { snapshot(seen); });
}

LiveRow LiveInstruments::read(double time_s, std::span<const double> y, const ZeroOrderHold& held,
                              const std::optional<PowerState>& power) {
  const std::vector<Lanes> lanes(y.begin(), y.end());
  std::array<ZeroOrderHold, Lanes::count> each;
  each.fill(held);
  const Dynamics::Instants now = dynamics_.at(time_s, each, lanes.data());
  LiveRow row;
  row.index = next_++;
  row.time_s = time_s;
  row.truth = to_state(time_s, y);
  row.command_body_N_m = lane_of(now.command_body_N_m, 0);
  Truth truth = truth_at(row.truth, camera_.seen(row.truth), now, 0);
  if (power) {
    truth.battery_current_A = power->battery_current_A;
    truth.array_power_W = power->array_power_W;
  }
  recorder_.add(truth);
  const auto last = [&](const char* name) { return recorder_.last(name); };
  row.lab_from_body_seen = {last("q_w"), last("q_x"), last("q_y"), last("q_z")};
  row.gyro_rad_s = {last("gyro_x_rad_s"), last("gyro_y_rad_s"), last("gyro_z_rad_s")};
  row.yaw_rad = last("yaw_rad");
  row.battery_current_A = last("battery_current_A");
  row.array_power_W = last("array_power_W");
  return row;
}

}  // namespace photorque
