#include "attitude/estimation/forward_model.h"

#include <algorithm>
#include <cmath>

#include "attitude/model/disturbance.h"
#include "attitude/observation/prediction.h"
#include "core/errors.h"
#include "inference/estimator/thresholds.h"

namespace photorque {
namespace {

// Prior sigma of the initial extra states: appendages start nearly at rest relative to the body.
constexpr double extra_state_sigma = Thresholds::Evidence{}.own_state_sigma;

// A sinusoid whose amplitude is still zero does not affect the error by which the propagator
// chooses its steps, but its derivatives must be resolved. A step is therefore not longer than its
// period, which gives a relative error of 3e-4.
double max_step_s(const AttitudeModel& model) {
  double shortest_period_s = inference::infinity;
  for (const Disturbance& d : model.disturbances) {
    for (const Parameter& p : d.parameters) {
      if (p.key == "frequency_Hz" && p.value > 0.0) {
        shortest_period_s = std::min(shortest_period_s, 1.0 / p.value);
      }
    }
  }
  return shortest_period_s;
}

std::vector<Variable> variables_of(const Hypothesis& h, const std::vector<Free>& extra) {
  std::vector<Variable> variables;
  for (int k = 0; k < 6; ++k) variables.push_back({k, 0, -1});
  for (size_t k = 0; k < h.runs.front().initial.extra.size(); ++k) {
    variables.push_back(Variable::initial_extra(static_cast<int>(k)));
  }
  for (const bool own : {true, false}) {
    for (const Free& f : h.free) {
      if (f.per_run == own) variables.push_back(Variable::of(f.disturbance, f.parameter));
    }
  }
  for (const Free& f : extra) variables.push_back(Variable::of(f.disturbance, f.parameter));
  return variables;
}

// Moves an initial state by a step in its tangent space.
void step_initial(const Eigen::VectorXd& step, PlatformState& initial) {
  initial.lab_from_body = (initial.lab_from_body * turn_by(step.head<3>())).normalized();
  initial.rate_body_rad_s += step.segment<3>(3);
  for (size_t e = 0; e < initial.extra.size(); ++e) {
    initial.extra[e] += step[static_cast<Eigen::Index>(6 + e)];
  }
}

// Adds `sign` times the part of the body's rate that the extra states of each run have at rest
// relative to the body. With −1 before and +1 after a step, the states keep their values relative
// to the body when rates and axes change.
void add_bound_rates(Hypothesis& h, double sign) {
  for (RunStart& run : h.runs) {
    size_t e = 0;
    for (const Disturbance& d : h.model.disturbances) {
      for (const ExtraState& state : d.states) {
        run.initial.extra[e++] += sign * bound_axis(d, state).dot(run.initial.rate_body_rad_s);
      }
    }
  }
}

// Name with key and component, for example "static_unbalance.offset_m[2]". The key contains the
// unit.
std::string name_of(const Hypothesis& h, const Free& f) {
  const Parameter& p = h.parameter(f);
  const std::string component = p.component < 0 ? "" : "[" + std::to_string(p.component) + "]";
  return h.model.disturbances[f.disturbance].kind + "." + p.key + component;
}

inference::Parameter parameter_of(const Hypothesis& h, const Free& f, double value) {
  return {name_of(h, f), "", value, f.mean, f.sigma, f.lowest, f.highest};
}

// For each extra state, its index in (x, y, velocity x, velocity y) of the translation; −1: it is
// another state.
std::vector<int> places_among_extra(const AttitudeModel& model) {
  std::vector<int> places;
  for (const Disturbance& d : model.disturbances) {
    for (size_t k = 0; k < d.states.size(); ++k) {
      places.push_back(d.kind == translation_kind ? static_cast<int>(k) : -1);
    }
  }
  return places;
}

// Whether readings determine a position or velocity of a sliding body.
bool determines_translation(const Observation& seen, int which) {
  const bool along_x = which % 2 == 0;
  return seen.has(along_x ? Scalar::position_x : Scalar::position_y) ||
         (which >= 2 && seen.has(along_x ? Scalar::velocity_x : Scalar::velocity_y));
}

// Initial conditions of a run. Quantities that no reading determines stay near their value by a
// prior: 1 rad for rotations without attitude readings, 1e-9 for motion that a bearing prevents.
std::vector<inference::Parameter> initial_parameters(const AttitudeModel& model,
                                                     const RunStart& run, const Observation& seen) {
  const PlatformState& initial = run.initial;
  constexpr double unseen_rad = 1.0, held = 1e-9;
  const char* axes[] = {"x", "y", "z"};
  const Platform& platform = model.platform;
  std::vector<inference::Parameter> result;
  // A segment of a recording with attitudes may have none.
  const bool has_attitudes =
      std::ranges::any_of(seen.attitude_rows, [](double rows) { return rows > 0.0; });
  // The rotation of a sliding body may not be observed.
  const bool turn_is_seen = seen.has_some_attitude() || seen.has_gyro || !platform.slides();
  const auto is_held = [&](int k) {
    if (!turn_is_seen) return true;
    return platform.turns_about_one_axis() && std::abs(platform.axis[k]) < 1e-12;
  };
  for (int k = 0; k < 3; ++k) {
    inference::Parameter p{std::string("initial rotation ") + axes[k], "rad", 0.0};
    if (is_held(k)) {
      p.sigma = held;
    } else if (!seen.sees_attitude() || !has_attitudes) {
      p.sigma = unseen_rad;
    }
    result.push_back(p);
  }
  for (int k = 0; k < 3; ++k) {
    const double rate_rad_s = initial.rate_body_rad_s[k];
    inference::Parameter p{std::string("initial rate ") + axes[k], "rad/s", rate_rad_s};
    if (is_held(k)) {
      p.mean = rate_rad_s;
      p.sigma = held;
    }
    result.push_back(p);
  }
  if (initial.extra.empty()) return result;
  const PlatformState rest = Dynamics(model).initial_state(initial.rate_body_rad_s, run.turned_rad);
  const std::vector<int> places = places_among_extra(model);
  for (size_t k = 0; k < rest.extra.size(); ++k) {
    if (places[k] >= 0) {
      result.push_back({"initial state " + std::to_string(k + 1), "", initial.extra[k]});
      // A position that no reading determines keeps its value.
      if (!determines_translation(seen, places[k])) {
        result.back().mean = initial.extra[k];
        result.back().sigma = extra_state_sigma;
      }
      continue;
    }
    result.push_back({"initial state " + std::to_string(k + 1), "", initial.extra[k], rest.extra[k],
                      extra_state_sigma});
  }
  return result;
}

}  // namespace

AttitudeForwardModel::AttitudeForwardModel(Hypothesis nominal, const std::vector<Observation>& runs,
                                           std::vector<Free> extra, double tolerance)
    : nominal_(std::move(nominal)),
      runs_(runs),
      extra_(std::move(extra)),
      tolerance_(tolerance),
      variables_(variables_of(nominal_, extra_)) {}

Eigen::VectorXd AttitudeForwardModel::point_of(const Hypothesis& h) const {
  std::vector<double> x;
  for (const RunStart& run : h.runs) {
    const Quat& q = run.initial.lab_from_body;
    const Vec3& rate = run.initial.rate_body_rad_s;
    x.insert(x.end(), {q.w(), q.x(), q.y(), q.z(), rate.x(), rate.y(), rate.z()});
    x.insert(x.end(), run.initial.extra.begin(), run.initial.extra.end());
    x.insert(x.end(), run.own.begin(), run.own.end());
  }
  for (const Free& f : h.free) {
    if (!f.per_run) x.push_back(h.parameter(f).value);
  }
  return Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
}

Hypothesis AttitudeForwardModel::hypothesis_at(const Eigen::VectorXd& at) const {
  Hypothesis h = nominal_;
  const double* x = at.data();
  for (RunStart& run : h.runs) {
    run.initial.lab_from_body = Quat(x[0], x[1], x[2], x[3]);
    run.initial.rate_body_rad_s = {x[4], x[5], x[6]};
    x += 7;
    for (double& e : run.initial.extra) e = *x++;
    for (double& own : run.own) own = *x++;
  }
  for (const Free& f : h.free) {
    if (!f.per_run) h.value(f) = *x++;
  }
  return h;
}

inference::Parameters AttitudeForwardModel::parameters(const Eigen::VectorXd& at) const {
  const Hypothesis h = hypothesis_at(at);
  inference::Parameters result;
  for (size_t r = 0; r < h.runs.size(); ++r) {
    const RunStart& run = h.runs[r];
    std::vector<inference::Parameter> own = initial_parameters(h.model, run, runs_[r]);
    size_t k = 0;
    for (const Free& f : h.free) {
      if (f.per_run) own.push_back(parameter_of(h, f, run.own[k++]));
    }
    result.of_run.push_back(std::move(own));
  }
  for (const Free& f : h.free) {
    if (!f.per_run) result.shared.push_back(parameter_of(h, f, h.parameter(f).value));
  }
  for (const Free& f : extra_) {
    result.shared.push_back({name_of(h, f), "", h.parameter(f).value});
  }
  return result;
}

inference::NormalSums AttitudeForwardModel::sums(const Eigen::VectorXd& at, Eigen::Index run,
                                                 const inference::Request& request) const {
  const Hypothesis h = hypothesis_at(at);
  const auto which = static_cast<size_t>(run);
  const Observation& seen = runs_[which];
  PredictionOptions options;
  options.propagation.tolerance = tolerance_;
  // Relative accuracy of the derivatives that a step's direction and a covariance need.
  constexpr double derivative_tolerance = 1e-7;
  options.propagation.derivative_tolerance = derivative_tolerance;
  options.propagation.max_step_s = max_step_s(h.model);
  options.max_chi2 = request.give_up_above;
  options.blocks = std::max<size_t>(
      20, static_cast<size_t>(request.window * static_cast<double>(seen.blocks())));
  try {
    const Dynamics dynamics(h.model_of(which, seen));
    return predict(dynamics, h.runs[which].initial, seen,
                   request.derivatives ? variables_ : std::vector<Variable>(), options)
        .sums;
  } catch (const InputError& error) {  // an inertia that is impossible for a body
    throw NumericalError(error.what());
  }
}

Eigen::VectorXd AttitudeForwardModel::stepped(const Eigen::VectorXd& at,
                                              const Eigen::VectorXd& step) const {
  Hypothesis h = hypothesis_at(at);
  add_bound_rates(h, -1.0);
  Eigen::Index next = 0;
  for (RunStart& run : h.runs) {
    const auto initial = static_cast<Eigen::Index>(6 + run.initial.extra.size());
    step_initial(step.segment(next, initial), run.initial);
    next += initial;
    size_t own = 0;
    for (const Free& f : h.free) {
      if (!f.per_run) continue;
      run.own[own] = std::clamp(run.own[own] + step[next++], f.lowest, f.highest);
      ++own;
    }
  }
  for (const Free& f : h.free) {
    if (!f.per_run) h.value(f) = std::clamp(h.value(f) + step[next++], f.lowest, f.highest);
  }
  add_bound_rates(h, 1.0);
  return point_of(h);
}

}  // namespace photorque
