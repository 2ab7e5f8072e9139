// Propagates a platform under its disturbances.
//
// Method: Gauss collocation (see collocation.h). The steps are as long as the tolerance allows and
// end exactly at every jump of a command or a law. Dense output is available within each step, and
// events are located on it. Derivatives are computed on request. After 1e5 s of a free asymmetric
// body the attitude error is below 1e-9 rad; energy and momentum are conserved to 1e-13
// (tests/attitude/propagator_test.cpp). Equal inputs give bitwise equal results.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "attitude/propagation/dry_contact.h"
#include "attitude/propagation/sensitivity.h"

namespace photorque {

class Snapshot;  // core/snapshot.h

struct PropagationOptions {
  // Bound on the estimated error of the polynomial within a step, relative to Dynamics::scales(): 1
  // rad, 1 rad/s. The dense output is about ten times more accurate. The states at the ends of
  // steps, whose errors accumulate, are more accurate by several orders of magnitude.
  double tolerance = 1e-8;
  double max_step_s = std::numeric_limits<double>::infinity();
  int64_t max_steps = 1'000'000'000;
  // Bound on the remaining iteration error of the derivatives, relative to the largest value of
  // each derivative within a step.
  double derivative_tolerance = 1e-16;
  // A step ends exactly at every tick, initial time + k/tick_rate_Hz. The next step starts without
  // the polynomial of the previous one, as after a change of the command. 0: no ticks.
  double tick_rate_Hz = 0.0;
};

// A function of time and state whose zeros are events. Two zeros that are less than an eighth of a
// step apart may both be missed.
struct EventFunction {
  std::string name;
  bool ends_run = false;
  bool rising_only = false;  // only zeros at which the value becomes positive
  std::function<Lanes(const Lanes& time_s, const Lanes* y)> value;
  std::string falling_name = {};  // where the value becomes negative; empty: `name`
};
struct Event {
  std::string name;
  double time_s = 0.0;
  bool rising = true;
};

// Event "tilt_stop", which ends the run: the tilt of body z from lab z reaches `limit_rad`.
EventFunction tilt_event(double limit_rad);
// Event "battery_empty": the charge drawn reaches `capacity_C`. The run continues without power.
EventFunction battery_empty_event(double capacity_C);
// Events "eclipse_begins" and "eclipse_ends": the illumination falls below or rises above one half.
// `dynamics` must outlive the function.
EventFunction eclipse_event(const Dynamics& dynamics);

class Propagator {
 public:
  // Propagates from `initial` to `end_s` ≥ initial.time_s. `dynamics` must outlive the propagator.
  // InputError when the initial quaternion is not of unit norm to 1e-6 or the number of extra
  // states differs from that of the model.
  Propagator(const Dynamics& dynamics, const PlatformState& initial, double end_s,
             const PropagationOptions& options = {}, std::vector<Variable> variables = {},
             std::vector<EventFunction> events = {});

  // Inputs from a simulation that is coupled to the motion (the power system). It sets them between
  // two steps. The values hold from the end of the last step on; the charge is the charge drawn
  // until then. A step ends exactly at the next exchange, `next_s`.
  struct Exchange {
    double battery_current_A = 0.0;
    ContinuedTorque light_body;
    double charge_drawn_C = 0.0;
    double next_s = std::numeric_limits<double>::infinity();
  };
  void exchange(const Exchange& now);

  // Returns the inputs that hold until the next tick; they replace the schedule of the model.
  // advance() calls it at every tick, the first at the initial time, with the state at the tick.
  using Commander = std::function<ZeroOrderHold(double time_s, std::span<const double> y)>;
  void follow_commander(Commander commander) { commander_ = std::move(commander); }

  // Computes the next step; false when the run has ended. NumericalError when the step length falls
  // below the resolution of the time, or when `max_steps` steps would not reach the end.
  bool advance();

  // End of the last step: the time of the event if an event ended the run. Before the first step:
  // the initial time.
  double step_end_s() const { return step_end_s_; }
  // Whether the last step ended the run.
  bool ended() const { return ended_by_event_ || step_end_s_ >= end_s_; }
  // Inputs that were held over the whole last step.
  const ZeroOrderHold& held() const { return held_; }
  // State at eight times within the last step.
  void dense(const Lanes& time_s, Lanes* y) const;
  // Derivatives of that state with respect to the variables: component c, variable v at
  // [c · variables + v].
  void dense_derivatives(const Lanes& time_s, Lanes* derivatives) const;

