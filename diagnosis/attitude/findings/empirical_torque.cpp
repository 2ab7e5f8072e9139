#include "diagnosis/attitude/findings/empirical_torque.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/constants.h"
#include "diagnosis/attitude/findings/account.h"
#include "diagnosis/attitude/findings/formula.h"

namespace photorque {
namespace {

constexpr size_t torque_bins = 36;
constexpr size_t propagated_states = 1000;

struct Abscissa {
  std::string unit;
  bool lab_axes = false;  // in which the torque is said
};

Abscissa abscissa_of(const std::string& variable) {
  if (variable == "heading") return {"deg", true};
  if (variable == "tilt") return {"deg"};
  if (variable == "rate") return {"rad/s"};
  if (variable == "charge") return {"C"};
  if (variable == "command") return {"N m"};
  return {"s"};
}

double value_of(const std::string& variable, const AttitudeModel& model,
                const PlatformState& state) {
  if (variable == "heading") return heading_rad(state) / degree_rad;
  if (variable == "tilt") return tilt_rad(state) / degree_rad;
  if (variable == "rate") return state.rate_body_rad_s.norm();
  if (variable == "charge") return state.charge_drawn_C;
  if (variable == "command") return model.schedule.at(state.time_s).command_body_N_m.norm();
  return state.time_s;
}

// The law at one state: its torque, and how that changes with each of its parameters.
struct TorqueAndSlopes {
  Vec3 torque_N_m = Vec3::Zero();
  Eigen::Matrix3Xd slopes;
};

// `model` has the law alone; it is left as it was. Coefficients are linear: their slopes are the
// torques of each alone. Of an exponent or a time constant the slope is a difference.
TorqueAndSlopes at_state(AttitudeModel& model, size_t own, const PlatformState& state) {
  auto& parameters = model.disturbances.front().parameters;
  const auto torque = [&] { return disturbance_torques_body_N_m(model, state).front(); };
  TorqueAndSlopes result;
  result.torque_N_m = torque();
  result.slopes.resize(3, static_cast<Eigen::Index>(parameters.size()));
  for (size_t p = 0; p < own; ++p) {
    const double value = parameters[p].value, step = 1e-4 * value;
    parameters[p].value = value + step;
    const Vec3 above = torque();
    parameters[p].value = value - step;
    result.slopes.col(static_cast<Eigen::Index>(p)) = (above - torque()) / (2.0 * step);
    parameters[p].value = value;
  }
  std::vector<double> values;
  for (size_t p = own; p < parameters.size(); ++p) {
    values.push_back(std::exchange(parameters[p].value, 0.0));
  }
  for (size_t p = own; p < parameters.size(); ++p) {
    parameters[p].value = 1.0;
    result.slopes.col(static_cast<Eigen::Index>(p)) = torque();
    parameters[p].value = 0.0;
  }
  for (size_t p = own; p < parameters.size(); ++p) parameters[p].value = values[p - own];
  return result;
}

// Of all `count` parameters of a law; 0 for those that were not fitted, as is the torque about an
// axis that cannot turn.
Eigen::MatrixXd covariance_of(const Fit& fit, size_t law, Eigen::Index count) {
  const Eigen::MatrixXd shared = fit.shared_posterior();
  std::vector<Eigen::Index> fitted, where;
  Eigen::Index at = 0;
  for (const Free& f : fit.best.free) {
    if (f.per_run) continue;
    if (f.disturbance == law) {
      fitted.push_back(f.parameter);
      where.push_back(at);
    }
    ++at;
  }
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(count, count);
  covariance(fitted, fitted) = shared(where, where);
  return covariance;
}

EmpiricalTorque torque_of(const Trial& chosen, size_t which, const Candidate& candidate,
                          const AttitudeModel& model, const Trajectory& propagated) {
  const size_t law = chosen.disturbances[which];
  const Abscissa abscissa = abscissa_of(candidate.variable);
  EmpiricalTorque torque;
  torque.variable = candidate.variable;
  torque.unit = abscissa.unit;
  torque.about_lab_axes = abscissa.lab_axes;

  std::vector<double> x;
  for (const PlatformState& state : propagated.states) {
    x.push_back(value_of(candidate.variable, model, state));
  }
  const auto [low, high] = std::minmax_element(x.begin(), x.end());
  const double width = std::max((*high - *low) / torque_bins, 1e-300);
  AttitudeModel alone = model;
  alone.disturbances = {model.disturbances[law]};
  const auto count = static_cast<Eigen::Index>(alone.disturbances.front().parameters.size());
  std::vector<Eigen::Matrix3Xd> slopes(torque_bins, Eigen::Matrix3Xd::Zero(3, count));
  std::vector<Vec3> sum(torque_bins, Vec3::Zero());
  std::vector<double> samples(torque_bins, 0.0);
  for (size_t k = 0; k < x.size(); ++k) {
    const PlatformState& state = propagated.states[k];
    const auto bin = std::min(torque_bins - 1, static_cast<size_t>((x[k] - *low) / width));
    const TorqueAndSlopes at = at_state(alone, candidate.law.shape.first_coefficient(), state);
    const Mat3 turn =
        abscissa.lab_axes ? Mat3(state.lab_from_body.toRotationMatrix()) : Mat3::Identity();
    sum[bin] += turn * at.torque_N_m;
    slopes[bin] += turn * at.slopes;
    samples[bin] += 1.0;
  }

  const Eigen::MatrixXd covariance = covariance_of(chosen.fit, law, count);
  for (size_t bin = 0; bin < torque_bins; ++bin) {
    if (samples[bin] == 0.0) continue;
    const Eigen::Matrix3Xd slope = slopes[bin] / samples[bin];
    torque.at.push_back(*low + (static_cast<double>(bin) + 0.5) * width);
    torque.torque_N_m.emplace_back(sum[bin] / samples[bin]);
    torque.standard_error_N_m.emplace_back(
        (slope * covariance * slope.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt());
  }
  torque.shape = shape_as_written(candidate.law.shape);
  torque.parameters = fitted_parameters(chosen, law);
  const EmpiricalFormula formula = formula_of(candidate.law.shape, torque.parameters, covariance);
  torque.formula = formula.text;
  torque.looks_like = formula.looks_like;
  return torque;
}

}  // namespace

std::vector<EmpiricalTorque> empirical_torques(const Trial& chosen, const Candidates& all,
                                               const std::vector<Observation>& runs) {
  const AttitudeModel model = chosen.fit.best.model_of(0, runs.front());
  const Dynamics dynamics(model);
  const Trajectory propagated =
      propagate(dynamics, chosen.fit.best.runs.front().initial,
                runs.front().averaged(propagated_states).time_s, {.tolerance = 1e-7});
  std::vector<EmpiricalTorque> result;
  for (size_t i = 0; i < chosen.candidates.size(); ++i) {
    const Candidate& c = all[chosen.candidates[i]];
    if (c.empirical()) result.push_back(torque_of(chosen, i, c, model, propagated));
  }
  return result;
}

}  // namespace photorque
