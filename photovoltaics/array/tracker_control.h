// Decisions of a maximum power point tracker, one per measurement.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/snapshot.h"
#include "photovoltaics/array/tracker.h"

namespace photorque {

// State of one tracker between decisions. `range_V` is the highest voltage that it may set.
class TrackerControl {
 public:
  TrackerControl(const Tracker& tracker, double range_V)
      : tracker_(tracker),
        range_V_(range_V),
        step_V_(tracker.step_fraction * range_V),
        voltage_V_(tracker.start_fraction * range_V) {
    const bool scans =
        tracker.kind == Tracker::Kind::global_scan || tracker.kind == Tracker::Kind::periodic_sweep;
    if (scans) begin_sweep();
  }

  double voltage_V() const { return voltage_V_; }

  // Processes the measurement at voltage_V() and sets the next voltage.
  void observe(const ArrayPoint& now) {
    since_sweep_s_ += tracker_.period_s;
    if (sweep_point_ > 0) {
      sweep(now);
    } else if (tracker_.kind == Tracker::Kind::periodic_sweep) {
      if (since_sweep_s_ >= tracker_.sweep_every_s) begin_sweep();
    } else if (tracker_.kind == Tracker::Kind::incremental_conductance) {
      incremental_conductance(now);
    } else {
      perturb(now);
    }
    last_ = now;
  }

  void keep(Snapshot& snapshot) {
    snapshot(voltage_V_, direction_, last_, best_, sweep_point_, settled_, recent_W_, reference_W_,
             since_sweep_s_);
  }

 private:
  void begin_sweep() {
    sweep_point_ = 1;
    best_ = {};
    voltage_V_ = range_V_ / (tracker_.sweep_points + 1);
  }

  void sweep(const ArrayPoint& now) {
    if (now.power_W() > best_.power_W()) best_ = now;
    if (++sweep_point_ > tracker_.sweep_points) {
      sweep_point_ = 0;
      since_sweep_s_ = 0.0;
      settled_ = 0;
      recent_W_ = {};
      voltage_V_ = best_.voltage_V > 0 ? best_.voltage_V : voltage_V_;
      return;
    }
    voltage_V_ = range_V_ * sweep_point_ / (tracker_.sweep_points + 1);
  }

  void perturb(const ArrayPoint& now) {
    const double change_W = now.power_W() - last_.power_W();
    if (tracker_.kind == Tracker::Kind::global_scan && light_changed(now.power_W())) {
      begin_sweep();
      return;
    }
    if (change_W < 0.0) direction_ = -direction_;
    // No current: beyond the open circuit, or in the dark. The search continues at lower voltages.
    if (now.current_A <= 0.0) direction_ = -1.0;
    move(direction_);
  }

  // Whether the light has changed since the last sweep. The largest of three successive powers is
  // that at the maximum, wherever the steps are relative to it. It is compared with its value just
  // after the last sweep.
  bool light_changed(double power_W) {
    recent_W_[settled_ % 3] = power_W;
    const double max_W = *std::ranges::max_element(recent_W_);
    if (++settled_ <= 3) {
      reference_W_ = max_W;
      return false;
    }
    return std::abs(max_W - reference_W_) > tracker_.rescan_fraction * reference_W_;
  }

  void incremental_conductance(const ArrayPoint& now) {
    const double dv = now.voltage_V - last_.voltage_V, di = now.current_A - last_.current_A;
    if (now.current_A <= 0.0) return move(-1.0);
    if (dv == 0.0) {
      if (di != 0.0) move(di > 0.0 ? 1.0 : -1.0);
      return;
    }
    const double slope = now.current_A + now.voltage_V * di / dv;  // dP/dV
    // Within half a step of the maximum dP/dV is below about I · step/V.
    if (std::abs(slope) < 0.5 * now.current_A * step_V_ / now.voltage_V) return;
    move(slope > 0.0 ? 1.0 : -1.0);
  }

  void move(double direction) {
    voltage_V_ = std::clamp(voltage_V_ + direction * step_V_, step_V_, range_V_);
  }

  Tracker tracker_;
  double range_V_, step_V_, voltage_V_;
  double direction_ = -1.0;
  ArrayPoint last_, best_;
  int sweep_point_ = 0;  // 0: not sweeping
  size_t settled_ = 0;   // decisions since the last sweep
  std::array<double, 3> recent_W_{};
  double reference_W_ = 0.0;
  double since_sweep_s_ = 0.0;
};

}  // namespace photorque
