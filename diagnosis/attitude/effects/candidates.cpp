// The catalogue of candidates, with parameter scales for the machine at hand.
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
      hides_angle ? angles_of_swing(seen, model.platform.axis) : AxisReadings();
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

// The scales of the catalogue are those of platforms on air bearings. For a bicycle wheel or a
// spacecraft they are wrong by many decades. For such machines the scale of every strength is set
// from the recorded rates: its torque over the recorded motion then equals the mean moment of
// inertia times the range of the rates over the duration. Platforms on air bearings and effects
// without a torque are unchanged.
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

Candidate candidate_of(const Effect& effect, const DisturbanceContext& context) {
  Candidate c;
  c.label = effect.kind;
  c.effect = effect;
  c.start = disturbance_of(effect, context);
  for (const Parameter& parameter : c.start.parameters) {
    // Details of a law without a key in the catalogue (the rate below which a contact creeps) are
    // fixed.
    const auto key = std::find_if(effect.keys.begin(), effect.keys.end(),
                                  [&](const EffectKey& k) { return k.key == parameter.key; });
    c.scale.push_back(key == effect.keys.end() ? 0.0 : key->scale);
    c.lowest.push_back(key == effect.keys.end() ? -1e308 : key->lowest);
    c.highest.push_back(key == effect.keys.end() ? 1e308 : key->highest);
    c.searched.push_back(key != effect.keys.end() && key->searched);
  }
  return c;
}

}  // namespace

Candidate candidate_of(const EmpiricalLaw& law) {
  Candidate c;
  c.label = "unknown in " + law.variable + ": " + law.description;
  c.variable = law.variable;
  c.law = law;
  c.start = law.disturbance;
  for (size_t p = 0; p < law.disturbance.parameters.size(); ++p) {
    // Exponents and time constants are searched.
    const bool own = p < law.shape.first_coefficient();
    c.scale.push_back(own ? law.own_scale : law.scale);
    c.lowest.push_back(own ? law.lowest : -1e308);
    c.highest.push_back(own ? law.highest : 1e308);
    c.searched.push_back(own);
  }
  return c;
}

