#include "diagnosis/attitude/empirical_torque.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"

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

// The law's torque for coefficient k = 1 and all others 0, in column k: it is linear in them.
Eigen::Matrix3Xd shapes(const AttitudeModel& model, size_t law, const PlatformState& state) {
  AttitudeModel unit = model;
  auto& parameters = unit.disturbances[law].parameters;
  for (Parameter& p : parameters) p.value = 0.0;
  Eigen::Matrix3Xd result(3, static_cast<Eigen::Index>(parameters.size()));
  for (size_t k = 0; k < parameters.size(); ++k) {
    parameters[k].value = 1.0;
    result.col(static_cast<Eigen::Index>(k)) = disturbance_torques_body_N_m(unit, state)[law];
    parameters[k].value = 0.0;
  }
  return result;
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
  const auto& parameters = model.disturbances[law].parameters;
  const auto count = static_cast<Eigen::Index>(parameters.size());
  std::vector<Eigen::Matrix3Xd> sum(torque_bins, Eigen::Matrix3Xd::Zero(3, count));
  std::vector<double> samples(torque_bins, 0.0);
  for (size_t k = 0; k < x.size(); ++k) {
    const PlatformState& state = propagated.states[k];
    const auto bin = std::min(torque_bins - 1, static_cast<size_t>((x[k] - *low) / width));
    const Eigen::Matrix3Xd body = shapes(model, law, state);
    const Mat3 lab_from_body = state.lab_from_body.toRotationMatrix();
    sum[bin] += abscissa.lab_axes ? Eigen::Matrix3Xd(lab_from_body * body) : body;
    samples[bin] += 1.0;
  }

  Eigen::VectorXd coefficients(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    coefficients[k] = parameters[static_cast<size_t>(k)].value;
  }
  const std::vector<Eigen::Index> where = shared_indices(chosen, which);
  const Eigen::MatrixXd covariance = chosen.fit.shared_posterior()(where, where);
  for (size_t bin = 0; bin < torque_bins; ++bin) {
    if (samples[bin] == 0.0) continue;
    const Eigen::Matrix3Xd mean = sum[bin] / samples[bin];
    torque.at.push_back(*low + (static_cast<double>(bin) + 0.5) * width);
    torque.torque_N_m.emplace_back(mean * coefficients);
    torque.standard_error_N_m.emplace_back(
        (mean * covariance * mean.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt());
  }
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
