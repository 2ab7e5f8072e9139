#include "diagnosis/attitude/laws_of_curve.h"

#include <algorithm>
#include <cmath>

#include "attitude/estimation/axis_readings.h"
#include "attitude/estimation/swing.h"
#include "core/numerics/linear.h"

namespace photorque {
namespace {

// Angle and rate at some instants of a run.
struct Curve {
  std::vector<double> time_s, angle_rad, rate_rad_s;
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

Curve curve_of(const Observation& seen, const Vec3& axis) {
  constexpr size_t fewest = 20, most_instants = 4000;
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
// explain.
void solve(const std::vector<Eigen::VectorXd>& rates, std::vector<Strength>& strengths) {
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
  std::vector<Eigen::VectorXd> rates;
  result.starts = starts_from_data(nominal.fit.best, runs);
  for (size_t run = 0; run < runs.size(); ++run) {
    Curve curve = curve_of(runs[run], stated.platform.axis);
    if (curve.time_s.empty()) return {};
    const Eigen::Map<const Eigen::VectorXd> rate(curve.rate_rad_s.data(),
                                                 static_cast<Eigen::Index>(curve.time_s.size()));
    rates.emplace_back(rate - impulse_of(stated, curve));
    PlatformState& initial = result.starts[run].initial;
    initial.rate_body_rad_s = curve.rate_rad_s.front() * stated.platform.axis;
    initial.lab_from_body = Eigen::AngleAxisd(curve.angle_rad.front(), stated.platform.axis);
    curves.push_back(std::move(curve));
  }
  std::vector<Strength> strengths = strengths_along(curves, stated, all, candidates);
  for (;;) {
    solve(rates, strengths);
    const auto beyond = [&](const Strength& s) {
      const double value = s.value * all[s.law].scale[s.parameter];
      const bool is_beyond = value < all[s.law].lowest[s.parameter] ||
                             value > all[s.law].highest[s.parameter] ||
                             (value < 0.0 && braking_power(all[s.law], stated));
      return is_beyond ? std::abs(s.value) : 0.0;
    };
    const auto worst = std::ranges::max_element(strengths, {}, beyond);
    if (worst == strengths.end() || !(beyond(*worst) > 0.0)) break;
    worst->is_used = false;
  }
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