namespace {

CoveredMotion covered_by(const std::vector<Observation>& runs) {
  CoveredMotion covered;
  for (const Observation& seen : runs) {
    covered.duration_s = std::max(covered.duration_s, seen.time_s.back());
    const Observation last = seen.part(seen.blocks() - 1, seen.blocks());
    covered.charge_C = std::max(covered.charge_C, std::abs(last.initial_charge_C));
    double dimmest_A = 1e308, brightest_A = 0.0;
    for (const ZeroOrderHold& held : seen.schedule.held) {
      if (held.lamps_as_stated == 0.0) {
        dimmest_A = std::min(dimmest_A, held.led_current_A);
        brightest_A = std::max(brightest_A, held.led_current_A);
      }
      covered.has_commands = covered.has_commands || held.commands_torque();
      covered.has_forces = covered.has_forces || held.commands_force();
      covered.has_wheel = covered.has_wheel || held.wheel != WheelSpeeds{};
    }
    // Constant light is indistinguishable from a draught, so its current must change by this
    // fraction.
    constexpr double least_change = 0.05;
    covered.led_current_A = std::max(covered.led_current_A, brightest_A);
    covered.has_lamps = covered.has_lamps || dimmest_A < (1.0 - least_change) * brightest_A;
    for (size_t i = 0; i < seen.blocks(); ++i) {
      Vec3 rate_rad_s = Vec3::Zero();
      for (int k = 0; k < 3; ++k) {
        if (seen.gyro_rows[i][k] > 0.0) rate_rad_s[k] = seen.gyro_rad_s[i][k];
      }
      covered.rate_rad_s = std::max(covered.rate_rad_s, rate_rad_s.norm());
      const auto scalar = [&](Scalar s) {
        const bool is_read = seen.rows_of(i, vector_channels + static_cast<int>(s)) > 0.0;
        return is_read ? std::abs(seen.scalar[static_cast<size_t>(s)].value[i]) : 0.0;
      };
      covered.rate_rad_s = std::max(covered.rate_rad_s, scalar(Scalar::rate_magnitude));
      for (const Scalar lean : {Scalar::tilt, Scalar::roll, Scalar::pitch}) {
        covered.tilt_rad = std::max(covered.tilt_rad, scalar(lean));
      }
      if (!(seen.attitude_rows[i] > 0.0)) continue;
      const double up = (seen.attitude[i] * Vec3::UnitZ()).z();
      covered.tilt_rad = std::max(covered.tilt_rad, std::acos(std::clamp(up, -1.0, 1.0)));
    }
  }
  return covered;
}

// Whether some recorded attitude differs from the first of its run by a large angle.
bool turns(const std::vector<Observation>& runs) {
  constexpr double far_rad = 0.3;
  return std::any_of(runs.begin(), runs.end(), [&](const Observation& seen) {
    for (const ScalarReadings& read : seen.scalar) {
      const auto [least, most] = std::minmax_element(read.value.begin(), read.value.end());
      const auto s = static_cast<int>(&read - seen.scalar.data());
      if (channel_traits(vector_channels + s).measures == Measures::angle && least != most &&
          *most - *least > far_rad) {
        return true;
      }
    }
    size_t first = 0;
    while (first < seen.blocks() && !(seen.attitude_rows[first] > 0.0)) ++first;
    for (size_t i = first; i < seen.blocks(); ++i) {
      if (!(seen.attitude_rows[i] > 0.0)) continue;
      const Quat turn = seen.attitude[first].conjugate() * seen.attitude[i];
      if (turn_vector(turn).norm() > far_rad) return true;
    }
    return false;
  });
}

// Rates about an axis from a gyro, or from angles over a sixteenth of the run.
std::vector<double> gyro_or_angle_rates(const Observation& seen, const Vec3& axis) {
  std::vector<double> rate_rad_s;
  for (size_t i = 0; i < seen.blocks(); ++i) {
    if (const auto along_rad_s = rate_along(seen, i, axis)) rate_rad_s.push_back(*along_rad_s);
  }
  if (!rate_rad_s.empty() || !seen.has_some_attitude()) return rate_rad_s;
  const AxisReadings angle = angles_about(seen, axis, 0, seen.blocks());
  const size_t across = std::max<size_t>(1, angle.value.size() / 16);
  for (size_t i = across; i < angle.value.size(); ++i) {
    rate_rad_s.push_back((angle.value[i] - angle.value[i - across]) /
                         (angle.time_s[i] - angle.time_s[i - across]));
  }
  return rate_rad_s;
}

// Whether every run rotates in one direction about `axis` and slows down; it may stop.
bool only_slows_down(const std::vector<Observation>& runs, const Vec3& axis) {
  return std::all_of(runs.begin(), runs.end(), [&](const Observation& seen) {
    const std::vector<double> rate_rad_s = gyro_or_angle_rates(seen, axis);
    if (rate_rad_s.empty()) return false;
    const auto [least, most] = std::minmax_element(rate_rad_s.begin(), rate_rad_s.end());
    // Fraction of the largest rate that noise may produce for a wheel at rest or in a short
    // segment.
    constexpr double little = 0.02;
    return std::min(-*least, *most) < little * std::max(-*least, *most) &&
           std::abs(rate_rad_s.back()) < (1.0 + little) * std::abs(rate_rad_s.front());
  });
}

// Places of a sliding body, and its velocities by central differences over plus and minus an eighth
// of the run.
struct Path {
  std::vector<Vec2> place_m, velocity_m_s;
};

Path path_of(const Observation& seen) {
  Path path;
  std::vector<Vec2>&place_m = path.place_m, &velocity = path.velocity_m_s;
  std::vector<double> time_s;
  const auto x = static_cast<size_t>(Scalar::position_x), y = x + 1;
  for (size_t i = 0; i < seen.blocks(); ++i) {
    if (!(seen.rows_of(i, vector_channels + static_cast<int>(x)) > 0.0) ||
        !(seen.rows_of(i, vector_channels + static_cast<int>(y)) > 0.0)) {
      continue;
    }
    place_m.emplace_back(seen.scalar[x].value[i], seen.scalar[y].value[i]);
    time_s.push_back(seen.time_s[i]);
  }
  const size_t reach = std::max<size_t>(1, place_m.size() / 8);
  for (size_t i = reach; i + reach < place_m.size(); ++i) {
    velocity.push_back((place_m[i + reach] - place_m[i - reach]) /
                       (time_s[i + reach] - time_s[i - reach]));
  }
  return path;
}

// Whether the sliding body moves in one direction and slows down in every run; it may stop.
bool slides_until_rest(const std::vector<Observation>& runs) {
  return std::ranges::all_of(runs, [](const Observation& seen) {
    const auto [place_m, velocity] = path_of(seen);
    if (velocity.size() < 2) return false;
    const Vec2 start = velocity.front();
    constexpr double along = 0.95, slower = 0.8, little = 0.1;
    // A swinging body returns towards its start. It may do so within the interval of one velocity
    // difference, so the positions are tested too.
    double farthest_m = 0.0, back_m = 0.0;
    for (const Vec2& place : place_m) {
      const double out_m = (place - place_m.front()).dot(start.normalized());
      farthest_m = std::max(farthest_m, out_m);
      back_m = std::max(back_m, farthest_m - out_m);
    }
    if (back_m > little * farthest_m) return false;
    return velocity.back().norm() < slower * start.norm() &&
           std::ranges::all_of(velocity, [&](const Vec2& now) {
             return now.norm() < little * start.norm() ||
                    now.dot(start) > along * now.norm() * start.norm();
           });
  });
}

// Whether a candidate of the expected size makes the motion depend on the attitude.
bool needs_attitude(const Candidate& c, AttitudeModel model) {
  model.disturbances.push_back(c.at_expected_size());
  return depends_on_attitude(model);
}

// Whether the attitudes about one axis lie within a radian.
bool swings_little(const std::vector<Observation>& runs) {
  constexpr double little_rad = 1.0;
  bool sees = false;
  double least_rad = 0.0, most_rad = 0.0;
  Quat first = Quat::Identity();
  for (const Observation& seen : runs) {
    for (size_t i = 0; i < seen.blocks(); ++i) {
      if (!(seen.attitude_rows[i] > 0.0)) continue;
      if (!sees) first = seen.attitude[i];
      sees = true;
      const Vec3 turn_rad = turn_vector(seen.attitude[i] * first.conjugate());
      least_rad = std::min(least_rad, turn_rad.minCoeff());
      most_rad = std::max(most_rad, turn_rad.maxCoeff());
    }
  }
  return sees && most_rad - least_rad < little_rad;
}

// Neither rates alone nor a body that does not swing determine the zero of the angle. The zero is
// therefore defined as the angle at which a restoring torque vanishes. Components of a restoring
// law that act at this angle are excluded.
void set_zero_at_rest(const AttitudeModel& nominal, Candidate& c) {
  if (!is_restoring(c, nominal)) return;
  AttitudeModel model = nominal;
  for (size_t p = 0; p < c.start.parameters.size(); ++p) {
    if (!c.is_strength(p)) continue;
    model.disturbances = {c.with_strength_alone(p)};
    const PlatformState upright = Dynamics(model).initial_state(Vec3::Zero());
    if (model.platform.axis.dot(disturbance_torques_body_N_m(model, upright).front()) != 0.0) {
      c.scale[p] = 0.0;
    }
  }
}

}  // namespace