  const Dynamics& dynamics() const { return dynamics_; }
  const std::optional<Sensitivity>& sensitivity() const { return sensitivity_; }
  // Events so far, in order of time.
  const std::vector<Event>& events() const { return events_; }

  struct Statistics {
    int64_t steps = 0;
    int64_t rejected = 0;
    int64_t iterations = 0;
    int64_t stiff = 0;  // steps by Newton's method
  };
  const Statistics& statistics() const { return statistics_; }

  // Stores or restores the state after a step. Only for propagators without variables and
  // commander.
  void keep(Snapshot& snapshot);

 private:
  struct Jump {
    double time_s;
    int variable;  // index of the variable that is this time, −1 for none
    bool is_tick = false;
  };
  // The time at which a slip ends, as it is improved by repeating a step.
  struct SlipEndSearch {
    double latest_s = 0.0;  // end of the first attempted step
    int corrections = 0;
  };
  void collect_jumps(double from_s);
  void take_command(double now_s, bool is_tick);
  void check_pace() const;
  void take_step();
  double propose_length(const CollocationStep::Outcome& outcome, double h_s, bool cut) const;
  void choose_method(const CollocationStep::Outcome& outcome, bool was_at_ceiling);
  void cross_jumps();
  bool ends_slip(double& stop_s, SlipEndSearch& search);
  void cross_end_of_slip();
  void choose_slip(bool released);
  void take_over();
  void find_events();
  double locate(const EventFunction& event, double low_s, double high_s) const;
  Lanes fraction(const Lanes& time_s) const;

  const Dynamics& dynamics_;
  double begin_s_;
  double end_s_;
  PropagationOptions options_;
  CollocationStep step_;
  DryContact contact_;
  Slip slip_ = Slip::by_rate;
  bool slip_ends_ = false;  // the slip ends at the end of the last step
  std::optional<Sensitivity> sensitivity_;
  std::vector<EventFunction> event_functions_;
  std::vector<Event> events_;
  std::vector<double> event_values_;  // at the start of the step
  std::vector<Jump> jumps_;           // sorted by time
  size_t next_jump_ = 0;
  ZeroOrderHold held_;
  std::optional<Exchange> exchange_;
  bool exchange_is_new_ = false;
  Commander commander_;
  double h_s_ = 0.0;  // length to try next
  // Slightly below the last length that failed. It rises slowly, so that longer steps are tried
  // again.
  double ceiling_s_ = std::numeric_limits<double>::infinity();
  bool is_ceiling_of_state_ = false;  // the iteration for the state failed
  bool is_stiff_ = false;             // steps by Newton's method
  int slow_steps_ = 0;                // consecutive steps that convergence alone kept short
  double step_end_s_ = 0.0;
  bool has_step_ = false;
  bool ended_by_event_ = false;
  Statistics statistics_;
};

// States at given times, with derivatives if variables are given.
struct Trajectory {
  std::vector<PlatformState> states;  // as many as were reached before an event ended the run
  // Tangent component c (see tangent()) at time i, derivative with respect to variable v:
  // derivatives[(i · components + c) · variables + v].
  std::vector<double> derivatives;
  size_t components = 0;
  size_t variables = 0;
  std::vector<Event> events;
  Propagator::Statistics statistics;
};
// `times_s` [s] must be non-decreasing and not before initial.time_s. Errors: those of Propagator.
Trajectory propagate(const Dynamics& dynamics, const PlatformState& initial,
                     std::span<const double> times_s, const PropagationOptions& options = {},
                     const std::vector<Variable>& variables = {},
                     const std::vector<EventFunction>& events = {});

// Bound on the attitude error [rad] at `end_s` that a torque missing in `dynamics` causes. The
// torque is at most `torque_N_m`, in any direction and with any change in time. The bound is the
// torque times ∫ |∂attitude(end)/∂rate(s) I⁻¹| ds, from the exact derivatives along the trajectory
// at `intervals` equal intervals. It is of first order in the torque. Contact with the bearing's
// stop is not considered. NaN if the matrix of the derivatives is singular.
double attitude_error_bound_rad(const Dynamics& dynamics, const PlatformState& initial,
                                double end_s, double torque_N_m,
                                const PropagationOptions& options = {}, size_t intervals = 400);

}  // namespace photorque
