#include "diagnosis/attitude/effects/machine_scale.h"

#include <cmath>

#include "attitude/propagation/run.h"

namespace photorque {
namespace {

// Of one run: a few states as they were read, and how much the rates changed.
struct ReadMotion {
  std::vector<PlatformState> states;
  double acceleration_rad_s2 = 0.0;
};

Vec3 rate_at(const Observation& seen, size_t i, size_t reach) {
  Vec3 rate = Vec3::Zero();
  if (seen.sees_some_attitude()) {
    const size_t from = i - std::min(i, reach), to = std::min(seen.blocks() - 1, i + reach);
    if (seen.attitude_rows[from] > 0.0 && seen.attitude_rows[to] > 0.0 && to > from) {
      const Quat turn = seen.attitude[from].conjugate() * seen.attitude[to];
      rate = rotation_vector(turn) / (seen.time_s[to] - seen.time_s[from]);
    }
  }
  if (seen.rows_of(i, vector_channels + static_cast<int>(Scalar::rate_magnitude)) > 0.0) {
    // About which axis is not known: as much about each.
    const double magnitude = seen.scalar[static_cast<size_t>(Scalar::rate_magnitude)].value[i];
    rate = magnitude / std::sqrt(3.0) * Vec3::Ones();
  }
  for (int k = 0; k < 3; ++k) {
    if (seen.gyro_rows[i][k] > 0.0) rate[k] = seen.gyro_rad_s[i][k];
  }
  return rate;
}

ReadMotion read_motion(const AttitudeModel& model, const Observation& seen) {
  constexpr size_t most_states = 40;
  const size_t stride = std::max<size_t>(1, seen.blocks() / most_states);
  // Attitudes so far apart tell a rate.
  const size_t reach = std::max<size_t>(1, seen.blocks() / 8);
  ReadMotion motion;
  Vec3 least = Vec3::Constant(1e308), most = -least;
  for (size_t i = 0; i < seen.blocks(); i += stride) {
    PlatformState state = Dynamics(model).initial_state(rate_at(seen, i, reach));
    state.time_s = seen.time_s[i];
    if (seen.sees_some_attitude() && seen.attitude_rows[i] > 0.0) {
      state.lab_from_body = seen.attitude[i];
    }
    least = least.cwiseMin(state.rate_body_rad_s);
    most = most.cwiseMax(state.rate_body_rad_s);
    motion.states.push_back(std::move(state));
  }
  motion.acceleration_rad_s2 = (most - least).norm() / seen.duration_s();
  return motion;
}

// Mean square of the torque of one disturbance over the motion [N² m²].
double mean_square_torque(const Disturbance& disturbance, const AttitudeModel& nominal,
                          const std::vector<Observation>& runs,
                          const std::vector<ReadMotion>& motions) {
  AttitudeModel model = nominal;
  model.disturbances = {disturbance};
  double sum = 0.0, count = 0.0;
  for (size_t run = 0; run < runs.size(); ++run) {
    model.schedule = runs[run].schedule;
    for (const PlatformState& state : motions[run].states) {
      PlatformState own = Dynamics(model).initial_state(state.rate_body_rad_s);
      own.time_s = state.time_s;
      own.lab_from_body = state.lab_from_body;
      sum += disturbance_torques_body_N_m(model, own).front().squaredNorm();
      count += 1.0;
    }
  }
  return count > 0.0 ? sum / count : 0.0;
}

}  // namespace

void scale_to_machine(const NominalModel& nominal, const std::vector<Observation>& runs,
                      std::vector<Candidate>& candidates) {
  const Platform& platform = nominal.model.platform;
  if (platform.has_air_bearing()) return;
  AttitudeModel bare = nominal.model;
  bare.disturbances.clear();
  // A few runs show what there is to see.
  constexpr size_t most_runs = 8;
  std::vector<Observation> some;
  std::vector<ReadMotion> motions;
  double square = 0.0;
  const size_t stride = std::max<size_t>(1, runs.size() / most_runs);
  for (size_t run = 0; run < runs.size(); run += stride) {
    some.push_back(runs[run]);
    motions.push_back(read_motion(bare, runs[run]));
    square += motions.back().acceleration_rad_s2 * motions.back().acceleration_rad_s2;
  }
  const double torque_N_m = platform.inertia_kg_m2.trace() / 3.0 *
                            std::sqrt(square / static_cast<double>(motions.size()));
  if (!(torque_N_m > 0.0)) return;
  for (Candidate& c : candidates) {
    for (size_t p = 0; p < c.start.parameters.size(); ++p) {
      if (!c.is_strength(p)) continue;
      Disturbance one = c.start;
      for (Parameter& other : one.parameters) {
        if (&other != &one.parameters[p] &&
            c.is_strength(static_cast<size_t>(&other - one.parameters.data()))) {
          other.value = 0.0;
        }
      }
      one.parameters[p].value = c.scale[p];
      const double now = std::sqrt(mean_square_torque(one, nominal.model, some, motions));
      if (now > 0.0 && std::isfinite(now)) c.scale[p] *= torque_N_m / now;
    }
  }
}

}  // namespace photorque