Candidates all_candidates(const NominalModel& nominal, const std::vector<Observation>& runs,
                          const Thresholds& limits) {
  const DisturbanceContext context = nominal.context();
  const CoveredMotion covered = covered_by(runs);
  // The experiment of a spacecraft has no latitude.
  const bool floats_in_laboratory =
      !context.platform.has_bearing() && context.environment.latitude_rad != 0.0 &&
      std::any_of(runs.begin(), runs.end(),
                  [](const Observation& seen) { return seen.has_some_attitude(); });
  const auto has_channel = [&](Requirement channel) {
    switch (channel) {
      case Requirement::command:
        return covered.has_commands || covered.has_forces;
      case Requirement::charge:
        return covered.charge_C != 0.0;
      case Requirement::field:
        return nominal.model.environment.magnetic_field_lab_T.norm() > 0.0;
      case Requirement::gravity:
        return context.platform.has_bearing() && context.environment.gravity_lab_m_s2.norm() > 0.0;
      case Requirement::bearing:
        return context.platform.has_bearing();
      case Requirement::air_bearing:
        return context.platform.has_air_bearing();
      case Requirement::laboratory:
        return context.platform.has_bearing() || floats_in_laboratory;
      case Requirement::turning_laboratory:
        return context.platform.has_air_bearing() || floats_in_laboratory;
      case Requirement::wheel:
        return covered.has_wheel;
      case Requirement::lamps:
        return covered.has_lamps;
      case Requirement::plane:
        return context.platform.slides();
      case Requirement::thrust:
        return covered.has_forces;
      case Requirement::none:
        break;
    }
    return true;
  };
  Candidates all{{}, limits};
  for (const Observation& seen : runs) {
    all.longest_run_s = std::max(all.longest_run_s, seen.duration_s());
  }
  for (Effect& effect : catalogue(context)) {
    if (!has_channel(effect.how.needs)) continue;
    // A law without parameters is not a candidate if the nominal model contains it.
    const auto& acting = nominal.model.disturbances;
    const bool acts = std::any_of(acting.begin(), acting.end(),
                                  [&](const Disturbance& d) { return d.kind == effect.kind; });
    if (effect.keys.empty() && acts) continue;
    // For rotation about one axis without known torques, all torques are relative to the inertia,
    // so its error is not identifiable.
    if (effect.how.inertia_change_kg_m2 != nullptr && context.platform.turns_about_one_axis() &&
        !covered.has_commands) {
      continue;
    }
    for (EffectKey& key : effect.keys) {
      if (key.is_largest_recorded) key.start = {covered.led_current_A};
    }
    all.list.push_back(candidate_of(effect, context));
  }
  const double torque_N_m = 5e-6;
  for (const EmpiricalLaw& law : empirical_laws(covered, torque_N_m)) {
    all.list.push_back(candidate_of(law));
  }
  scale_to_machine(nominal, runs, all.list);
  // The rotation of a sliding body may not be observed.
  const bool sees_turn = std::any_of(runs.begin(), runs.end(), [](const Observation& seen) {
    return seen.has_some_attitude() || seen.has_gyro;
  });
  if (context.platform.slides() && !sees_turn) {
    std::erase_if(all.list, [](const Candidate& c) { return !is_force(c.effect.how.needs); });
  }
  // If yaw hardly changes, laws of yaw, and forces that rotate with the body, are indistinguishable
  // from a constant.
  if (!context.platform.has_air_bearing() && !turns(runs)) {
    const bool always = depends_on_attitude(nominal.model);
    std::erase_if(all.list, [&](const Candidate& c) {
      const bool turns_along =
          !always && c.effect.how.needs == Requirement::plane && needs_attitude(c, nominal.model);
      return c.variable == "yaw" || c.variable == "tilt" || turns_along;
    });
  }
  if (context.platform.turns_about_one_axis()) {
    // About a level axis the yaw is constant, and about an upright axis the tilt is. A law of the
    // constant angle would duplicate another law.
    const bool is_level = std::abs(context.platform.axis.z()) < 0.5;
    std::erase_if(all.list,
                  [&](const Candidate& c) { return c.variable == (is_level ? "yaw" : "tilt"); });
    // About a level axis a weight exerts a restoring torque, and a twisted line a nearly equal one.
    // A sliding body has no known line. One that turns often hangs on none, nor one whose angles
    // show that it only slows down, over more than a turn.
    const bool has_weight =
        context.platform.slides() || std::ranges::any_of(all.list, [&](const Candidate& c) {
          return c.effect.how.needs == Requirement::gravity && is_restoring(c, nominal.model);
        });
    const bool sees_angle =
        std::ranges::any_of(runs, [](const Observation& seen) { return seen.has_some_attitude(); });
    const Vec3& axis = context.platform.axis;
    const bool coasts = sees_angle && !turns_less(runs, axis, 1.0) && only_slows_down(runs, axis);
    const bool has_line = !has_weight && !coasts && turns_less(runs, axis, most_turns_of_line);
    std::erase_if(all.list, [&](const Candidate& c) {
      return !has_line && c.effect.how.needs == Requirement::bearing &&
             is_restoring(c, nominal.model);
    });
    const bool swings_freely = !covered.has_commands && swings(runs, context.platform.axis);
    if ((!sees_angle || (!is_level && !swings_freely)) && !context.platform.slides()) {
      for (Candidate& c : all.list) set_zero_at_rest(nominal.model, c);
    }
    // A steady torque is indistinguishable from an error of the angle's zero in three cases: in
    // small swings under a weight, beside a spring, and in swings of which only rates are measured.
    const bool hides_steady =
        sees_angle && is_level ? has_weight && swings_little(runs) : swings_freely;
    if (hides_steady && !context.platform.slides()) {
      std::erase_if(all.list, [](const Candidate& c) { return c.effect.how.steady; });
    }
    // If the nominal model contains no weight, the sag of a structure would only imitate a weight.
    const bool states_weight =
        std::ranges::any_of(nominal.model.disturbances, [](const Disturbance& d) {
          return find_kind(d.kind) != nullptr &&
                 find_kind(d.kind)->screening.needs == Requirement::gravity;
        });
    std::erase_if(all.list, [&](const Candidate& c) {
      return !states_weight && c.effect.how.needs == Requirement::gravity && !c.lowest.empty() &&
             c.lowest.front() == 0.0 && is_restoring(c, nominal.model);
    });
  }
  // While the rate keeps its sign, friction equals a steady torque, and its sign is known.
  if (context.platform.turns_about_one_axis() && only_slows_down(runs, context.platform.axis) &&
      std::erase_if(all.list, [](const Candidate& c) { return c.effect.how.steady; }) > 0) {
    all.remark =
        "it rotates in one sense only: friction cannot be distinguished from another constant "
        "torque";
  }
  if (context.platform.slides() && slides_until_rest(runs) &&
      std::erase_if(all.list, [](const Candidate& c) {
        return c.effect.how.steady && c.effect.how.needs == Requirement::plane;
      }) > 0) {
    all.remark =
        "it slides along a straight line and only becomes slower: friction is not distinguished "
        "from a slope or a constant force";
  }
  // Without an attitude state, effects that depend on it cannot be evaluated.
  if (nominal.model.holds_attitude) {
    std::erase_if(all.list, [&](const Candidate& c) { return needs_attitude(c, nominal.model); });
  }
  return all;
}

}  // namespace photorque
