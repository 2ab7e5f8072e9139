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

std::vector<EventFunction> events_of(const Dynamics& dynamics, bool has_power_system) {
  const Platform& platform = dynamics.model().platform;
  std::vector<EventFunction> events;
  if (platform.tilt_limit_rad) events.push_back(tilt_event(*platform.tilt_limit_rad));
  if (platform.battery_capacity_C && !has_power_system) {
    events.push_back(battery_empty_event(*platform.battery_capacity_C));
    // The run continues without power when the battery is empty.
    events.back().ends_run = false;
  }
  for (const Disturbance& d : dynamics.model().disturbances) {
    const DisturbanceKind* kind = find_kind(d.kind);
    if (kind != nullptr && kind->has_eclipses) events.push_back(eclipse_event(dynamics));
  }
  return events;
}

// The step is limited so that no eclipse is missed: the steps of a body that hardly moves would
// otherwise be longer than an eclipse. Its penumbra and the charge are resolved by the error of the
// step.
PropagationOptions options_of(const PropagationRun& run, const Dynamics& dynamics) {
  constexpr double steps_per_orbit = 400.0;
  PropagationOptions options = run.options;
  const bool has_eclipses = std::ranges::any_of(run.model.disturbances, [](const Disturbance& d) {
    const DisturbanceKind* kind = find_kind(d.kind);
    return kind != nullptr && kind->has_eclipses;
  });
  const double mean_motion_rad_s = std::sqrt(dynamics.at(run.initial).gravity_gradient_1_s2[0]);
  if (has_eclipses && mean_motion_rad_s > 0.0) {
    options.max_step_s =
        std::min(options.max_step_s, 2.0 * pi / mean_motion_rad_s / steps_per_orbit);
  }
  return options;
}

// The times of the rows of a recording.
struct RowTimes {
  const PropagationRun& run;
  double time_s(size_t row) const {
    return run.initial.time_s + static_cast<double>(row) / run.output_rate_Hz;
  }
  size_t rows() const {
    return static_cast<size_t>(std::floor(run.duration_s * run.output_rate_Hz + 1e-6)) + 1;
  }
};

// Reads the instruments at a tick and calls the commander of the run.
Propagator::Commander commander_at_ticks(const PropagationRun& run, const Propagator& propagator,
                                         LiveInstruments& instruments, const PowerHistory* beside) {
  return [&run, &propagator, &instruments, beside](double time_s, std::span<const double> y) {
    std::optional<PowerState> power;
    if (beside != nullptr) power = beside->at(std::min(time_s, beside->known_until_s()));
    return run.commander(instruments.read(time_s, y, propagator.held(), power));
  };
}

// Number of recorded rows per row of the history. The history, which always contains the last row,
// then has at most `history_rows` rows (at least 2).
size_t thinning(size_t rows, size_t history_rows) {
  if (rows <= history_rows) return 1;
  return (rows - 1 + history_rows - 2) / (history_rows - 1);
}

}  // namespace

std::vector<RecordedRun::Look> RecordedRun::looks(const PropagationRun& run, double delay_s) {
  const RowTimes rows{run};
  std::vector<Look> all;
  size_t next_seen = 0;
  for (size_t row = 0; row < rows.rows(); ++row) {
    const double time_s = rows.time_s(row);
    for (; delay_s > 0.0 && next_seen < rows.rows(); ++next_seen) {
      const double wanted_s = rows.time_s(next_seen) - delay_s;
      const double seen_s = std::max(run.initial.time_s, wanted_s);
      if (seen_s > time_s) break;
      all.push_back({seen_s, false, seen_s - wanted_s});
    }
    all.push_back({time_s, true});
  }
  return all;
}

RecordedRun::RecordedRun(const PropagationRun& run, std::function<void(double)> progress,
                         const PowerHistory* beside)
    : beside_(beside),
      progress_(std::move(progress)),
      dynamics_(run.model),
      given_(run.model.schedule),
      delay_s_(dynamics_.at(run.initial).camera_delay_s[0]),
      times_(looks(run, delay_s_)),
      rows_(RowTimes{run}.rows()),
      thinning_(thinning(rows_, run.history_rows)),
      recorder_(run.sensors, run.seed),
      history_(dynamics_),
      excursion_(run.initial),
      propagator_(dynamics_, run.initial, run.initial.time_s + run.duration_s,
                  options_of(run, dynamics_), {}, events_of(dynamics_, beside != nullptr)),
      sampler_(
          propagator_, times_.size(), [this](size_t i) { return times_[i].time_s; },
          [this](const Samples& samples) { take_in(samples); }) {
  if (!run.commander) return;
  instruments_.emplace(dynamics_, run.initial, run.output_rate_Hz, delay_s_, run.sensors, run.seed);
  propagator_.follow_commander(commander_at_ticks(run, propagator_, *instruments_, beside));
}

void RecordedRun::record() {
  if (instruments_) instruments_->follow(propagator_);
  excursion_.follow(propagator_);
  hand_on();
  sampler_.follow();
}

void RecordedRun::keep(Snapshot& snapshot) {
  const auto components = static_cast<size_t>(dynamics_.size());
  snapshot.expect(components);
  snapshot(propagator_, sampler_, recorder_, history_, excursion_);
  snapshot.each(states_, [&](PlatformState& state) {
    snapshot(state.time_s, state.lab_from_body, state.rate_body_rad_s, state.charge_drawn_C);
    state.extra.resize(components - component::extra);
    snapshot.fixed(state.extra);
  });
  snapshot.each(on_the_way_, [&](Quat& seen) { snapshot(seen); });
  snapshot.each(waiting_,
                [&](Samples& samples) { samples.keep(snapshot, components, times_.size()); });
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
    record(times_[samples.first + static_cast<size_t>(i)], lane_of(samples.y, i),
           state_of(samples, i), now, i);
  }
  if (progress_) progress_(static_cast<double>(states_.size()) / static_cast<double>(rows_));
}

void RecordedRun::record(const Look& look, const std::vector<double>& y, const PlatformState& state,
                         const Dynamics::Instants& now, int lane) {
  if (!look.is_row) {
    on_the_way_.push_back(attitude_before(state, look.before_s));
    return;
  }
  Quat seen = state.lab_from_body;
  if (!on_the_way_.empty()) {
    seen = on_the_way_.front();
    on_the_way_.pop_front();
  }
  Truth truth = truth_at(state, seen, now, lane);
  truth.place_m_m_s = place_of(dynamics_, y);
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
