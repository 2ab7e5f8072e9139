#include "diagnosis/attitude/fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/errors.h"

namespace photorque {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

size_t count_own(const std::vector<Free>& free) {
  return static_cast<size_t>(
      std::count_if(free.begin(), free.end(), [](const Free& f) { return f.per_run; }));
}

// Where the variables of each run and the shared ones stand among all.
struct Layout {
  size_t initial, own, runs, shared;

  Layout(const Hypothesis& h)  // NOLINT(google-explicit-constructor)
      : initial(6 + h.runs.front().initial.extra.size()),
        own(count_own(h.free)),
        runs(h.runs.size()),
        shared(h.free.size() - own) {}
  size_t per_run() const { return initial + own; }
  size_t first_shared() const { return runs * per_run(); }
  size_t size() const { return first_shared() + shared; }
};

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

// Adds the sums of one run to those of all.
void scatter(const NormalSums& from, const Layout& layout, size_t run, size_t extra,
             NormalSums& to) {
  const auto place = [&](size_t v) {
    return static_cast<Eigen::Index>(v < layout.per_run()
                                         ? run * layout.per_run() + v
                                         : layout.first_shared() + v - layout.per_run());
  };
  const size_t count = layout.per_run() + layout.shared + extra;
  for (size_t a = 0; a < count; ++a) {
    to.gradient[place(a)] += from.gradient[static_cast<Eigen::Index>(a)];
    for (size_t b = 0; b < count; ++b) {
      to.matrix(place(a), place(b)) +=
          from.matrix(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
    }
  }
  to.chi2 += from.chi2;
  to.samples += from.samples;
}

struct Evaluation {
  NormalSums sums;  // with the priors
  double data_chi2 = infinity;
  std::vector<double> run_chi2;
  std::vector<int64_t> run_samples;
};

void add_prior(double value, double mean, double sigma, size_t at, NormalSums& sums) {
  if (!std::isfinite(sigma)) return;
  const auto i = static_cast<Eigen::Index>(at);
  const double off = (mean - value) / sigma;
  sums.matrix(i, i) += 1.0 / (sigma * sigma);
  sums.gradient[i] += off / sigma;
  sums.chi2 += off * off;
}

// An appendage begins near rest against the body, to within these.
constexpr double extra_state_sigma = 0.01;

void add_priors(const Hypothesis& h, const Layout& layout, NormalSums& sums) {
  for (size_t run = 0; run < layout.runs; ++run) {
    const size_t first = run * layout.per_run();
    const PlatformState rest = Dynamics(h.model).initial_state(h.runs[run].initial.rate_body_rad_s);
    for (size_t k = 0; k < rest.extra.size(); ++k) {
      add_prior(h.runs[run].initial.extra[k], rest.extra[k], extra_state_sigma, first + 6 + k,
                sums);
    }
    size_t own = 0;
    for (const Free& f : h.free) {
      if (!f.per_run) continue;
      add_prior(h.runs[run].own[own], f.mean, f.sigma, first + layout.initial + own, sums);
      ++own;
    }
  }
  size_t shared = layout.first_shared();
  for (const Free& f : h.free) {
    if (f.per_run) continue;
    const double value =
        h.model.disturbances[f.disturbance].parameters[static_cast<size_t>(f.parameter)].value;
    add_prior(value, f.mean, f.sigma, shared++, sums);
  }
}

// A sinusoid of no amplitude yet does not show in the error by which the propagator chooses its
// steps, but its slopes have to be resolved: a step is no longer than its period, to 3e-4 of them.
double max_step_s(const AttitudeModel& model) {
  double max_time_s = infinity;
  for (const Disturbance& d : model.disturbances) {
    for (const Parameter& p : d.parameters) {
      if (p.key == "frequency_Hz" && p.value > 0.0)
        max_time_s = std::min(max_time_s, 1.0 / p.value);
    }
  }
  return max_time_s;
}

Evaluation evaluate(const Hypothesis& h, const std::vector<Observation>& runs,
                    const std::vector<Free>& extra, bool with_slopes, double fraction,
                    double tolerance) {
  const Layout layout(h);
  const auto size = static_cast<Eigen::Index>(layout.size() + extra.size());
  Evaluation result;
  result.sums = {Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size), 0.0, 0};
  PredictionOptions options;
  options.propagation.tolerance = tolerance;
  options.propagation.max_step_s = max_step_s(h.model);
  const std::vector<Variable> variables =
      with_slopes ? variables_of(h, extra) : std::vector<Variable>();
  try {
    for (size_t run = 0; run < runs.size(); ++run) {
      options.blocks = std::max<size_t>(
          20, static_cast<size_t>(fraction * static_cast<double>(runs[run].blocks())));
      const Dynamics dynamics(h.model_of(run, runs[run]));
      const NormalSums sums =
          predict(dynamics, h.runs[run].initial, runs[run], variables, options).sums;
      if (!std::isfinite(sums.chi2)) throw NumericalError("the residuals are not finite");
      result.run_chi2.push_back(sums.chi2);
      result.run_samples.push_back(sums.samples);
      if (with_slopes) {
        scatter(sums, layout, run, extra.size(), result.sums);
      } else {
        result.sums.chi2 += sums.chi2;
        result.sums.samples += sums.samples;
      }
    }
    result.data_chi2 = result.sums.chi2;
  } catch (const NumericalError&) {
    result.sums.chi2 = result.data_chi2 = infinity;
  } catch (const InputError&) {  // an inertia that no body has
    result.sums.chi2 = result.data_chi2 = infinity;
  }
  return result;
}

void step_initial(const Eigen::VectorXd& step, const AttitudeModel& model, PlatformState& initial) {
  const Vec3 rotation = step.head<3>(), rate = step.segment<3>(3);
  const double angle = rotation.norm();
  if (angle > 0.0) {
    initial.lab_from_body =
        (initial.lab_from_body * Quat(Eigen::AngleAxisd(angle, rotation / angle))).normalized();
  }
  initial.rate_body_rad_s += rate;
  size_t e = 0;
  for (const Disturbance& d : model.disturbances) {
    for (const ExtraState& state : d.states) {
      initial.extra[e] += state.per_body_rate.dot(rate) + step[static_cast<Eigen::Index>(6 + e)];
      ++e;
    }
  }
}

Hypothesis stepped(const Hypothesis& from, const Eigen::VectorXd& step) {
  Hypothesis h = from;
  const Layout layout(h);
  for (size_t run = 0; run < layout.runs; ++run) {
    const auto first = static_cast<Eigen::Index>(run * layout.per_run());
    const auto initial = static_cast<Eigen::Index>(layout.initial);
    step_initial(step.segment(first, initial), h.model, h.runs[run].initial);
    for (size_t k = 0; k < layout.own; ++k) {
      h.runs[run].own[k] += step[first + initial + static_cast<Eigen::Index>(k)];
    }
  }
  auto shared = static_cast<Eigen::Index>(layout.first_shared());
  for (const Free& f : h.free) {
    if (!f.per_run) h.value(f) = std::clamp(h.value(f) + step[shared++], f.lowest, f.highest);
  }
  return h;
}

// Marquardt's step: the damping acts in the scale of each variable.
Eigen::VectorXd damped_step(const NormalSums& sums, double damping) {
  const Eigen::VectorXd scale = sums.matrix.diagonal().cwiseSqrt().unaryExpr(
      [](double s) { return s > 0.0 ? 1.0 / s : 1.0; });
  Eigen::MatrixXd scaled = scale.asDiagonal() * sums.matrix * scale.asDiagonal();
  scaled.diagonal().array() += damping;
  return scale.cwiseProduct(
      scaled.ldlt().solve(Eigen::VectorXd(scale.cwiseProduct(sums.gradient))));
}

class Fitter {
 public:
  Fitter(const Hypothesis& start, const std::vector<Observation>& runs, const FitSettings& settings)
      : runs_(runs), settings_(settings), layout_(start), now_(start) {}

