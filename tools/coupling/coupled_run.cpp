#include "tools/coupling/coupled_run.h"

#include <algorithm>
#include <cmath>

#include "core/snapshot.h"

namespace photorque {
namespace {

constexpr size_t judged_every = 10;

std::vector<Lanes> at_one_instant(Propagator& motion, double time_s) {
  std::vector<Lanes> y(static_cast<size_t>(motion.dynamics().size()));
  motion.dense(time_s, y.data());
  return y;
}

// Illumination by the Sun in the state `y` under the present command.
Lanes illumination_of(const Propagator& motion, const Lanes& times_s, const std::vector<Lanes>& y) {
  std::array<ZeroOrderHold, Lanes::count> held;
  held.fill(motion.held());
  return motion.dynamics().at(times_s, held, y.data()).illumination;
}

}  // namespace

std::vector<GroupOutput> group_outputs(const LightModel& light, const LightSettings& settings,
                                       double start_s) {
  const LampDroop droop = light.day() ? light.day()->droop : LampDroop{};
  std::vector<GroupOutput> outputs;
  for (const LightModel::Group& group : light.groups()) {
    LampSchedule schedule;
    schedule.on_at_start = !light.day() || light.day()->lamps_on;
    bool on = schedule.on_at_start;
    for (const LightSettings::Switch& one : settings.switches) {
      const bool concerned = one.source.empty() || one.source == group.name;
      if (!concerned || one.on == on) continue;
      on = one.on;
      schedule.time_s.push_back(one.time_s);
    }
    // The Sun has no warm-up droop.
    outputs.push_back({group, std::make_shared<const LampOutput>(group.is_sun ? LampDroop{} : droop,
                                                                 schedule, start_s)});
    outputs.back().corners_s = light.corners_s();
    if (!outputs.back().corners_s.empty()) {
      outputs.back().weight = [&light, group](double time_s) {
        return light.weight(group, time_s);
      };
    }
  }
  return outputs;
}

CoupledRun::CoupledRun(const LightModel& light, std::shared_ptr<const RotationTable> table,
                       std::vector<GroupOutput> outputs, std::optional<PowerSupply> supply,
                       const LightSettings& settings, const PropagationRun& run,
                       double battery_voltage_V)
    : light_(light),
      table_(std::move(table)),
      outputs_(std::move(outputs)),
      supply_(std::move(supply)),
      step_s_(settings.step_s),
      start_s_(run.initial.time_s),
      end_s_(run.initial.time_s + run.duration_s),
      battery_voltage_V_(battery_voltage_V),
      start_charge_C_(run.initial.charge_drawn_C),
      power_(run.initial.time_s, run.initial.charge_drawn_C) {
  for (const GroupOutput& group : outputs_) {
    has_sun_ = has_sun_ || group.group.is_sun;
    if (group.group.position > 0) continue;  // all positions have the same lamps
    const auto& all = group.output->switches_s();
    switches_s_.insert(switches_s_.end(), all.begin(), all.end());
    for (const double time_s : all) {
      if (time_s > end_s_) continue;
      const bool on = group.output->at(time_s) > 0.0;
      events_.push_back({group.group.name + (on ? "_on" : "_off"), time_s, on});
    }
  }
  std::ranges::sort(switches_s_);
}

Quat CoupledRun::attitude_of(const std::vector<Lanes>& y, int lane) {
  return Quat(y[0][lane], y[1][lane], y[2][lane], y[3][lane]).normalized();
}

std::vector<double> CoupledRun::channels_at(const Quat& lab_from_body) const {
  if (!table_) return light_.trace(lab_from_body).value;
  std::vector<double> channels(table_->channels());
  table_->at(lab_from_body, 0, channels);
  return channels;
}

double CoupledRun::output(const GroupOutput& group, double time_s, double illumination) const {
  return group.at(time_s) * (group.group.is_sun ? illumination : 1.0);
}

// The next segment ends at the next exchange, at a switch, or at the end of the run. The power
// system divides it into its own steps.
void CoupledRun::plan(double from_s) {
  const double steps = std::floor((from_s - start_s_) / step_s_ + 1e-9) + 1.0;
  segment_from_s_ = from_s;
  segment_end_s_ = std::min(start_s_ + steps * step_s_, end_s_);
  const auto next = std::ranges::upper_bound(switches_s_, from_s);
  if (next != switches_s_.end()) segment_end_s_ = std::min(segment_end_s_, *next);
  const double length_s = segment_end_s_ - segment_from_s_;
  const double period_s =
      supply_ && supply_->design().tracker ? supply_->design().tracker->period_s : step_s_;
  const auto count = static_cast<size_t>(std::max(1.0, std::ceil(length_s / period_s - 1e-9)));
  instants_.assign(count, {});
  for (size_t i = 0; i < count; ++i) {
    instants_[i].length_s = length_s / static_cast<double>(count);
    instants_[i].from_s = from_s + static_cast<double>(i) * instants_[i].length_s;
  }
  collected_ = 0;
}

void CoupledRun::begin(Propagator& motion) {
  begun_ = true;
  const std::vector<Lanes> y = at_one_instant(motion, start_s_);
  const double illumination =
      has_sun_ ? motion.dynamics().at(start_s_, {}, y.data()).illumination[0] : 1.0;
  Instant now{start_s_, 0.0, channels_at(attitude_of(y, 0)), illumination};
  if (!table_) {
    add_trace(start_s_, now.channels);
    held_ = continued(illumination);
  }
  double current_A = 0.0;
  if (supply_) {
    // The battery current at the start follows from a step that is discarded.
    PowerSupply trial = *supply_;
    trial.step(start_s_, 1e-3, light_of(now));
    current_A = -trial.state().battery_W / battery_voltage_V_;
    power_.add(start_s_, {current_A, trial.state().array_W, start_charge_C_});
    is_lit_ = true;
  }
  plan(start_s_);
  motion.exchange({current_A, held_, start_charge_C_, segment_end_s_});
}

// Stores attitude and light at those instants of the power system that are within the last step of
// the motion.
void CoupledRun::collect(Propagator& motion) {
  std::vector<Lanes> y(static_cast<size_t>(motion.dynamics().size()));
  while (collected_ < instants_.size() && instants_[collected_].middle_s() <= motion.step_end_s()) {
    Lanes times_s = instants_[collected_].middle_s();
    int batch = 0;
    for (; batch < Lanes::count && collected_ + static_cast<size_t>(batch) < instants_.size();
         ++batch) {
      const double time_s = instants_[collected_ + static_cast<size_t>(batch)].middle_s();
      if (time_s > motion.step_end_s()) break;
      times_s.set(batch, time_s);
    }
    motion.dense(times_s, y.data());
    const Lanes illumination = has_sun_ ? illumination_of(motion, times_s, y) : Lanes(1.0);
    for (int i = 0; i < batch; ++i, ++collected_) {
      instants_[collected_].illumination = illumination[i];
      if (table_) instants_[collected_].channels = channels_at(attitude_of(y, i));
    }
  }
}

PowerSupply::Light CoupledRun::light_of(const Instant& instant) const {
  PowerSupply::Light light;
  light.photocurrent_A.assign(light_.cells(), 0.0);
  for (const GroupOutput& group : outputs_) {
    const double factor = output(group, instant.middle_s(), instant.illumination);
    if (factor == 0.0) continue;
    const double* cell = instant.channels.data() + group.group.first + 6;
    for (size_t i = 0; i < light_.cells(); ++i) {
      light.photocurrent_A[i] += factor * std::max(0.0, cell[i]);
    }
    light.on_cells_W += factor * std::max(0.0, cell[light_.cells()]);
  }
  // Clamped, because weights of a joint's positions may be negative.
  for (double& current_A : light.photocurrent_A) current_A = std::max(0.0, current_A);
  light.on_cells_W = std::max(0.0, light.on_cells_W);
  return light;
}

void CoupledRun::add_trace(double time_s, std::vector<double> channels) {
  traced_.push_back({time_s, std::move(channels)});
  if (traced_.size() > 3) traced_.erase(traced_.begin());
  ++traces_;
}

// Polynomial through the last three traces.
ContinuedTorque CoupledRun::continued(double illumination) const {
  const size_t count = traced_.size();
  const double now_s = traced_.back().time_s;
  const auto total = [&](size_t back) {
    const Traced& trace = traced_[traced_.size() - 1 - back];
    Vec3 sum = Vec3::Zero();
    for (const GroupOutput& group : outputs_) {
      const double factor = output(group, now_s + 0.5 * step_s_, illumination);
      sum += factor * Eigen::Map<const Vec3>(trace.channels.data() + group.group.first);
    }
    return sum;
  };
  ContinuedTorque torque{.from_s = now_s, .value_N_m = total(0)};
  if (count < 2) return torque;
  const double h1 = now_s - traced_[traced_.size() - 2].time_s;
  const Vec3 first = (total(0) - total(1)) / h1;
  torque.rate_N_m_s = first;
  if (count < 3) return torque;
  const double h2 = traced_[traced_.size() - 2].time_s - traced_[traced_.size() - 3].time_s;
  const Vec3 second = (first - (total(1) - total(2)) / h2) / (h1 + h2);
  torque.rate_N_m_s = first + h1 * second;
  torque.curvature_N_m_s2 = second;
  return torque;
}

void CoupledRun::look_for_light(double time_s, double light_W) {
  constexpr double dark = 1e-3;  // relative to the largest light so far
  max_light_W_ = std::max(max_light_W_, light_W);
  const double limit_W = dark * max_light_W_;
  const bool lit = light_W > limit_W;
  if (lit != is_lit_ && max_light_W_ > 0.0) {
    // At the beginning of a segment the light may change by a switch. Otherwise the time of the
    // event follows from linear interpolation.
    double when_s = segment_from_s_;
    const bool jumps = last_light_s_ <= segment_from_s_ &&
                       std::ranges::binary_search(switches_s_, segment_from_s_);
    if (!jumps) {
      const double part = (limit_W - last_light_W_) / (light_W - last_light_W_);
      when_s = std::lerp(last_light_s_, time_s, std::clamp(part, 0.0, 1.0));
    }
    events_.push_back({lit ? "light_returns" : "light_lost", when_s, lit});
    is_lit_ = lit;
  }
  last_light_W_ = light_W;
  last_light_s_ = time_s;
}

// Simulates the power system over the segment in the light along the motion.
void CoupledRun::run_supply() {
  PowerRow row;
  double length_s = 0.0;
  for (size_t i = 0; i < instants_.size(); ++i) {
    const Instant& instant = instants_[i];
    const PowerSupply::Light light = light_of(instant);
    look_for_light(instant.middle_s(), light.on_cells_W);
    // The search for the maximum power point takes longer than a step of the tracker and is done at
    // intervals only.
    const bool judge = !supply_->design().tracker || (i == 0 && rows_.size() % judged_every == 0);
    supply_->step(instant.from_s, instant.length_s, light, judge);
    const PowerSupply::State& state = supply_->state();
    const double h = instant.length_s;
    length_s += h;
    row.light_W += h * state.light_W;
    row.best_W += h * state.best_W;
    row.array_W += h * state.array_W;
    row.load_W += h * state.load_W;
    row.voltage_V += h * state.voltage_V;
    row.battery_current_A += h * -state.battery_W / battery_voltage_V_;
    const double current_A = -state.battery_W / battery_voltage_V_;
    power_.add(instant.from_s + h, {current_A, state.array_W, charge_C(*supply_)});
    double emitted_W = 0.0, full_W = 0.0;
    for (const GroupOutput& group : outputs_) {
      emitted_W += group.group.emitted_W * group.at(instant.middle_s());
      full_W += group.group.emitted_W * group.weight_at(instant.middle_s());
    }
    emitted_.add(emitted_W * h);
    row.output += h * (full_W > 0.0 ? emitted_W / full_W : instant.illumination);
  }
  for (double* mean : {&row.light_W, &row.best_W, &row.array_W, &row.load_W, &row.voltage_V,
                       &row.battery_current_A, &row.output}) {
    *mean /= length_s;
  }
  row.time_s = segment_end_s_;
  row.stored_J = supply_->stored_J();
  row.temperature_K = supply_->temperature_K();
  rows_.push_back(row);
}

void CoupledRun::exchange(Propagator& motion) {
  const double now_s = motion.step_end_s();
  if (now_s < segment_end_s_) {
    // The run ended within the segment; its remaining instants are omitted.
    std::erase_if(instants_, [&](const Instant& one) { return one.from_s >= now_s; });
    if (!instants_.empty()) instants_.back().length_s = now_s - instants_.back().from_s;
    segment_end_s_ = now_s;
  }
  const std::vector<Lanes> y = at_one_instant(motion, now_s);
  const double illumination = has_sun_ ? illumination_of(motion, now_s, y)[0] : 1.0;
  if (!table_) {
    const Vec3 expected = held_.at(now_s);
    add_trace(now_s, channels_at(attitude_of(y, 0)));
    const Traced &last = traced_[traced_.size() - 2], &now = traced_.back();
    Vec3 truth = Vec3::Zero();
    for (const GroupOutput& group : outputs_) {
      truth += output(group, std::nextafter(now_s, start_s_), illumination) *
               Eigen::Map<const Vec3>(now.channels.data() + group.group.first);
    }
    const double missed = (expected - truth).norm();
    continuation_.max_N_m = std::max(continuation_.max_N_m, missed);
    continuation_.sum_squares += missed * missed;
    ++continuation_.count;
    for (Instant& instant : instants_) {
      const double part = (instant.middle_s() - last.time_s) / (now_s - last.time_s);
      instant.channels.resize(now.channels.size());
      for (size_t c = 0; c < now.channels.size(); ++c) {
        instant.channels[c] = std::lerp(last.channels[c], now.channels[c], part);
      }
    }
    held_ = continued(illumination);
  } else {
    // The last instant has the light at the end of the run if the run ended within it.
    for (Instant& instant : instants_) {
      if (instant.channels.empty()) instant.channels = channels_at(attitude_of(y, 0));
    }
  }
  double current_A = 0.0, drawn_C = y[component::charge][0];
  if (supply_ && !instants_.empty()) {
    run_supply();
    current_A = power_.last().battery_current_A;
    max_correction_C_ =
        std::max(max_correction_C_, std::abs(power_.last().charge_drawn_C - drawn_C));
    drawn_C = power_.last().charge_drawn_C;
  }
  power_.set_known_until(now_s);
  if (!motion.ended()) plan(now_s);
  motion.exchange({current_A, held_, drawn_C, segment_end_s_});
}

void CoupledRun::keep(Snapshot& snapshot) {
  const size_t channels = light_.groups().size() * light_.channels_per_group();
  snapshot(max_correction_C_, begun_, segment_from_s_, segment_end_s_);
  snapshot(max_light_W_, last_light_W_, last_light_s_, is_lit_, held_, continuation_, emitted_);
  if (supply_) snapshot(*supply_);
  snapshot.each(instants_, [&](Instant& instant) {
    bool has_light = !instant.channels.empty();
    snapshot(instant.from_s, instant.length_s, instant.illumination, has_light);
    instant.channels.resize(has_light ? channels : 0);
    snapshot.fixed(instant.channels);
  });
  snapshot.at_most(collected_, instants_.size());
  snapshot.each(traced_, [&](Traced& traced) {
    snapshot(traced.time_s);
    traced.channels.resize(channels);
    snapshot.fixed(traced.channels);
  });
  snapshot(traces_);
  snapshot(power_, rows_);
  snapshot.each(events_, [&](Event& event) { snapshot(event.name, event.time_s, event.rising); });
}

void CoupledRun::follow(Propagator& motion) {
  collect(motion);
  if (motion.step_end_s() >= segment_end_s_ || motion.ended()) exchange(motion);
}

double CoupledRun::charge_C(const PowerSupply& supply) const {
  if (!supply.design().battery) return start_charge_C_;
  return (supply.design().battery->capacity_J - supply.stored_J()) / battery_voltage_V_;
}

}  // namespace photorque
