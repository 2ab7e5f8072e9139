// The candidates that recordings can reveal.
#include <algorithm>
#include <cmath>
#include <functional>

#include "attitude/estimation/axis_readings.h"
#include "attitude/estimation/swing.h"
#include "attitude/propagation/run.h"
#include "diagnosis/attitude/effects/trial.h"

namespace photorque {
namespace {

// Sets the traits that follow from the parameters.
void set_linearity(Candidate& c) {
  c.parameters = c.start.parameters.size();
  c.is_linear = c.parameters > 0 && std::ranges::none_of(c.searched, std::identity());
  c.has_strength = !std::ranges::all_of(c.searched, std::identity());
}

Candidate candidate_of(const Effect& effect, const DisturbanceContext& context) {
  Candidate c;
  c.name = effect.kind;
  c.effect = effect;
  c.start = disturbance_of(effect, context);
  for (const Parameter& parameter : c.start.parameters) {
    // Details of a law without a key in the catalogue (the rate below which a contact creeps) are
    // fixed.
    const auto key = std::ranges::find(effect.keys, parameter.key, &EffectKey::key);
    const bool is_known = key != effect.keys.end();
    c.scale.push_back(is_known ? key->scale : 0.0);
    c.lowest.push_back(is_known ? key->lowest : -1e308);
    c.highest.push_back(is_known ? key->highest : 1e308);
    c.searched.push_back(is_known && key->searched);
  }
  set_linearity(c);
  c.is_fast = effect.how.fast;
  c.is_limit_of_swinging = effect.how.inertia_change_kg_m2 != nullptr;
  c.is_of_instrument = c.start.stage == Stage::measurement;
  // Several appendages with different frequencies and axes are distinguishable.
  c.swings = effect.how.scan == Scan::mode;
  if (c.swings) c.most = 2;
  return c;
}

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

bool any_attitude(const std::vector<Observation>& runs) {
  return std::ranges::any_of(runs, &Observation::has_some_attitude);
}

// Whether platform, environment and recordings have what an effect requires.
bool is_met(Requirement needs, const NominalModel& nominal, const CoveredMotion& covered,
            const std::vector<Observation>& runs) {
  const Platform& platform = nominal.model.platform;
  const Environment& environment = nominal.model.environment;
  const auto floats_in_laboratory = [&] {
    // The experiment of a spacecraft has no latitude.
    return !platform.has_bearing() && environment.latitude_rad != 0.0 && any_attitude(runs);
  };
  switch (needs) {
    case Requirement::command:
      return covered.has_commands || covered.has_forces;
    case Requirement::charge:
      return covered.charge_C != 0.0;
    case Requirement::field:
      return environment.magnetic_field_lab_T.norm() > 0.0;
    case Requirement::gravity:
      return platform.has_bearing() && environment.gravity_lab_m_s2.norm() > 0.0;
    case Requirement::bearing:
      return platform.has_bearing();
    case Requirement::air_bearing:
      return platform.has_air_bearing();
    case Requirement::laboratory:
      return platform.has_bearing() || floats_in_laboratory();
    case Requirement::turning_laboratory:
      return platform.has_air_bearing() || floats_in_laboratory();
    case Requirement::wheel:
      return covered.has_wheel;
    case Requirement::lamps:
      return covered.has_lamps;
    case Requirement::plane:
      return platform.slides();
    case Requirement::thrust:
      return covered.has_forces;
    case Requirement::none:
      break;
  }
  return true;
}

// Effects of the catalogue whose requirements are met, and empirical laws.
std::vector<Candidate> catalogue_for(const NominalModel& nominal, const CoveredMotion& covered,
                                     const std::vector<Observation>& runs) {
  const DisturbanceContext context = nominal.context();
  std::vector<Candidate> list;
  for (Effect& effect : catalogue(context)) {
    if (!is_met(effect.how.needs, nominal, covered, runs)) continue;
    // A law without parameters is not a candidate if the nominal model contains it.
    const bool acts = std::ranges::find(nominal.model.disturbances, effect.kind,
                                        &Disturbance::kind) != nominal.model.disturbances.end();
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
    list.push_back(candidate_of(effect, context));
  }
  // Typical of platforms on air bearings; scale_to_machine() corrects it for others.
  constexpr double typical_torque_N_m = 5e-6;
  for (const EmpiricalLaw& law : empirical_laws(covered, typical_torque_N_m)) {
    list.push_back(candidate_of(law));
  }
  return list;
}

// If yaw hardly changes, laws of yaw, and forces that rotate with the body, are indistinguishable
// from a constant.
void omit_laws_of_constant_yaw(const AttitudeModel& nominal, std::vector<Candidate>& list) {
  const bool always = depends_on_attitude(nominal);
  std::erase_if(list, [&](const Candidate& c) {
    const bool turns_along =
        !always && c.effect.how.needs == Requirement::plane && needs_attitude(c, nominal);
    return c.variable == "yaw" || c.variable == "tilt" || turns_along;
  });
}

// Omits candidates that rotation about one axis does not distinguish from others.
void omit_indistinguishable_about_axis(const AttitudeModel& nominal, const CoveredMotion& covered,
                                       const std::vector<Observation>& runs,
                                       std::vector<Candidate>& list) {
  const Platform& platform = nominal.platform;
  const Vec3& axis = platform.axis;
  // About a level axis the yaw is constant, and about an upright axis the tilt is. A law of the
  // constant angle would duplicate another law.
  const bool is_level = std::abs(axis.z()) < 0.5;
  std::erase_if(list,
                [&](const Candidate& c) { return c.variable == (is_level ? "yaw" : "tilt"); });
  // About a level axis a weight exerts a restoring torque, and a twisted line a nearly equal one.
  // A sliding body has no known line. One that turns often hangs on none, nor one whose angles
  // show that it only slows down, over more than a turn.
  const bool has_weight =
      platform.slides() || std::ranges::any_of(list, [&](const Candidate& c) {
        return c.effect.how.needs == Requirement::gravity && is_restoring(c, nominal);
      });
  const bool sees_angle = any_attitude(runs);
  const bool coasts = sees_angle && !turns_less(runs, axis, 1.0) && only_slows_down(runs, axis);
  const bool has_line = !has_weight && !coasts && turns_less(runs, axis, most_turns_of_line);
  std::erase_if(list, [&](const Candidate& c) {
    return !has_line && c.effect.how.needs == Requirement::bearing && is_restoring(c, nominal);
  });
  const bool swings_freely = !covered.has_commands && swings(runs, axis);
  if ((!sees_angle || (!is_level && !swings_freely)) && !platform.slides()) {
    for (Candidate& c : list) set_zero_at_rest(nominal, c);
  }
  // A steady torque is indistinguishable from an error of the angle's zero in three cases: in
  // small swings under a weight, beside a spring, and in swings of which only rates are measured.
  const bool hides_steady =
      sees_angle && is_level ? has_weight && swings_little(runs) : swings_freely;
  if (hides_steady && !platform.slides()) {
    std::erase_if(list, [](const Candidate& c) { return c.effect.how.steady; });
  }
  // If the nominal model contains no weight, the sag of a structure would only imitate a weight.
  const bool states_weight = std::ranges::any_of(nominal.disturbances, [](const Disturbance& d) {
    return find_kind(d.kind) != nullptr &&
           find_kind(d.kind)->screening.needs == Requirement::gravity;
  });
  std::erase_if(list, [&](const Candidate& c) {
    return !states_weight && c.effect.how.needs == Requirement::gravity && !c.lowest.empty() &&
           c.lowest.front() == 0.0 && is_restoring(c, nominal);
  });
}

// While the rate keeps its sign, friction equals a steady torque or force, and its sign is known.
void omit_steady_while_slowing(const Platform& platform, const std::vector<Observation>& runs,
                               Candidates& all) {
  if (platform.turns_about_one_axis() && only_slows_down(runs, platform.axis) &&
      std::erase_if(all.list, [](const Candidate& c) { return c.effect.how.steady; }) > 0) {
    all.remark =
        "it rotates in one sense only: friction cannot be distinguished from another constant "
        "torque";
  }
  if (platform.slides() && slides_until_rest(runs) &&
      std::erase_if(all.list, [](const Candidate& c) {
        return c.effect.how.steady && c.effect.how.needs == Requirement::plane;
      }) > 0) {
    all.remark =
        "it slides along a straight line and only becomes slower: friction is not distinguished "
        "from a slope or a constant force";
  }
}

}  // namespace

Candidate candidate_of(const EmpiricalLaw& law) {
  Candidate c;
  c.name = "unknown in " + law.variable + ": " + law.description;
  c.is_empirical = true;
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
  set_linearity(c);
  return c;
}

Candidates all_candidates(const NominalModel& nominal, const std::vector<Observation>& runs,
                          const Thresholds& limits) {
  const AttitudeModel& model = nominal.model;
  const Platform& platform = model.platform;
  const CoveredMotion covered = covered_by(runs);
  Candidates all{catalogue_for(nominal, covered, runs), limits};
  for (const Observation& seen : runs) {
    all.longest_run_s = std::max(all.longest_run_s, seen.duration_s());
  }
  scale_to_machine(nominal, runs, all.list);
  // The rotation of a sliding body may not be observed.
  const bool sees_turn = std::ranges::any_of(
      runs, [](const Observation& seen) { return seen.has_some_attitude() || seen.has_gyro; });
  if (platform.slides() && !sees_turn) {
    std::erase_if(all.list, [](const Candidate& c) { return !is_force(c.effect.how.needs); });
  }
  if (!platform.has_air_bearing() && !turns(runs)) omit_laws_of_constant_yaw(model, all.list);
  if (platform.turns_about_one_axis()) {
    omit_indistinguishable_about_axis(model, covered, runs, all.list);
  }
  omit_steady_while_slowing(platform, runs, all);
  // Without an attitude state, effects that depend on it cannot be evaluated.
  if (model.holds_attitude) {
    std::erase_if(all.list, [&](const Candidate& c) { return needs_attitude(c, model); });
  }
  return all;
}

}  // namespace photorque
