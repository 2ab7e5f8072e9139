#include "attitude/estimation/hypothesis.h"

namespace photorque {

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

PlatformState first_state(const AttitudeModel& model, const Observation& seen) {
  size_t first = 0;
  while (seen.attitude_rows[first] == 0.0) ++first;
  size_t next = first + 1;
  while (seen.attitude_rows[next] == 0.0) ++next;
  const Vec3 rate_lab = rotation_vector(seen.attitude[next] * seen.attitude[first].conjugate()) /
                        (seen.time_s[next] - seen.time_s[first]);
  Vec3 rate = seen.attitude[first].conjugate() * rate_lab;
  if ((seen.gyro_rows[first].array() > 0.0).all()) rate = seen.gyro_rad_s[first];
  PlatformState state = Dynamics(model).initial_state(rate);
  state.time_s = seen.time_s.front();
  const double back_s = seen.time_s.front() - seen.time_s[first];
  const Vec3 turn = back_s * rate;
  state.lab_from_body = seen.attitude[first];
  if (turn.norm() > 0.0) {
    state.lab_from_body =
        state.lab_from_body * Quat(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
  }
  state.charge_drawn_C = seen.initial_charge_C;
  return state;
}

std::vector<RunStart> seen_starts(const Hypothesis& h, const std::vector<Observation>& runs) {
  std::vector<double> own;
  for (const Free& f : h.free) {
    if (f.per_run) own.push_back(f.mean);
  }
  std::vector<RunStart> starts;
  for (const Observation& seen : runs) starts.push_back({first_state(h.model, seen), own});
  return starts;
}

}  // namespace photorque
