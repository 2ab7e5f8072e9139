#include "diagnosis/attitude/answer.h"

#include <algorithm>
#include <cmath>

#include "attitude/estimation/axis_readings.h"
#include "attitude/estimation/swing.h"
#include "core/constants.h"
#include "core/numerics/linear.h"

namespace photorque {
namespace {

// Angle and rate at some instants of a run.
struct Curve {
  std::vector<double> time_s, angle_rad, rate_rad_s;
  bool hides_zero = false;  // the angle is an integral with an unknown value at the start
};

// Value and slope at one reading of a cubic fitted to `reach` readings on each side.
std::pair<double, double> local_cubic(const AxisReadings& read, size_t at, size_t reach) {
  const size_t first = at - std::min(at, reach), last = std::min(read.row.size(), at + reach + 1);
  const double span_s = read.time_s[last - 1] - read.time_s[first];
  const Eigen::Vector4d c =
      fitted_cubic(read, first, last, read.time_s[at], span_s, read.value[at]);
  return {read.value[at] + c[0], c[1] / span_s};
}

// Half the number of readings of a local cubic: an eighth of a period of a swing, otherwise a
// fortieth of the run; four at least.
size_t reach_of(const AxisReadings& read, double middle) {
  constexpr size_t least = 4;
  size_t passages = 0;
  for (size_t i = 1; i < read.value.size(); ++i) {
    passages += (read.value[i - 1] < middle) != (read.value[i] < middle) ? 1 : 0;
  }
  const size_t parts = std::max<size_t>(40, 8 * passages);
  return std::max(least, read.value.size() / parts / 2);
}

constexpr size_t most_instants = 4000;

// The readings of a body that turns over a weight. Local cubics would smooth its torque.
Curve turning_curve(const AxisReadings& rates, const AxisReadings& angles) {
  Curve curve;
  curve.hides_zero = true;
  const size_t stride = std::max<size_t>(1, rates.row.size() / most_instants);
  for (size_t i = 0; i < rates.row.size(); i += stride) {
    curve.time_s.push_back(rates.time_s[i]);
    curve.angle_rad.push_back(angles.value[i]);
    curve.rate_rad_s.push_back(rates.value[i]);
  }
  return curve;
}

Curve curve_of(const Observation& seen, const Vec3& axis) {
  constexpr size_t fewest = 20;
  const bool sees_angle = seen.has_some_attitude();
  const AxisReadings read = sees_angle ? angles_about(seen, axis, 0, seen.blocks())
                                       : rates_about(seen, axis, 0, seen.blocks());
  Curve curve;
  if (read.row.size() < fewest) return curve;
  double middle = 0.0;
  if (sees_angle) {
    for (const double value : read.value) middle += value / static_cast<double>(read.value.size());
  }
  const size_t reach = reach_of(read, middle),
               stride = std::max<size_t>(1, read.row.size() / most_instants);
  const AxisReadings swing = sees_angle ? AxisReadings() : angles_of_swing(seen, axis);
  if (!sees_angle && swing.row.empty()) {
    const AxisReadings turning = angles_over_weight(seen, axis);
    if (!turning.row.empty()) return turning_curve(read, turning);
  }
  double angle_rad = 0.0;
  for (size_t i = 0; i < read.row.size(); ++i) {
    if (!swing.value.empty()) {
      angle_rad = swing.value[i];
    } else if (!sees_angle && i > 0) {
      angle_rad +=
          0.5 * (read.value[i] + read.value[i - 1]) * (read.time_s[i] - read.time_s[i - 1]);
    }
    if (i % stride != 0) continue;
    const auto [value, slope] = local_cubic(read, i, reach);
    curve.time_s.push_back(read.time_s[i]);
    curve.angle_rad.push_back(sees_angle ? value : angle_rad);
    curve.rate_rad_s.push_back(sees_angle ? slope : value);
  }
  return curve;
}

PlatformState state_at(const AttitudeModel& model, const Curve& curve, size_t i) {
  PlatformState state =
      Dynamics(model).initial_state(curve.rate_rad_s[i] * model.platform.axis, curve.angle_rad[i]);
  state.time_s = curve.time_s[i];
  state.lab_from_body = Eigen::AngleAxisd(curve.angle_rad[i], model.platform.axis);
  return state;
}

// Time integral of the angular acceleration by the model's disturbances along the curve [rad/s].
Eigen::VectorXd impulse_of(const AttitudeModel& model, const Curve& curve) {
  const Vec3& axis = model.platform.axis;
  const double inertia_kg_m2 = axis.dot(model.platform.inertia_kg_m2 * axis);
  Eigen::VectorXd sum(static_cast<Eigen::Index>(curve.time_s.size()));
  double before = 0.0, total = 0.0;
  for (size_t i = 0; i < curve.time_s.size(); ++i) {
    double now = 0.0;
    for (const Vec3& torque : disturbance_torques_body_N_m(model, state_at(model, curve, i))) {
      now += axis.dot(torque) / inertia_kg_m2;
    }
    if (i > 0) total += 0.5 * (now + before) * (curve.time_s[i] - curve.time_s[i - 1]);
    before = now;
    sum[static_cast<Eigen::Index>(i)] = total;
  }
  return sum;
}

// Strength of a law, and the rates that a strength of one scale unit causes in each run [rad/s].
struct Strength {
  size_t law = 0, parameter = 0;
  std::vector<Eigen::VectorXd> rates = {};
  double value = 0.0;
  bool is_used = true;
};

// Fits the used strengths and one initial rate per run to the rates that the stated laws do not
// explain. Returns the residual sum of squares.
double solve(const std::vector<Eigen::VectorXd>& rates, std::vector<Strength>& strengths) {
  constexpr double alike = 1e-5;
  Eigen::Index rows = 0, columns = static_cast<Eigen::Index>(rates.size());
  for (const Eigen::VectorXd& run : rates) rows += run.size();
  for (const Strength& s : strengths) columns += s.is_used ? 1 : 0;
  Eigen::MatrixXd law = Eigen::MatrixXd::Zero(rows, columns);
  Eigen::VectorXd right(rows);
  Eigen::Index row = 0;
  for (size_t run = 0; run < rates.size(); ++run) {
    const Eigen::Index count = rates[run].size();
    right.segment(row, count) = rates[run];
    law.col(static_cast<Eigen::Index>(run)).segment(row, count).setOnes();
    auto column = static_cast<Eigen::Index>(rates.size());
    for (const Strength& s : strengths) {
      if (s.is_used) law.col(column++).segment(row, count) = s.rates[run];
    }
    row += count;
  }
  const Eigen::VectorXd scale = law.colwise().norm().transpose().cwiseMax(1e-300);
  const Eigen::VectorXd found =
      least_squares(law * scale.cwiseInverse().asDiagonal(), right, alike).solution;
  auto column = static_cast<Eigen::Index>(rates.size());
  for (Strength& s : strengths) {
    s.value = s.is_used ? found[column] / scale[column] : 0.0;
    column += s.is_used ? 1 : 0;
  }
  return (right - law * scale.cwiseInverse().asDiagonal() * found).squaredNorm();
}

// The strengths of the candidates' laws, with the rates that they cause along the curves.
std::vector<Strength> strengths_along(const std::vector<Curve>& curves, const AttitudeModel& stated,
                                      const Candidates& all,
                                      const std::vector<size_t>& candidates) {
  std::vector<Strength> strengths;
  for (const size_t c : candidates) {
    for (size_t p = 0; p < all[c].scale.size(); ++p) {
      if (!all[c].is_strength(p) || all[c].start.stage == Stage::measurement) continue;
      AttitudeModel model = stated;
      model.disturbances = {all[c].with_strength_alone(p)};
      Strength strength{c, p};
      for (const Curve& curve : curves) strength.rates.push_back(impulse_of(model, curve));
      strengths.push_back(std::move(strength));
    }
  }
  return strengths;
}

// Strengths of laws within their physical bounds, and the residual sum of squares of the rates.
struct Solution {
  std::vector<Strength> strengths;
  double left = 0.0;
};

Solution solution_along(const std::vector<Curve>& curves, const AttitudeModel& stated,
                        const Candidates& all, const std::vector<size_t>& candidates) {
  std::vector<Eigen::VectorXd> rates;
  for (const Curve& curve : curves) {
    const Eigen::Map<const Eigen::VectorXd> rate(curve.rate_rad_s.data(),
                                                 static_cast<Eigen::Index>(curve.time_s.size()));
    rates.emplace_back(rate - impulse_of(stated, curve));
  }
  Solution result{strengths_along(curves, stated, all, candidates)};
  const auto beyond = [&](const Strength& s) {
    const double value = s.value * all[s.law].scale[s.parameter];
    const bool is_beyond = value < all[s.law].lowest[s.parameter] ||
                           value > all[s.law].highest[s.parameter] ||
                           (value < 0.0 && braking_power(all[s.law], stated));
    return is_beyond ? std::abs(s.value) : 0.0;
  };
  for (;;) {
    result.left = solve(rates, result.strengths);
    const auto worst = std::ranges::max_element(result.strengths, {}, beyond);
    if (worst == result.strengths.end() || !(beyond(*worst) > 0.0)) return result;
    worst->is_used = false;
  }
}

// Whether the laws drive the body back to a zero angle.
bool hangs_at_zero(const Solution& solution, const AttitudeModel& stated, const Candidates& all) {
  constexpr double off_rad = pi / 3.0;
  const Curve aside{{0.0, 0.0}, {off_rad, -off_rad}, {0.0, 0.0}};
  double torque_N_m = 0.0;  // at +off_rad minus at −off_rad
  for (const Strength& s : solution.strengths) {
    AttitudeModel model = stated;
    model.disturbances = {all[s.law].with_strength_alone(s.parameter)};
    for (const size_t i : {0U, 1U}) {
      const Vec3 torque = disturbance_torques_body_N_m(model, state_at(model, aside, i)).front();
      torque_N_m += (i == 0 ? s.value : -s.value) * model.platform.axis.dot(torque);
    }
  }
  return torque_N_m < 0.0;
}

// Turns the curve `which`, whose zero of the angle is unknown, to the zero that leaves the smallest
// residual. Of two zeros half a turn apart it is the one to which the laws drive the body.
void find_zero(size_t which, const AttitudeModel& stated, const Candidates& all,
               const std::vector<size_t>& candidates, std::vector<Curve>& curves) {
  constexpr int steps = 12;  // of half a turn
  const std::vector<double> turned_rad = curves[which].angle_rad;
  const auto turn_to = [&](double zero_rad) {
    for (size_t i = 0; i < turned_rad.size(); ++i) {
      curves[which].angle_rad[i] = turned_rad[i] + zero_rad;
    }
  };
  double least = inference::infinity, best_rad = 0.0;
  for (int step = 0; step < steps; ++step) {
    const double zero_rad = pi * step / steps;
    turn_to(zero_rad);
    const Solution solution = solution_along(curves, stated, all, candidates);
    if (!(solution.left < least)) continue;
    least = solution.left;
    best_rad = hangs_at_zero(solution, stated, all) ? zero_rad : zero_rad + pi;
  }
  turn_to(best_rad);
}

}  // namespace

Trial as_stated(Trial nominal) {
  for (const Free& f : nominal.fit.best.free) {
    if (!f.per_run) nominal.fit.best.value(f) = f.mean;
  }
  return nominal;
}

LawsOfCurve laws_of_curve(const Trial& nominal, const Candidates& all,
                          const std::vector<size_t>& candidates,
                          const std::vector<Observation>& runs) {
  const AttitudeModel stated = as_stated(nominal).fit.best.model;
  LawsOfCurve result;
  std::vector<Curve> curves;
  result.starts = starts_from_data(nominal.fit.best, runs);
  for (const Observation& seen : runs) {
    curves.push_back(curve_of(seen, stated.platform.axis));
    if (curves.back().time_s.empty()) return {};
  }
  for (size_t run = 0; run < runs.size(); ++run) {
    if (curves[run].hides_zero) find_zero(run, stated, all, candidates, curves);
    PlatformState& initial = result.starts[run].initial;
    initial.rate_body_rad_s = curves[run].rate_rad_s.front() * stated.platform.axis;
    initial.lab_from_body = Eigen::AngleAxisd(curves[run].angle_rad.front(), stated.platform.axis);
  }
  const std::vector<Strength> strengths = solution_along(curves, stated, all, candidates).strengths;
  for (const size_t c : candidates) {
    Start start{all[c].start};
    bool acts = false;
    for (const Strength& s : strengths) {
      if (s.law != c) continue;
      start.disturbance.parameters[s.parameter].value = s.value * all[c].scale[s.parameter];
      acts = acts || s.value != 0.0;
    }
    if (acts) result.members.push_back({{c, start}, {}});
  }
  return result;
}

}  // namespace photorque
