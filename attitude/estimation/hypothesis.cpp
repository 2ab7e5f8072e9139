#include "attitude/estimation/hypothesis.h"

#include <algorithm>
#include <array>

#include "attitude/estimation/swing.h"

namespace photorque {

std::vector<SharedParameter> Hypothesis::shared() const {
  std::vector<SharedParameter> result;
  for (const Free& f : free) {
    if (f.per_run) continue;
    result.push_back({f.disturbance, static_cast<size_t>(f.parameter),
                      static_cast<Eigen::Index>(result.size()), parameter(f).value});
  }
  return result;
}

std::vector<SharedParameter> Hypothesis::shared(size_t disturbance) const {
  std::vector<SharedParameter> result = shared();
  std::erase_if(result, [&](const SharedParameter& s) { return s.disturbance != disturbance; });
  return result;
}

AttitudeModel Hypothesis::model_of(size_t run, const Observation& seen) const {
  AttitudeModel result = model;
  result.schedule = seen.schedule;
  size_t own = 0;
  for (const Free& f : free) {
    if (!f.per_run) continue;
    result.disturbances[f.disturbance].parameters[static_cast<size_t>(f.parameter)].value =
        runs[run].own[own++];
  }
  return result;
}

void adapt_to_runs(Hypothesis& h, const std::vector<Observation>& runs) {
  const bool in_pieces =
      std::any_of(runs.begin(), runs.end(), [](const Observation& seen) { return seen.is_piece; });
  const std::vector<Free> before = h.free;
  bool changed = false;
  for (Free& f : h.free) {
    if (!f.per_recording) continue;
    changed = changed || f.per_run == in_pieces;
    f.per_run = !in_pieces;
  }
  if (!changed) return;
  std::vector<std::vector<double>> own(h.runs.size());
  size_t next = 0;  // index among the former per-run parameters
  for (size_t i = 0; i < before.size(); ++i) {
    const Free& f = h.free[i];
    if (f.per_run) {
      for (size_t r = 0; r < h.runs.size(); ++r) {
        own[r].push_back(before[i].per_run ? h.runs[r].own[next] : h.value(f));
      }
    } else if (before[i].per_run) {
      double sum = 0.0;
      for (const RunStart& run : h.runs) sum += run.own[next];
      h.value(f) = sum / static_cast<double>(h.runs.size());
    }
    if (before[i].per_run) ++next;
  }
  for (size_t r = 0; r < h.runs.size(); ++r) h.runs[r].own = std::move(own[r]);
}

namespace {

// The first block from `from` on with is_read(block); the number of blocks if there is none.
template <typename Read>
size_t first_block(const Observation& seen, size_t from, const Read& is_read) {
  size_t i = from;
  while (i < seen.blocks() && !is_read(i)) ++i;
  return i;
}

// Mean body rate between the first attitude and the next.
Vec3 rate_between_attitudes_rad_s(const Observation& seen, size_t first, size_t next) {
  if (next >= seen.blocks()) return Vec3::Zero();
  const Vec3 rate_lab = turn_vector(seen.attitude[next] * seen.attitude[first].conjugate()) /
                        (seen.time_s[next] - seen.time_s[first]);
  return seen.attitude[first].conjugate() * rate_lab;
}

// Position and velocity at the first reading.
void put_place(const Observation& seen, double* place) {
  constexpr int most = 8;
  constexpr std::array positions = {Scalar::position_x, Scalar::position_y},
                       velocities = {Scalar::velocity_x, Scalar::velocity_y};
  for (size_t k = 0; k < 2; ++k) {
    const FirstLine line = first_line(seen, positions[k], most);
    place[k] = line.value;
    place[2 + k] =
        seen.has(velocities[k]) ? first_line(seen, velocities[k], most).value : line.slope_1_s;
  }
}

// Initial conditions of a run from its first readings.
RunStart first_start(const AttitudeModel& model, const Observation& seen,
                     const std::vector<double>& own) {
  const auto has_attitude = [&](size_t i) { return seen.attitude_rows[i] > 0.0; };
  const size_t first = first_block(seen, 0, has_attitude),
               next = first_block(seen, first + 1, has_attitude);
  Vec3 rate = rate_between_attitudes_rad_s(seen, first, next);
  const size_t gyro_at = first < seen.blocks() ? first : 0;
  if ((seen.gyro_rows[gyro_at].array() > 0.0).all()) {
    rate = seen.gyro_rad_s[gyro_at];
  } else if (!seen.sees_attitude()) {
    for (int k = 0; k < 3; ++k) {
      const size_t i = first_block(seen, 0, [&](size_t n) { return seen.gyro_rows[n][k] > 0.0; });
      if (i < seen.blocks()) rate[k] = seen.gyro_rad_s[i][k];
    }
  }
  const Platform& platform = model.platform;
  if (platform.turns_about_one_axis()) rate = platform.axis.dot(rate) * platform.axis;
  Quat attitude = Quat::Identity();
  double turned_rad = 0.0;
  if (first < seen.blocks()) {
    const double back_s = seen.time_s.front() - seen.time_s[first];
    attitude = seen.attitude[first] * turn_by(back_s * rate);
    if (seen.first_angle_rad) turned_rad = *seen.first_angle_rad + back_s * platform.axis.dot(rate);
  } else if (platform.turns_about_one_axis() && !platform.slides()) {
    // Without attitudes, angle zero is the centre of the swing, which the rates alone determine.
    const AxisReadings swing = angles_of_swing(seen, platform.axis);
    if (!swing.value.empty()) turned_rad = swing.value.front();
    attitude = Eigen::AngleAxisd(turned_rad, platform.axis);
  }
  const Dynamics dynamics(model);
  PlatformState state = dynamics.initial_state(rate, turned_rad);
  if (const int place = dynamics.first_of_translation(); place >= 0) {
    put_place(seen, &state.extra[static_cast<size_t>(place - component::extra)]);
  }
  state.time_s = seen.time_s.front();
  state.charge_drawn_C = seen.initial_charge_C;
  state.lab_from_body = attitude;
  return {state, own, turned_rad};
}

}  // namespace

std::vector<RunStart> starts_from_data(const Hypothesis& h, const std::vector<Observation>& runs) {
  std::vector<double> own;
  for (const Free& f : h.free) {
    if (f.per_run) own.push_back(f.mean);
  }
  std::vector<RunStart> starts;
  for (const Observation& seen : runs) starts.push_back(first_start(h.model, seen, own));
  return starts;
}

}  // namespace photorque
