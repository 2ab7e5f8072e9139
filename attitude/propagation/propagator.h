// Propagates a platform under its disturbances.
//
// Gauss collocation (see collocation.h) with steps as long as the tolerance allows, ending exactly
// at every jump of a command or a law; dense output, events found on it, and derivatives on
// request. On a free asymmetric body after 1e5 s the attitude is right to better than 1e-9 rad,
// energy and momentum to 1e-13 (tests/attitude/propagator_test.cpp; attitude_benchmark compares
// methods). The same inputs give the same bits.
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
  // rad, 1 rad/s. The dense output is some ten times better, and the ends of steps, whose errors
  // are the ones that add up, better by many powers of ten.
  double tolerance = 1e-8;
  double max_step_s = std::numeric_limits<double>::infinity();
  int64_t max_steps = 1'000'000'000;
  // Bound on the error that the iteration for the derivatives leaves, relative to the largest size
  // of each derivative within a step.
  double derivative_tolerance = 1e-16;
  // Ticks: a step ends exactly at every initial time + k/tick_rate_Hz and the next begins afresh,
  // as at a command that changes. 0: none.
  double tick_rate_Hz = 0.0;
};

// A quantity whose zeros are looked for. Crossings closer together than an eighth of a step may be
// missed in pairs.
struct EventFunction {
  std::string name;
  bool ends_run = false;
  bool rising_only = false;  // only where the value becomes positive
  std::function<Lanes(const Lanes& time_s, const Lanes* y)> value;
  std::string falling_name = {};  // where it becomes negative; empty: the same
};
struct Event {
  std::string name;
  double time_s = 0.0;
  bool rising = true;
};

// The tilt of body z from lab z reaches `limit_rad`.
EventFunction tilt_event(double limit_rad);
// The charge drawn reaches `capacity_C`.
EventFunction battery_empty_event(double capacity_C);
// "eclipse_begins" and "eclipse_ends": half of the light arrives.
EventFunction eclipse_event(const Dynamics& dynamics);

class Propagator {
 public:
  // From `initial` to `end_s` ≥ initial.time_s. `dynamics` must outlive the propagator.
  // InputError when the initial quaternion is not of unit norm to 1e-6 or the number of extra
  // states is not the model's.
  Propagator(const Dynamics& dynamics, const PlatformState& initial, double end_s,
             const PropagationOptions& options = {}, std::vector<Variable> variables = {},
             std::vector<EventFunction> events = {});

  // Between two steps a simulation beside the motion (the power system) states what holds from the
  // end of the last step on, the charge drawn until then included, and the time of its next
  // exchange, at which a step then ends exactly.
  struct Exchange {
    double battery_current_A = 0.0;
    ContinuedTorque light_body;
    double charge_drawn_C = 0.0;
    double next_s = std::numeric_limits<double>::infinity();
  };
  void exchange(const Exchange& now);

  // Who says at every tick, the first at the initial time, what holds until the next; the model's
  // schedule is not asked then. Called by advance() with the state at the tick.
  using Commander = std::function<ZeroOrderHold(double time_s, std::span<const double> y)>;
  void follow_commander(Commander commander) { commander_ = std::move(commander); }

  // Computes the next step; false when the run has ended. NumericalError when the step length falls
  // below what the time can resolve, or below what reaches the end in `max_steps`.
  bool advance();

  // The last step; its end is the event's time when one ended the run. ZeroOrderHold values are
  // those of its whole length. Before the first step: the initial time.
  double step_end_s() const { return step_end_s_; }
  // Whether that is the end of the run.
  bool ended() const { return ended_by_event_ || step_end_s_ >= end_s_; }
  const ZeroOrderHold& held() const { return held_; }
  // State at eight times within the last step.
  void dense(const Lanes& time_s, Lanes* y) const;
  // Its derivatives by the variables: component c by variable v at [c · variables + v].
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

  // After a step, of a propagator without variables and commander.
  void keep(Snapshot& snapshot);

 private:
  struct Jump {
    double time_s;
    int variable;  // whose parameter this time is, −1 for none
    bool is_tick = false;
  };
  void collect_jumps(double from_s);
  void take_command(double now_s, bool is_tick);
  void check_pace() const;
  void take_step();
  double propose_length(const CollocationStep::Outcome& outcome, double h_s, bool cut) const;
  void choose_method(const CollocationStep::Outcome& outcome, bool was_at_ceiling);
  void cross_jumps();
  bool ends_slip(double& stop_s, int& corrections);
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
  bool slip_ends_ = false;  // at the end of the last step
  std::optional<Sensitivity> sensitivity_;
  std::vector<EventFunction> event_functions_;
  std::vector<Event> events_;
  std::vector<double> event_values_;  // at the start of the step
  std::vector<Jump> jumps_;           // by time
  size_t next_jump_ = 0;
  ZeroOrderHold held_;
  std::optional<Exchange> exchange_;
  bool exchange_is_new_ = false;
  Commander commander_;
  double h_s_ = 0.0;  // length to try next
  // Just below the last length that failed; rises slowly, so that it is tried again some day.
  double ceiling_s_ = std::numeric_limits<double>::infinity();
  bool is_ceiling_of_state_ = false;  // the state's own iteration had failed
  bool is_stiff_ = false;             // steps by Newton's method
  int slow_steps_ = 0;                // steps in a row that convergence alone kept short
  double step_end_s_ = 0.0;
  bool has_step_ = false;
  bool ended_by_event_ = false;
  Statistics statistics_;
};

// States at given times, with derivatives if variables are given.
struct Trajectory {
  std::vector<PlatformState> states;  // as many as were reached before an event ended the run
  // By variable v of tangent component c (see tangent()) at time i:
  // derivatives[(i · components + c) · variables + v].
  std::vector<double> derivatives;
  size_t components = 0;
  size_t variables = 0;
  std::vector<Event> events;
  Propagator::Statistics statistics;
};
// `times_s` must not fall and not begin before initial.time_s.
Trajectory propagate(const Dynamics& dynamics, const PlatformState& initial,
                     std::span<const double> times_s, const PropagationOptions& options = {},
                     const std::vector<Variable>& variables = {},
                     const std::vector<EventFunction>& events = {});

// Bound of the attitude's error [rad] at `end_s` when a torque of at most `torque_N_m` in any
// direction, changing with time as it likes, acts besides what `dynamics` knows: ∫
// |∂attitude(end)/∂rate(s) I⁻¹| ds times the torque, by the exact derivatives along the trajectory,
// at `intervals` even steps. To first order in the torque. Nothing that happens at the bearing's
// stop is known to it. NaN where the derivatives say nothing.
double attitude_error_bound_rad(const Dynamics& dynamics, const PlatformState& initial,
                                double end_s, double torque_N_m,
                                const PropagationOptions& options = {}, size_t intervals = 400);

}  // namespace photorque