  Fit run() {
    bool converged = false;
    for (const double fraction : settings_.windows) converged = fit_window(fraction);
    Evaluation last = evaluate_with_priors(now_, true, 1.0);
    Fit result;
    result.chi2 = last.sums.chi2;
    result.data_chi2 = last.data_chi2;
    result.samples = last.sums.samples;
    result.hessian = std::move(last.sums.matrix);
    result.first_shared = static_cast<Eigen::Index>(layout_.first_shared());
    result.run_chi2 = std::move(last.run_chi2);
    result.run_samples = std::move(last.run_samples);
    result.converged = converged && std::isfinite(result.chi2);
    result.best = std::move(now_);
    return result;
  }

 private:
  Evaluation evaluate_with_priors(const Hypothesis& h, bool with_slopes, double fraction) const {
    Evaluation e = evaluate(h, runs_, {}, with_slopes, fraction, settings_.tolerance);
    if (std::isfinite(e.sums.chi2)) add_priors(h, layout_, e.sums);
    return e;
  }

  bool fit_window(double fraction) {
    double damping = 1e-9;
    Evaluation now = evaluate_with_priors(now_, true, fraction);
    for (int iteration = 0; iteration < settings_.max_iterations; ++iteration) {
      if (!std::isfinite(now.sums.chi2)) return false;
      const Eigen::VectorXd step = damped_step(now.sums, damping);
      if (!step.allFinite()) {
        damping = std::max(damping, 1e-6) * 10.0;
        continue;
      }
      // What the step predicts; nothing worth having: done.
      const double predicted_gain = step.dot(2.0 * now.sums.gradient - now.sums.matrix * step);
      // So is what a bad fit could hardly show.
      constexpr double min_fraction = 1e-6;
      if (predicted_gain < std::max(settings_.converged_gain, min_fraction * now.sums.chi2))
        return true;
      Hypothesis tried = stepped(now_, step);
      const Evaluation at = evaluate_with_priors(tried, false, fraction);
      if (!(at.sums.chi2 < now.sums.chi2)) {
        damping = std::max(damping, 1e-5) * 10.0;
        if (damping > 1e9) return false;
        continue;
      }
      now_ = std::move(tried);
      damping =
          at.sums.chi2 < now.sums.chi2 - 0.25 * predicted_gain ? damping * 0.1 : damping * 3.0;
      now = evaluate_with_priors(now_, true, fraction);
    }
    return false;
  }

