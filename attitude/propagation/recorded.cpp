#include "attitude/propagation/recorded.h"

#include <algorithm>
#include <cmath>

#include "attitude/disturbances/kind.h"
#include "attitude/propagation/run.h"
#include "attitude/propagation/sampling.h"
#include "core/constants.h"
#include "core/snapshot.h"

namespace photorque {
namespace {

bool has_eclipses(const Dynamics& dynamics) {
  return std::ranges::any_of(dynamics.model().disturbances, [](const Disturbance& d) {
    const DisturbanceKind* kind = find_kind(d.kind);
    return kind != nullptr && kind->has_eclipses;
  });
}

std::vector<EventFunction> events_of(const Dynamics& dynamics, bool has_power_system) {
  const Platform& platform = dynamics.model().platform;
  std::vector<EventFunction> events;
  if (platform.tilt_limit_rad) events.push_back(tilt_event(*platform.tilt_limit_rad));
  if (platform.battery_capacity_C && !has_power_system) {
    events.push_back(battery_empty_event(*platform.battery_capacity_C));
  }
  if (has_eclipses(dynamics)) events.push_back(eclipse_event(dynamics));
  return events;
}

// The step is limited so that no eclipse is missed: the steps of a body that hardly moves would
// otherwise be longer than an eclipse. Its penumbra and the charge are resolved by the error of the
// step.
PropagationOptions options_of(const PropagationRun& run, const Dynamics& dynamics) {
  constexpr double steps_per_orbit = 400.0;
  PropagationOptions options = run.options;
  const double mean_motion_rad_s = std::sqrt(dynamics.at(run.initial).gravity_gradient_1_s2[0]);
  if (has_eclipses(dynamics) && mean_motion_rad_s > 0.0) {
    options.max_step_s =
        std::min(options.max_step_s, 2.0 * pi / mean_motion_rad_s / steps_per_orbit);
  }
  return options;
}

size_t rows_of(const PropagationRun& run) {
  return static_cast<size_t>(std::floor(run.duration_s * run.output_rate_Hz + 1e-6)) + 1;
}

// Number of recorded rows per row of the history. The history, which always contains the last row,
// then has at most `history_rows` rows (at least 2).
size_t thinning(size_t rows, size_t history_rows) {
  if (rows <= history_rows) return 1;
  return (rows - 1 + history_rows - 2) / (history_rows - 1);
}

}  // namespace

RecordedRun::RecordedRun(const PropagationRun& run, std::function<void(double)> progress,
                         const PowerHistory* beside)
    : beside_(beside),
      progress_(std::move(progress)),
      dynamics_(run.model),
      given_(run.model.schedule),
      camera_(run.initial, run.output_rate_Hz, dynamics_.at(run.initial).camera_delay_s[0]),
      rows_(rows_of(run)),
      thinning_(thinning(rows_, run.history_rows)),
      recorder_(run.sensors, run.seed),
      history_(dynamics_),
      excursion_(run.initial),
      propagator_(dynamics_, run.initial, run.initial.time_s + run.duration_s,
                  options_of(run, dynamics_), {}, events_of(dynamics_, beside != nullptr)),
      sampler_(
          propagator_, rows_, [this](size_t row) { return camera_.tick_s(row); },
          [this](const Samples& samples) { take_in(samples); }) {
  if (!run.commander) return;
  instruments_.emplace(dynamics_, camera_, run.sensors, run.seed);
  // Reads the instruments at a tick and calls the commander of the run.
  propagator_.follow_commander([this, &run](double time_s, std::span<const double> y) {
    std::optional<PowerState> power;
    if (beside_ != nullptr) power = beside_->at(std::min(time_s, beside_->known_until_s()));
    return run.commander(instruments_->read(time_s, y, propagator_.held(), power));
  });
}

void RecordedRun::record() {
  if (instruments_) instruments_->follow(propagator_);
  camera_.follow(propagator_);
  excursion_.follow(propagator_);
  hand_on();
  sampler_.follow();
}

void RecordedRun::keep(Snapshot& snapshot) {
  const auto components = static_cast<size_t>(dynamics_.size());
  snapshot.expect(components);
  snapshot(propagator_, sampler_, camera_, recorder_, history_, excursion_);
  snapshot.each(states_, [&](PlatformState& state) {
    snapshot(state.time_s, state.lab_from_body, state.rate_body_rad_s, state.charge_drawn_C);
    state.extra.resize(components - component::extra);
    snapshot.fixed(state.extra);
  });
  snapshot.each(waiting_, [&](Samples& samples) { samples.keep(snapshot, components, rows_); });
}

// With a power system, states are recorded when its history extends to their times.
void RecordedRun::take_in(const Samples& samples) {
  if (beside_ == nullptr) return record(samples);
  waiting_.push_back(samples);
  hand_on();
}

void RecordedRun::hand_on() {
  for (; !waiting_.empty(); waiting_.pop_front()) {
    const Samples& first = waiting_.front();
    if (first.time_s[first.count - 1] > beside_->known_until_s()) return;
    record(first);
  }
}

Dynamics::Instants RecordedRun::instants_at(const Samples& samples) const {
  Dynamics::Instants now = dynamics_.at(samples.time_s, samples.held, samples.y.data());
  for (int i = 0; beside_ != nullptr && i < samples.count; ++i) {
    const PowerState power = beside_->at(samples.time_s[i]);
    now.battery_current_A.set(i, power.battery_current_A);
    now.array_power_W.set(i, power.array_power_W);
  }
  return now;
}

PlatformState RecordedRun::state_of(const Samples& samples, int lane) const {
  PlatformState state = to_state(samples.time_s[lane], lane_of(samples.y, lane));
  if (beside_ != nullptr) state.charge_drawn_C = beside_->at(state.time_s).charge_drawn_C;
  return state;
}

void RecordedRun::record(const Samples& samples) {
  const Dynamics::Instants now = instants_at(samples);
  for (int i = 0; i < samples.count; ++i) {
    record(lane_of(samples.y, i), state_of(samples, i), now, i);
  }
  if (progress_) progress_(static_cast<double>(states_.size()) / static_cast<double>(rows_));
}

void RecordedRun::record(const std::vector<double>& y, const PlatformState& state,
                         const Dynamics::Instants& now, int lane) {
  Truth truth = truth_at(state, camera_.seen(state), now, lane);
  if (const int place = dynamics_.first_of_translation(); place >= 0) {
    std::copy_n(y.begin() + place, 4, truth.place_m_m_s.emplace().begin());
  }
  const ZeroOrderHold given = given_.at(state.time_s);
  truth.wheel_rad_s = given.wheel.at(state.time_s);
  if (dynamics_.model().schedule.command_delay_s > 0.0) {
    truth.command_body_N_m = given.command_body_N_m;
    truth.command_lab_N = given.force_lab_N + state.lab_from_body * given.force_body_N;
  }
  recorder_.add(truth);
  const bool is_last = states_.size() + 1 == rows_;
  if (states_.size() % thinning_ == 0 || is_last) history_.add(state, now, lane);
  states_.push_back(state);
}

// The state at the end of the run. If that is between two rows, it is added to the history.
PlatformState RecordedRun::recorded_end() {
  const double end_s = propagator_.step_end_s();
  if (states_.size() == rows_ || !(end_s > states_.back().time_s)) return states_.back();
  Samples end;
  end.count = 1;
  end.time_s = end_s;
  end.held.fill(propagator_.held());
  end.y.resize(static_cast<size_t>(dynamics_.size()));
  propagator_.dense(end_s, end.y.data());
  PlatformState state = state_of(end, 0);
  history_.add(state, instants_at(end), 0);
  return state;
}

PropagationResult RecordedRun::result() {
  sampler_.finish();
  for (const Samples& samples : waiting_) record(samples);
  waiting_.clear();
  PropagationResult result;
  result.end = recorded_end();
  result.recording = recorder_.finish();
  result.states = std::move(states_);
  result.events = propagator_.events();
  result.statistics = propagator_.statistics();
  result.product = history_.product(excursion_, result.events, result.statistics);
  return result;
}

PropagationResult propagate(const PropagationRun& run,
                            const std::function<void(double)>& progress) {
  RecordedRun recorded(run, progress);
  while (recorded.advance()) recorded.record();
  return recorded.result();
}

}  // namespace photorque
