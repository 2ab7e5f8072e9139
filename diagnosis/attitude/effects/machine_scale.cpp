// Expected sizes of the candidates on machines other than platforms on air bearings.
#include <algorithm>
#include <array>
#include <cmath>

#include "attitude/estimation/axis_readings.h"
#include "attitude/estimation/swing.h"
#include "attitude/propagation/run.h"
#include "diagnosis/attitude/effects/trial.h"

namespace photorque {
namespace {

// Sampled motion of one run: some states from the readings, and the scale of the acceleration.
struct ReadMotion {
  std::vector<PlatformState> states;
  std::vector<double> turned_rad = {};  // angle about the only axis in each state, with whole turns
  double acceleration_rad_s2 = 0.0;
  double acceleration_m_s2 = 0.0;  // for a sliding body
};

// Position and velocity of a sliding body at block `i`, from the readings.
std::array<double, 4> place_at(const Observation& seen, size_t i, size_t reach) {
  std::array<double, 4> place{};
  const size_t from = i - std::min(i, reach), to = std::min(seen.blocks() - 1, i + reach);
  for (int k = 0; k < 2; ++k) {
    const auto at = static_cast<size_t>(k);
    const int position = static_cast<int>(Scalar::position_x) + k,
              velocity = static_cast<int>(Scalar::velocity_x) + k;
    const auto read = [&](int scalar, size_t block) {
      return seen.rows_of(block, vector_channels + scalar) > 0.0;
    };
    const auto value = [&](int scalar, size_t block) {
      return seen.scalar[static_cast<size_t>(scalar)].value[block];
    };
    if (read(position, i)) place[at] = value(position, i);
    if (read(velocity, i)) {
      place[2 + at] = value(velocity, i);
    } else if (to > from && read(position, from) && read(position, to)) {
      place[2 + at] =
          (value(position, to) - value(position, from)) / (seen.time_s[to] - seen.time_s[from]);
    }
  }
  return place;
}

Vec3 rate_at(const Observation& seen, size_t i, size_t reach) {
  Vec3 rate = Vec3::Zero();
  if (seen.has_some_attitude()) {
    const size_t from = i - std::min(i, reach), to = std::min(seen.blocks() - 1, i + reach);
    if (seen.attitude_rows[from] > 0.0 && seen.attitude_rows[to] > 0.0 && to > from) {
      const Quat turn = seen.attitude[from].conjugate() * seen.attitude[to];
      rate = turn_vector(turn) / (seen.time_s[to] - seen.time_s[from]);
    }
  }
  if (seen.rows_of(i, vector_channels + static_cast<int>(Scalar::rate_magnitude)) > 0.0) {
    // The axis is unknown: the rate is assumed to be equal about all three.
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
  // Distance of attitudes [blocks] from which a rate is computed.
  const size_t reach = std::max<size_t>(1, seen.blocks() / 8);
  ReadMotion motion;
  Vec3 least = Vec3::Constant(1e308), most = -least, slowest = least, fastest = most;
  const int translation = Dynamics(model).first_of_translation();
  const bool hides_angle = model.platform.turns_about_one_axis() && !seen.has_some_attitude();
  const AxisReadings swing =
      hides_angle ? angles_from_rates(seen, model.platform.axis) : AxisReadings();
  const std::vector<double> angles_rad = seen.angles_rad(model.platform.axis, 0, seen.blocks());
  size_t at_swing = 0;
  for (size_t i = 0; i < seen.blocks(); i += stride) {
    double turned_rad = std::isnan(angles_rad[i]) ? 0.0 : angles_rad[i];
    PlatformState state = Dynamics(model).initial_state(rate_at(seen, i, reach));
    state.time_s = seen.time_s[i];
    if (seen.has_some_attitude() && seen.attitude_rows[i] > 0.0) {
      state.lab_from_body = seen.attitude[i];
    }
    while (at_swing < swing.row.size() && swing.row[at_swing] < i) ++at_swing;
    if (at_swing < swing.row.size()) {
      turned_rad = swing.value[at_swing];
      state.lab_from_body = Eigen::AngleAxisd(turned_rad, model.platform.axis);
    }
    if (translation >= 0) {
      const std::array<double, 4> place = place_at(seen, i, reach);
      std::copy(place.begin(), place.end(), state.extra.begin() + (translation - component::extra));
      const Vec3 velocity(place[2], place[3], 0.0);
      slowest = slowest.cwiseMin(velocity);
      fastest = fastest.cwiseMax(velocity);
    }
    least = least.cwiseMin(state.rate_body_rad_s);
    most = most.cwiseMax(state.rate_body_rad_s);
    motion.states.push_back(std::move(state));
    motion.turned_rad.push_back(turned_rad);
  }
  motion.acceleration_rad_s2 = (most - least).norm() / seen.duration_s();
  if (translation >= 0) motion.acceleration_m_s2 = (fastest - slowest).norm() / seen.duration_s();
  return motion;
}

// Mean square of the torque of one disturbance over the motion [N² m²], for a one-axis platform
// about its axis; for a force on a sliding body of the force [N²].
double mean_square_action(const Disturbance& disturbance, const AttitudeModel& nominal,
                          const std::vector<Observation>& runs,
                          const std::vector<ReadMotion>& motions) {
  AttitudeModel model = nominal;
  model.disturbances = {disturbance};
  const bool pushes = find_kind(disturbance.kind) != nullptr &&
                      is_force(find_kind(disturbance.kind)->screening.needs);
  const Platform& platform = model.platform;
  if (platform.slides()) model.disturbances.push_back(translation());
  double sum = 0.0, count = 0.0;
  for (size_t run = 0; run < runs.size(); ++run) {
    model.schedule = runs[run].schedule;
    for (size_t i = 0; i < motions[run].states.size(); ++i) {
      const PlatformState& state = motions[run].states[i];
      PlatformState own =
          Dynamics(model).initial_state(state.rate_body_rad_s, motions[run].turned_rad[i]);
      own.time_s = state.time_s;
      own.lab_from_body = state.lab_from_body;
      // Position and velocity are the last four states.
      if (platform.slides()) {
        std::copy(state.extra.end() - 4, state.extra.end(), own.extra.end() - 4);
      }
      Vec3 action = pushes ? disturbance_forces_lab_N(model, own).front()
                           : disturbance_torques_body_N_m(model, own).front();
      if (!pushes && platform.turns_about_one_axis()) {
        action = platform.axis.dot(action) * platform.axis;
      }
      sum += action.squaredNorm();
      count += 1.0;
    }
  }
  return count > 0.0 ? sum / count : 0.0;
}

// Excludes components of an array that have no effect about the single axis if another has one.
void drop_ineffective_components(const std::vector<double>& actions, Candidate& c) {
  constexpr double nothing = 1e-9;
  for (size_t p = 0; p < actions.size(); ++p) {
    double most = 0.0;
    for (size_t other = 0; other < actions.size(); ++other) {
      if (c.start.parameters[other].key == c.start.parameters[p].key) {
        most = std::max(most, actions[other]);
      }
    }
    if (c.is_strength(p) && most > 0.0 && actions[p] < nothing * most) c.scale[p] = 0.0;
  }
}

}  // namespace

void scale_to_machine(const NominalModel& nominal, const std::vector<Observation>& runs,
                      std::vector<Candidate>& candidates) {
  const Platform& platform = nominal.model.platform;
  if (platform.has_air_bearing()) return;
  AttitudeModel bare = nominal.model;
  bare.disturbances.clear();
  if (platform.slides()) bare.disturbances.push_back(translation());
  // A few runs suffice.
  constexpr size_t most_runs = 8;
  std::vector<Observation> some;
  std::vector<ReadMotion> motions;
  double square = 0.0, square_m2_s4 = 0.0;
  const size_t stride = std::max<size_t>(1, runs.size() / most_runs);
  for (size_t run = 0; run < runs.size(); run += stride) {
    some.push_back(runs[run]);
    motions.push_back(read_motion(bare, runs[run]));
    square += motions.back().acceleration_rad_s2 * motions.back().acceleration_rad_s2;
    square_m2_s4 += motions.back().acceleration_m_s2 * motions.back().acceleration_m_s2;
  }
  const double torque_N_m = platform.inertia_kg_m2.trace() / 3.0 *
                            std::sqrt(square / static_cast<double>(motions.size()));
  const double force_N =
      platform.mass_kg * std::sqrt(square_m2_s4 / static_cast<double>(motions.size()));
  if (!(torque_N_m > 0.0) && !(force_N > 0.0)) return;
  for (Candidate& c : candidates) {
    const double expected = is_force(c.effect.how.needs) ? force_N : torque_N_m;
    if (!(expected > 0.0)) continue;
    std::vector<double> actions(c.start.parameters.size(), 0.0);
    for (size_t p = 0; p < c.start.parameters.size(); ++p) {
      if (!c.is_strength(p)) continue;
      const double now =
          std::sqrt(mean_square_action(c.with_strength_alone(p), nominal.model, some, motions));
      if (now > 0.0 && std::isfinite(now)) c.scale[p] *= expected / now;
      actions[p] = now;
    }
    if (platform.turns_about_one_axis()) drop_ineffective_components(actions, c);
  }
}

}  // namespace photorque