  const std::vector<Observation>& runs_;
  const FitSettings& settings_;
  Layout layout_;
  Hypothesis now_;
};

}  // namespace

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

Eigen::MatrixXd Fit::shared_covariance() const {
  const Eigen::VectorXd scale =
      hessian.diagonal().cwiseSqrt().unaryExpr([](double s) { return s > 0.0 ? 1.0 / s : 1.0; });
  const Eigen::MatrixXd scaled = scale.asDiagonal() * hessian * scale.asDiagonal();
  const Eigen::MatrixXd inverse =
      scaled.ldlt().solve(Eigen::MatrixXd::Identity(scaled.rows(), scaled.cols()));
  const Eigen::MatrixXd covariance = scale.asDiagonal() * inverse * scale.asDiagonal();
  const Eigen::Index n = hessian.rows() - first_shared;
  return covariance.bottomRightCorner(n, n);
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

Fit fit(const Hypothesis& start, const std::vector<Observation>& runs,
        const FitSettings& settings) {
  return Fitter(start, runs, settings).run();
}

NormalSums sums_at(const Hypothesis& at, const std::vector<Observation>& runs,
                   const std::vector<Free>& extra, double tolerance) {
  NormalSums sums = evaluate(at, runs, extra, true, 1.0, tolerance).sums;
  if (std::isfinite(sums.chi2)) add_priors(at, Layout(at), sums);
  return sums;
}

}  // namespace photorque
