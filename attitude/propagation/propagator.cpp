#include "attitude/propagation/propagator.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "attitude/propagation/sampling.h"
#include "core/errors.h"
#include "core/numerics/table.h"
#include "core/snapshot.h"
#include "core/text/format.h"

namespace photorque {
namespace {

// `h` truncated to 12 significant bits, so that sums of equal steps are exact. Rounding errors of
// the time would otherwise add up to a phase error after 1e5 s.
double with_few_bits(double h) {
  int exponent = 0;
  const double mantissa = std::frexp(h, &exponent);
  return std::ldexp(std::floor(std::ldexp(mantissa, 12)), exponent - 12);
}

std::vector<double> checked_start(const Dynamics& dynamics, const PlatformState& initial) {
  const double norm = initial.lab_from_body.norm();
  if (!(std::abs(norm - 1.0) <= 1e-6)) {
    throw InputError({}, "initial attitude", "a quaternion of norm " + std::to_string(norm),
                     "a quaternion of unit norm");
  }
  if (initial.extra.size() + component::extra != static_cast<size_t>(dynamics.size())) {
    throw InputError({}, "initial state", std::to_string(initial.extra.size()) + " extra states",
                     std::to_string(dynamics.size() - component::extra) + ", as the model has");
  }
  PlatformState unit = initial;
  unit.lab_from_body.normalize();
  return to_vector(unit);
}

}  // namespace

EventFunction tilt_event(double limit_rad) {
  const double limit_cosine = std::cos(limit_rad);
  return {"tilt_stop", true, true, [limit_cosine](const Lanes&, const Lanes* y) {
            return limit_cosine - 1.0 + 2.0 * (y[1] * y[1] + y[2] * y[2]);
          }};
}

EventFunction battery_empty_event(double capacity_C) {
  return {"battery_empty", false, true,
          [capacity_C](const Lanes&, const Lanes* y) { return y[component::charge] - capacity_C; }};
}

EventFunction eclipse_event(const Dynamics& dynamics) {
  return {.name = "eclipse_ends",
          .value = [&dynamics](
                       const Lanes& time_s,
                       const Lanes* y) { return dynamics.at(time_s, {}, y).illumination - 0.5; },
          .falling_name = "eclipse_begins"};
}

namespace {

// Kinds whose torque is not finite in this state, as text in brackets; empty if all are finite.
std::string infinite_torques(const Dynamics& dynamics, double time_s, std::span<const double> y) {
  const AttitudeModel& model = dynamics.model();
  const std::vector<Vec3> torques = disturbance_torques_body_N_m(model, to_state(time_s, y));
  std::string names;
  for (size_t d = 0; d < torques.size(); ++d) {
    if (torques[d].allFinite()) continue;
    names += (names.empty() ? "" : ", ") + model.disturbances[d].kind;
  }
  return names.empty() ? "" : " (no finite torque of " + names + ")";
}

// Attempts a step. A stage outside a table counts as a failure: a shorter step stays inside, and an
// event may end the run before the edge. If no event does, the error is passed on once the steps
// are shorter than 1e-9 of the time.
CollocationStep::Outcome attempt(CollocationStep& step, bool is_stiff, double h_s,
                                 const ZeroOrderHold& held, double settled) {
  try {
    return is_stiff ? step.attempt_stiff(h_s, held, settled) : step.attempt(h_s, held, settled);
  } catch (const BeyondTable&) {
    const double start_s = step.start_s();
    if (start_s + 1e-9 * (1.0 + std::abs(start_s)) >= start_s + h_s) throw;
    return {};
  }
}

}  // namespace

Propagator::Propagator(const Dynamics& dynamics, const PlatformState& initial, double end_s,
                       const PropagationOptions& options, std::vector<Variable> variables,
                       std::vector<EventFunction> events)
    : dynamics_(dynamics),
      begin_s_(initial.time_s),
      end_s_(end_s),
      options_(options),
      step_(dynamics, initial.time_s, checked_start(dynamics, initial)),
      contact_(dynamics),
      event_functions_(std::move(events)),
      held_(dynamics.model().schedule.at(initial.time_s)),
      step_end_s_(initial.time_s) {
  if (!variables.empty()) sensitivity_.emplace(dynamics, std::move(variables), step_.start());
  collect_jumps(initial.time_s);
  const std::vector<Lanes> start(step_.start().begin(), step_.start().end());
  for (const EventFunction& event : event_functions_) {
    event_values_.push_back(event.value(initial.time_s, start.data())[0]);
  }
  // A first guess, which the error control corrects.
  h_s_ = std::min(0.1, options.max_step_s);
}

void Propagator::collect_jumps(double from_s) {
  const AttitudeModel& model = dynamics_.model();
  for (const double t_s : model.schedule.jumps_s()) {
    if (t_s > from_s && t_s < end_s_) jumps_.push_back({t_s, -1});
  }
  for (size_t d = 0; d < model.disturbances.size(); ++d) {
    const Disturbance& disturbance = model.disturbances[d];
    for (const Switch& s : disturbance.law->switches(disturbance.parameters)) {
      if (!(s.time_s > from_s && s.time_s < end_s_)) continue;
      int variable = -1;
      if (sensitivity_ && s.parameter >= 0) {
        const std::vector<Variable>& all = sensitivity_->variables();
        const auto at = std::ranges::find_if(all, [&](const Variable& v) {
          return v.initial < 0 && v.disturbance == d && v.parameter == s.parameter;
        });
        if (at != all.end()) variable = static_cast<int>(at - all.begin());
      }
      jumps_.push_back({s.time_s, variable});
    }
  }
  for (size_t k = 1; options_.tick_rate_Hz > 0.0; ++k) {
    const double t_s = begin_s_ + static_cast<double>(k) / options_.tick_rate_Hz;
    if (t_s >= end_s_) break;
    jumps_.push_back({t_s, -1, true});
  }
  std::stable_sort(jumps_.begin(), jumps_.end(),
                   [](const Jump& a, const Jump& b) { return a.time_s < b.time_s; });
}

bool Propagator::advance() {
  if (ended()) return false;
  const bool released = slip_ends_ && slip_ == Slip::sticks;
  if (has_step_) {
    step_.accept(step_end_s_);
    if (sensitivity_) sensitivity_->accept();
    if (slip_ends_) cross_end_of_slip();
    cross_jumps();
  } else {
    take_command(step_.start_s(), true);
  }
  take_over();
  if (contact_.exists()) choose_slip(released);
  take_step();
  has_step_ = true;
  find_events();
  return true;
}

void Propagator::exchange(const Exchange& now) {
  exchange_ = now;
  exchange_is_new_ = true;
}

// The last exchanged inputs replace those of the schedule. The polynomial is kept: a current
// changes only the charge, and the light torque is continuous except for the error of its
// continuation.
void Propagator::take_over() {
  if (!exchange_) return;
  held_.battery_current_A = exchange_->battery_current_A;
  held_.light_body = exchange_->light_body;
  if (exchange_is_new_) step_.set_component(component::charge, exchange_->charge_drawn_C);
  exchange_is_new_ = false;
}

// NumericalError if steps as short as those so far would not reach the end in `max_steps`.
void Propagator::check_pace() const {
  constexpr int64_t every = 1 << 16;
  if (statistics_.steps == 0 || statistics_.steps % every != 0) return;
  const double pace_s = (step_.start_s() - begin_s_) / static_cast<double>(statistics_.steps);
  const double left_s = end_s_ - step_.start_s();
  if (pace_s * static_cast<double>(options_.max_steps - statistics_.steps) < left_s) {
    throw NumericalError(
        printed("steps of %g s on average will not reach %g s: the motion is too fast for its "
                "duration",
                pace_s, end_s_));
  }
}

void Propagator::take_step() {
  check_pace();
  const double start_s = step_.start_s();
  double stop_s = next_jump_ < jumps_.size() ? jumps_[next_jump_].time_s : end_s_;
  if (exchange_ && exchange_->next_s > start_s) stop_s = std::min(stop_s, exchange_->next_s);
  // After a day, iteration errors are visible in the phase of a free body. With torques, other
  // errors are larger.
  const bool is_free = dynamics_.model().disturbances.empty();
  const double settled = (is_free ? 1e-10 : 1e-6) * options_.tolerance;
  const double planned_s = stop_s;
  SlipEndSearch search;
  slip_ends_ = false;
  for (;;) {
    // Half of the remaining time rather than nearly all of it: this avoids very short steps.
    const double left_s = stop_s - start_s;
    double h_s = std::min(h_s_, options_.max_step_s);
    const bool cut = slip_ends_ || h_s >= left_s;
    h_s = cut ? left_s : with_few_bits(h_s > 0.5 * left_s ? 0.5 * left_s : h_s);
    if (++statistics_.steps > options_.max_steps || start_s + h_s <= start_s) {
      throw NumericalError(
          printed("the step length of the propagator fell to %g s at t = %g s", h_s, start_s) +
          infinite_torques(dynamics_, start_s, step_.start()));
    }
    const CollocationStep::Outcome outcome = attempt(step_, is_stiff_, h_s, held_, settled);
    statistics_.iterations += outcome.iterations;
    if (!outcome.converged) {
      h_s_ = 0.5 * h_s;
      ceiling_s_ = 0.7 * h_s;
      is_ceiling_of_state_ = true;
    } else if (outcome.error > 2.0 * options_.tolerance) {
      h_s_ = propose_length(outcome, h_s, false);
      ceiling_s_ = 0.9 * h_s;
      is_ceiling_of_state_ = false;
    } else if (contact_.exists() && !contact_.resolves(step_, held_)) {
      h_s_ = 0.5 * h_s;
    } else if (contact_.exists() && ends_slip(stop_s, search)) {
      stop_s = std::min(stop_s, planned_s);
      --statistics_.steps;
      continue;
    } else if (sensitivity_ && !sensitivity_->solve(step_, held_, options_.derivative_tolerance)) {
      h_s_ = 0.5 * h_s;
      ceiling_s_ = 0.7 * h_s;
      is_ceiling_of_state_ = false;
    } else {
      const bool was_at_ceiling = is_ceiling_of_state_ && h_s >= 0.9 * ceiling_s_;
      ceiling_s_ *= is_stiff_ ? 2.0 : 1.01;
      h_s_ = std::min(propose_length(outcome, h_s, cut), ceiling_s_);
      choose_method(outcome, was_at_ceiling);
      if (step_.is_stiff()) ++statistics_.stiff;
      step_end_s_ = cut ? stop_s : start_s + h_s;
      return;
    }
    stop_s = planned_s;
    search.corrections = 0;
    slip_ends_ = false;
    --statistics_.steps;
    ++statistics_.rejected;
  }
}

// Selects the method that solves a step. Newton's method is used after several steps whose length
// was limited by the convergence of the fixed-point iteration, not by the accuracy. It is used
// until the fixed-point iteration would contract again (stiffness() at most `contracts`).
void Propagator::choose_method(const CollocationStep::Outcome& outcome, bool was_at_ceiling) {
  constexpr int steps_before_switch = 8, slow_iterations = 20;
  constexpr double far_below = 1e-5;  // of the tolerance: a step four times as long would do
  constexpr double contracts = 3.0;
  if (is_stiff_) {
    if (step_.stiffness() > contracts) return;
    is_stiff_ = false;
    slow_steps_ = 0;
    return;
  }
  const bool is_slow = outcome.error < far_below * options_.tolerance &&
                       (was_at_ceiling || outcome.iterations > slow_iterations);
  slow_steps_ = is_slow ? slow_steps_ + 1 : 0;
  if (slow_steps_ < steps_before_switch) return;
  is_stiff_ = true;
  ceiling_s_ = std::numeric_limits<double>::infinity();
}

// The length for the next attempt. Small changes are avoided, because each requires a new
// continuation matrix. A step that was cut at a jump does not lengthen the following ones. If a
// step needs many iterations, it is close to the limit of convergence, and shorter steps are
// cheaper.
double Propagator::propose_length(const CollocationStep::Outcome& outcome, double h_s,
                                  bool cut) const {
  constexpr int slow_iterations = 20, max_iterations = 30;
  double factor = 0.9 * std::pow(options_.tolerance / outcome.error, 1.0 / gauss::points);
  if (outcome.iterations > max_iterations) factor = std::min(factor, 0.8);
  if (factor < 0.9) return std::max(factor, 0.2) * h_s;
  if (cut) return std::max(h_s, h_s_);
  const bool worth_it = factor > 1.15 && outcome.iterations < slow_iterations;
  return (worth_it ? std::min(factor, 2.0) : 1.0) * h_s;
}

// Takes the command that holds from this time on.
void Propagator::take_command(double now_s, bool is_tick) {
  if (!commander_) {
    held_ = dynamics_.model().schedule.at(now_s);
  } else if (is_tick) {
    held_ = commander_(now_s, step_.start());
  }
}

// Switches to the values after the jumps at the start of the next step. If the time of a jump is a
// variable, the derivative with respect to it changes by f⁻ − f⁺, the rates before and after the
// jump.
void Propagator::cross_jumps() {
  const double now_s = step_.start_s();
  if (next_jump_ == jumps_.size() || jumps_[next_jump_].time_s > now_s) return;
  const std::vector<Lanes> y(step_.start().begin(), step_.start().end());
  std::vector<Lanes> before(y.size()), after(y.size());
  bool is_tick = false;
  for (; next_jump_ < jumps_.size() && jumps_[next_jump_].time_s <= now_s; ++next_jump_) {
    is_tick = is_tick || jumps_[next_jump_].is_tick;
    if (jumps_[next_jump_].variable < 0) continue;
    dynamics_.rates(std::nextafter(now_s, -1e300), held_, y.data(), before.data());
    ZeroOrderHold then = held_;
    if (contact_.exists() && step_.start()[contact_.component()] == 0.0) {
      then.slip = contact_.at_rest(now_s, held_, step_.start());
    }
    dynamics_.rates(now_s, then, y.data(), after.data());
    std::vector<double> change;
    for (size_t c = 0; c < y.size(); ++c) change.push_back(before[c][0] - after[c][0]);
    sensitivity_->add(static_cast<size_t>(jumps_[next_jump_].variable), change);
  }
  take_command(now_s, is_tick);
  step_.restart();
  if (sensitivity_) sensitivity_->restart();
}

// Whether the present slip ends inside the attempted step, before its end. Then `stop_s` becomes an
// improved estimate of that time: first by locate(), then by Newton's method, until the time is
// resolved. A correction that leaves the first attempted step is useless: it comes from a rate that
// hardly changes at its zero.
bool Propagator::ends_slip(double& stop_s, SlipEndSearch& search) {
  constexpr int most = 5;
  if (!slip_ends_) {
    const EventFunction beyond = {.name = "", .value = [&](const Lanes& time_s, const Lanes* y) {
                                    return contact_.beyond(time_s, held_, y);
                                  }};
    search.latest_s = step_.start_s() + step_.length_s();
    const std::optional<DryContact::SlipEnd> within =
        contact_.ends_within(step_, held_, search.latest_s);
    if (!within) return false;
    slip_ends_ = true;
    stop_s = locate(beyond, within->low_s, within->high_s);
    return true;
  }
  if (slip_ == Slip::sticks || ++search.corrections > most) return false;
  const std::vector<double> end = step_.end();
  const size_t c = contact_.component();
  const double correction_s = -end[c] / contact_.rates(stop_s, held_, end)[c];
  const double resolved_s = 2e-16 * (std::abs(stop_s) + step_.length_s());
  const double corrected_s = stop_s + correction_s;
  const bool is_within = corrected_s > step_.start_s() && corrected_s <= search.latest_s;
  if (!(std::abs(correction_s) > resolved_s && is_within)) return false;
  stop_s = corrected_s;
  return true;
}

// Starts the next step after the end of a slip or of sticking. The platform has come to rest, or
// the torques have exceeded the static friction. The time t at which it comes to rest changes with
// variable v by ∂t/∂v = −(∂ω/∂v)/ω̇⁻, and the derivatives change by (f⁻ − f⁺) ∂t/∂v. A platform
// that is released starts with zero acceleration, so its derivatives do not jump.
void Propagator::cross_end_of_slip() {
  const double now_s = step_.start_s();
  step_.restart();
  if (sensitivity_) sensitivity_->restart();
  if (slip_ == Slip::sticks) {
    held_.slip = slip_ = contact_.released(now_s, held_, step_.start());
    return;
  }
  const size_t rate = contact_.component();
  step_.set_component(static_cast<int>(rate), 0.0);
  const std::vector<double> before = contact_.rates(now_s, held_, step_.start());
  held_.slip = slip_ = contact_.at_rest(now_s, held_, step_.start());
  if (!sensitivity_) return;
  const std::vector<double> after = contact_.rates(now_s, held_, step_.start());
  const size_t count = sensitivity_->variables().size();
  for (size_t v = 0; v < count; ++v) {
    if (before[rate] == 0.0) break;  // no deceleration at rest: ∂t/∂v is undefined
    const double later_s = -sensitivity_->start()[rate * count + v] / before[rate];
    std::vector<double> change;
    for (size_t c = 0; c < before.size(); ++c) change.push_back((before[c] - after[c]) * later_s);
    sensitivity_->add(v, change);
  }
}

// Chooses the slip of the next step. At rest it depends on the commands, which may have changed. A
// body that would stop within the resolution of the time is at rest. A platform that sticks at the
// start of the run has a rate of zero for all values of the variables.
void Propagator::choose_slip(bool released) {
  constexpr double slow_rad_s = 1e-9, slowest_rad_s = 1e-12;
  const size_t c = contact_.component();
  if (const double now = step_.start()[c]; now != 0.0 && std::abs(now) < slow_rad_s) {
    if (!has_step_ && std::abs(now) < slowest_rad_s) {
      step_.set_component(static_cast<int>(c), 0.0);
    } else if (has_step_ && slip_ != Slip::sticks) {
      held_.slip = slip_;
      const double start_s = step_.start_s();
      const double rests_in_s = -now / contact_.rates(start_s, held_, step_.start())[c];
      if (rests_in_s > 0.0 && rests_in_s < 1e-15 * std::abs(start_s)) cross_end_of_slip();
    }
  }
  const double rate = step_.start()[c];
  if (rate == 0.0 && !released) {
    slip_ = contact_.at_rest(step_.start_s(), held_, step_.start());
  } else if (!has_step_) {
    slip_ = rate > 0.0 ? Slip::forward : Slip::backward;
  }
  held_.slip = slip_;
  if (has_step_ || !sensitivity_ || slip_ != Slip::sticks) return;
  const size_t count = sensitivity_->variables().size();
  for (size_t v = 0; v < count; ++v) {
    std::vector<double> change(step_.start().size(), 0.0);
    change[c] = -sensitivity_->start()[c * count + v];
    sensitivity_->add(v, change);
  }
}

Lanes Propagator::fraction(const Lanes& time_s) const {
  if (!(step_.length_s() > 0.0)) return 0.0;
  return (time_s - step_.start_s()) / step_.length_s();
}

void Propagator::dense(const Lanes& time_s, Lanes* y) const {
  step_.dense(fraction(time_s), y);
}

void Propagator::dense_derivatives(const Lanes& time_s, Lanes* derivatives) const {
  sensitivity_->dense(fraction(time_s), derivatives);
}

void Propagator::find_events() {
  if (event_functions_.empty()) return;
  const std::vector<double> end = step_.end();
  const std::vector<Lanes> at_end(end.begin(), end.end());
  const Lanes stage_times_s = step_.stage_times_s();
  std::vector<Event> found;
  const EventFunction* last = nullptr;
  for (size_t e = 0; e < event_functions_.size(); ++e) {
    const EventFunction& event = event_functions_[e];
    const Lanes inside = event.value(stage_times_s, step_.stages().data());
    double low_s = step_.start_s(), low = event_values_[e];
    for (int i = 0; i <= Lanes::count; ++i) {
      const bool is_end = i == Lanes::count;
      const double high_s = is_end ? step_end_s_ : stage_times_s[i];
      const double high = is_end ? event.value(step_end_s_, at_end.data())[0] : inside[i];
      const bool rising = low <= 0.0 && high > 0.0, falling = low >= 0.0 && high < 0.0;
      if (rising || (falling && !event.rising_only)) {
        const bool own_name = falling && !event.falling_name.empty();
        found.push_back(
            {own_name ? event.falling_name : event.name, locate(event, low_s, high_s), rising});
        if (event.ends_run && (last == nullptr || found.back().time_s < step_end_s_)) {
          last = &event;
          step_end_s_ = found.back().time_s;
          ended_by_event_ = true;
          break;
        }
      }
      low_s = high_s;
      low = high;
      if (is_end) event_values_[e] = high;
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Event& a, const Event& b) { return a.time_s < b.time_s; });
  for (const Event& event : found) {
    if (event.time_s <= step_end_s_) events_.push_back(event);
  }
}

// Time of the zero between `low_s` and `high_s`. The interval is divided by nine, with eight values
// at a time, until the time is resolved.
double Propagator::locate(const EventFunction& event, double low_s, double high_s) const {
  std::vector<Lanes> y(step_.start().size());
  dense(low_s, y.data());
  const bool rising = event.value(low_s, y.data())[0] <= 0.0;
  for (int cut = 0; cut < 20 && high_s > std::nextafter(low_s, high_s); ++cut) {
    const double width_s = high_s - low_s;
    Lanes times_s;
    for (int i = 0; i < Lanes::count; ++i) times_s.set(i, low_s + width_s * (i + 1) / 9.0);
    dense(times_s, y.data());
    const Lanes values = event.value(times_s, y.data());
    int first_beyond = 0;
    while (first_beyond < Lanes::count &&
           (rising ? values[first_beyond] <= 0.0 : values[first_beyond] >= 0.0)) {
      ++first_beyond;
    }
    if (first_beyond < Lanes::count) high_s = times_s[first_beyond];
    if (first_beyond > 0) low_s = times_s[first_beyond - 1];
  }
  return high_s;
}

void Propagator::keep(Snapshot& snapshot) {
  snapshot(step_);
  snapshot.each(events_, [&](Event& event) { snapshot(event.name, event.time_s, event.rising); });
  snapshot.fixed(event_values_);
  snapshot.expect(jumps_.size());
  snapshot.at_most(next_jump_, jumps_.size());
  snapshot(held_, slip_, slip_ends_, exchange_, exchange_is_new_);
  snapshot(h_s_, ceiling_s_, is_ceiling_of_state_, is_stiff_, slow_steps_);
  snapshot(step_end_s_, has_step_, ended_by_event_, statistics_);
}

Trajectory propagate(const Dynamics& dynamics, const PlatformState& initial,
                     std::span<const double> times_s, const PropagationOptions& options,
                     const std::vector<Variable>& variables,
                     const std::vector<EventFunction>& events) {
  const size_t n = static_cast<size_t>(dynamics.size());
  const double end_s = times_s.empty() ? initial.time_s : times_s.back();
  Propagator propagator(dynamics, initial, end_s, options, variables, events);
  Trajectory trajectory;
  trajectory.components = n - 1;
  trajectory.variables = variables.size();
  trajectory.states.reserve(times_s.size());
  const auto sink = [&](const Samples& samples) {
    std::vector<double> change(n);
    for (int i = 0; i < samples.count; ++i) {
      const std::vector<double> y = lane_of(samples.y, i);
      trajectory.states.push_back(to_state(samples.time_s[i], y));
      if (variables.empty()) continue;
      const size_t first = trajectory.derivatives.size();
      trajectory.derivatives.resize(first + trajectory.components * variables.size());
      for (size_t v = 0; v < variables.size(); ++v) {
        for (size_t c = 0; c < n; ++c) change[c] = samples.derivatives[c * variables.size() + v][i];
        const std::vector<double> seen = tangent(y, change);
        for (size_t c = 0; c < seen.size(); ++c) {
          trajectory.derivatives[first + c * variables.size() + v] = seen[c];
        }
      }
    }
  };
  sample(
      propagator, times_s.size(), [&](size_t i) { return times_s[i]; }, sink);
  trajectory.events = propagator.events();
  trajectory.statistics = propagator.statistics();
  return trajectory;
}

double attitude_error_bound_rad(const Dynamics& dynamics, const PlatformState& initial,
                                double end_s, double torque_N_m, const PropagationOptions& options,
                                size_t intervals) {
  const auto tangents = static_cast<size_t>(dynamics.size() - 1);
  std::vector<Variable> variables;
  for (size_t k = 0; k < tangents; ++k) variables.push_back({static_cast<int>(k), 0, -1});
  std::vector<double> times_s;
  const double step_s = (end_s - initial.time_s) / static_cast<double>(intervals);
  for (size_t i = 0; i <= intervals; ++i) {
    times_s.push_back(initial.time_s + static_cast<double>(i) * step_s);
  }
  const Trajectory trajectory = propagate(dynamics, initial, times_s, options, variables);
  const auto n = static_cast<Eigen::Index>(tangents);
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto transition = [&](size_t i) {
    return Matrix(
        Eigen::Map<const Matrix>(trajectory.derivatives.data() + i * tangents * tangents, n, n));
  };
  const size_t last = trajectory.states.size() - 1;
  const Matrix to_end = transition(last);
  const Mat3 inverse_inertia = dynamics.model().platform.inertia_kg_m2.inverse();
  double integral = 0.0;
  for (size_t i = 0; i <= last; ++i) {
    // ∂end/∂state(s) = ∂end/∂start (∂state(s)/∂start)⁻¹; rows: attitude, columns: rate.
    const Eigen::FullPivLU<Matrix> lu(transition(i).transpose());
    if (!lu.isInvertible()) return std::numeric_limits<double>::quiet_NaN();
    const Matrix from_here = lu.solve(to_end.topRows(3).transpose()).transpose();
    const Mat3 by_torque = from_here.middleCols(3, 3) * inverse_inertia;
    const double size = by_torque.jacobiSvd().singularValues()[0];
    integral += (i == 0 || i == last ? 0.5 : 1.0) * size * step_s;
  }
  return torque_N_m * integral;
}

}  // namespace photorque
