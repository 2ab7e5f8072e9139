// Inputs from outside the equations of motion: commands that hold from their time to the next
// (zero-order hold), and inputs from coupled simulations (light, battery).
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/errors.h"
#include "core/transform.h"

namespace photorque {

// A torque that is known at some instants and interpolated or extrapolated by a polynomial: value +
// rate (t − from) + curvature (t − from)².
struct ContinuedTorque {
  double from_s = 0.0;
  Vec3 value_N_m = Vec3::Zero();
  Vec3 rate_N_m_s = Vec3::Zero();
  Vec3 curvature_N_m_s2 = Vec3::Zero();

  Vec3 at(double time_s) const {
    const double t = time_s - from_s;
    return value_N_m + t * (rate_N_m_s + t * curvature_N_m_s2);
  }
  bool operator==(const ContinuedTorque&) const = default;
};

// The measured speeds of wheels about the body's axes, linear between measurements.
struct WheelSpeeds {
  double from_s = 0.0;
  Vec3 speed_rad_s = Vec3::Zero();  // relative to the body
  Vec3 acceleration_rad_s2 = Vec3::Zero();

  Vec3 at(double time_s) const { return speed_rad_s + (time_s - from_s) * acceleration_rad_s2; }
  bool operator==(const WheelSpeeds&) const = default;
};

// Direction of slip of a platform that turns about one axis with dry friction. The propagator keeps
// it constant within a step and changes it between steps. by_rate: the direction follows the rate.
enum class Slip : int64_t { by_rate, backward, sticks, forward };

struct ZeroOrderHold {
  Vec3 command_body_N_m = Vec3::Zero();
  // Forces on a platform that slides; their sum acts.
  Vec3 force_lab_N = Vec3::Zero();
  Vec3 force_body_N = Vec3::Zero();
  double battery_current_A = 0.0;   // positive discharges
  double led_current_A = 0.0;       // current of lamps in the laboratory, if it is known
  double lamps_as_stated = 1.0;     // 1: current unknown, lamps as the model states; else 0
  ContinuedTorque light_body = {};  // torque of light that is traced during the run
  WheelSpeeds wheel = {};
  Slip slip = Slip::by_rate;

  bool commands_torque() const { return command_body_N_m != Vec3::Zero(); }
  bool commands_force() const {
    return force_lab_N != Vec3::Zero() || force_body_N != Vec3::Zero();
  }
  bool operator==(const ZeroOrderHold&) const = default;
};

// Commands in order of time. All are zero before the first. `time_s` is strictly increasing; `held`
// has the same length.
struct Schedule {
  std::vector<double> time_s;
  std::vector<ZeroOrderHold> held;
  // The battery current is the measured one, and no law of the model adds to it.
  bool current_is_measured = false;
  // Commanded torques and forces act later by this, ≥ 0.
  double command_delay_s = 0.0;

  // The commands that hold at `t_s`.
  ZeroOrderHold at(double t_s) const {
    ZeroOrderHold now = delayed_at(t_s, 0.0);
    if (command_delay_s > 0.0) {
      const ZeroOrderHold before = delayed_at(t_s, command_delay_s);
      now.command_body_N_m = before.command_body_N_m;
      now.force_lab_N = before.force_lab_N;
      now.force_body_N = before.force_body_N;
    }
    return now;
  }
  // The times at which at() jumps, in no order.
  std::vector<double> jumps_s() const {
    std::vector<double> all = time_s;
    if (command_delay_s > 0.0) {
      for (const double t_s : time_s) all.push_back(t_s + command_delay_s);
    }
    return all;
  }
  // Appends the commands unless they are equal to the last. NumericalError unless `t_s` is later
  // than all times before.
  void append(double t_s, const ZeroOrderHold& values) {
    if (!time_s.empty() && t_s <= time_s.back()) {
      throw NumericalError("a schedule must be written in order of time");
    }
    if (!held.empty() && held.back() == values) return;
    time_s.push_back(t_s);
    held.push_back(values);
  }

 private:
  // With the sums of jumps_s(), so that rounding takes no jump to the other side.
  ZeroOrderHold delayed_at(double t_s, double delay_s) const {
    const auto later =
        std::upper_bound(time_s.begin(), time_s.end(), t_s,
                         [=](double now_s, double from_s) { return now_s < from_s + delay_s; });
    if (later == time_s.begin()) return {};
    return held[static_cast<size_t>(later - time_s.begin()) - 1];
  }
};

}  // namespace photorque
