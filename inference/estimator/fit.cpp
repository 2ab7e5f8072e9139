#include "inference/estimator/fit.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/errors.h"

namespace photorque::inference {

namespace {

// Solves (H + λ D) δ = g in the scale of each parameter; `damped` is D over the diagonal of H.
// Parameters in `held` stay fixed.
Eigen::VectorXd damped_step(const SumsOfRuns& sums, const Eigen::VectorXd& damped, double damping,
                            const std::vector<Eigen::Index>& held) {
  const Eigen::VectorXd scale = inverse_roots(sums.matrix.diagonal());
  ArrowMatrix scaled = sums.matrix.scaled(scale);
  for (Eigen::Index i = 0; i < scale.size(); ++i) scaled.add_to_diagonal(i, damping * damped[i]);
  Eigen::VectorXd right = scale.cwiseProduct(sums.gradient);
  for (const Eigen::Index i : held) {
    scaled.hold(i);
    right[i] = 0.0;
  }
  return scale.cwiseProduct(scaled.solve(right));
}

// Damping scale of each parameter over its present diagonal of H: 1, or that of the largest
// diagonal so far.
class DampingScale {
 public:
  explicit DampingScale(bool keeps_largest) : keeps_largest_(keeps_largest) {}

  // D over the diagonal of H.
  Eigen::VectorXd over(const Eigen::VectorXd& diagonal) {
    if (!keeps_largest_) return Eigen::VectorXd::Ones(diagonal.size());
    largest_ = largest_.size() == 0 ? diagonal : Eigen::VectorXd(largest_.cwiseMax(diagonal));
    return largest_.binaryExpr(
        diagonal, [](double d, double h) { return h > 0.0 ? d / h : std::max(d, 1e-300); });
  }

 private:
  bool keeps_largest_;
  Eigen::VectorXd largest_;
};

bool leaves_bounds(const Parameter& p, double step) {
  return (p.value <= p.lowest && step < 0.0) || (p.value >= p.highest && step > 0.0);
}

// Damped step within the bounds. Parameters on a bound that the step would leave are held fixed.
// Holding one may move another out of its bounds, so the step is solved again until none leaves
// them.
Eigen::VectorXd step_within_bounds(const SumsOfRuns& sums, const Parameters& parameters,
                                   const Eigen::VectorXd& damped, double damping) {
  std::vector<Eigen::Index> held;
  std::vector<bool> is_held(static_cast<size_t>(parameters.size()), false);
  Eigen::VectorXd step = damped_step(sums, damped, damping, held);
  while (step.allFinite()) {
    const size_t before = held.size();
    for (Eigen::Index i = 0; i < parameters.size(); ++i) {
      if (is_held[static_cast<size_t>(i)] || !leaves_bounds(parameters[i], step[i])) continue;
      is_held[static_cast<size_t>(i)] = true;
      held.push_back(i);
    }
    if (held.size() == before) break;
    step = damped_step(sums, damped, damping, held);
  }
  return step;
}

// Extrapolates the fall of χ²: whether it can reach the useful limit, and whether it stalls.
class ConvergenceForecast {
 public:
  ConvergenceForecast(double worth_chi2, double min_relative_decrease, int max_iterations)
      : worth_chi2_(worth_chi2),
        min_relative_decrease_(min_relative_decrease),
        max_iterations_(max_iterations) {}

  // Call after each step, accepted or not. The logarithm of χ² is assumed to fall at most twice as
  // fast per remaining step as over the last steps.
  bool is_out_of_reach(const SumsOfRuns& sums, int iteration) {
    constexpr double acceleration = 2.0;
    fallen_.push_back(sums.chi2);
    if (fallen_.size() <= memory || !(sums.chi2 > worth_chi2_)) return false;
    const double left = static_cast<double>(max_iterations_ - iteration);
    return std::log(sums.chi2 / worth_chi2_) > acceleration * fall() * left;
  }
  // Call after is_out_of_reach(). A good fit is iterated to convergence.
  bool is_stalling(const SumsOfRuns& sums) const {
    constexpr double misfit_per_sample = 1.2;
    if (fallen_.size() <= memory || fall() >= min_relative_decrease_) return false;
    return sums.chi2 > misfit_per_sample * static_cast<double>(sums.samples);
  }

 private:
  static constexpr size_t memory = 6;

  // Mean decrease of ln χ² per step over the last steps.
  double fall() const {
    return std::log(fallen_[fallen_.size() - 1 - memory] / fallen_.back()) / memory;
  }

  double worth_chi2_, min_relative_decrease_;
  int max_iterations_;
  std::vector<double> fallen_;
};

// Fits to shorter windows only provide a start for the next window.
constexpr int iterations_of_first_windows = 20;
constexpr double gain_in_first_windows = 1.0;
// Factor by which the χ² of a fit that reached the iteration limit may exceed the useful limit.
constexpr double still_falling = 4.0;
// Limit of χ² over the useful limit at the start of whole runs. Beyond it predictions are off by a
// thousand standard errors, and the gradient does not lead to the minimum.
constexpr double off_course = 1e6;

class Fitter {
 public:
  Fitter(const ForwardModel& model, const Eigen::VectorXd& start, const Options& options)
      : model_(model), options_(options), now_(start) {}

  Fit run() {
    Fit result;
    // A model that cannot be evaluated in a window cannot be evaluated in a longer one.
    bool is_hopeless = false;
    for (size_t w = 0; w < options_.windows.size() && !is_hopeless; ++w) {
      result.termination = fit_window(options_.windows[w]);
      is_hopeless = result.termination == Termination::not_evaluable || is_out_of_reach_;
    }
    if (is_out_of_reach_) result.termination = Termination::out_of_reach;
    const Request whole{!is_hopeless, 1.0, is_hopeless ? 0.0 : infinity};
    Evaluation last = ended_at_ ? std::move(*ended_at_) : evaluate(model_, now_, whole);
    result.parameters = model_.parameters(now_);
    // Short runs are always evaluated in full, so their χ² is finite even after a failure.
    result.chi2 = is_hopeless ? infinity : last.sums.chi2;
    result.data_chi2 = is_hopeless ? infinity : last.data_chi2;
    result.samples = last.sums.samples;
    result.hessian = std::move(last.sums.matrix);
    result.first_shared = result.parameters.first_shared();
    result.run_chi2 = std::move(last.run_chi2);
    if (!std::isfinite(result.chi2) && !is_out_of_reach_) {
      result.termination = Termination::not_evaluable;
    }
    result.converged = result.termination == Termination::converged;
    result.iterations = iterations_;
    result.at = std::move(now_);
    return result;
  }

 private:
  // Stores the evaluation of the whole runs at the end of the fit in `ended_at_`, if known.
  Termination fit_window(double window) {
    ended_at_.reset();
    const bool grew = window == 1.0 && options_.windows.size() > 1;
    const double most =
        std::min(options_.max_start_chi2, grew ? off_course * options_.worth_chi2 : infinity);
    if (most < infinity && !(evaluate(model_, now_, {false, window, most}).sums.chi2 <= most)) {
      return Termination::not_evaluable;
    }
    Evaluation now = evaluate(model_, now_, {true, window});
    const Termination termination = iterate(now, window);
    // χ² grows monotonically with the window.
    const double margin = termination == Termination::max_iterations ? still_falling : 1.0;
    is_out_of_reach_ = window < 1.0 && now.sums.chi2 > margin * options_.worth_chi2;
    if (window == 1.0 && termination != Termination::not_evaluable) ended_at_ = std::move(now);
    return termination;
  }

  // Iterates from `now`; on return `now` is the evaluation at the final point.
  Termination iterate(Evaluation& now, double window) {
    double damping = options_.initial_damping;
    DampingScale scale(options_.keep_largest_scale);
    const bool is_whole = window == 1.0;
    // The full number of steps in the first windows is reserved for models that must be fitted,
    // however poor their start is.
    const bool is_brief = !is_whole && options_.worth_chi2 < infinity;
    const int most = is_brief ? std::min(options_.max_iterations, iterations_of_first_windows)
                              : options_.max_iterations;
    const double least_gain = is_brief ? gain_in_first_windows : options_.min_gain;
    ConvergenceForecast outlook(is_whole ? options_.worth_chi2 : infinity,
                                is_whole ? options_.min_relative_decrease : 0.0, most);
    // After a step that gains as predicted, the next one is likely to be accepted. Its derivatives,
    // which include χ², are then requested at once.
    bool is_on_course = false, was_refused = false;
    for (int iteration = 0; iteration < most; ++iteration) {
      if (!std::isfinite(now.sums.chi2)) return Termination::not_evaluable;
      ++iterations_;
      const Parameters parameters = model_.parameters(now_);
      const Eigen::VectorXd step =
          step_within_bounds(now.sums, parameters, scale.over(now.sums.matrix.diagonal()), damping);
      if (!step.allFinite()) {
        damping = std::max(damping, 1e-6) * 10.0;
        continue;
      }
      const double predicted_gain = step.dot(2.0 * now.sums.gradient - now.sums.matrix * step);
      // Not "<": a perfect fit has a predicted gain of zero and has converged.
      if (!(predicted_gain > std::max(least_gain, options_.min_gain_fraction * now.sums.chi2))) {
        if (options_.polish) polish(step, predicted_gain, damping, window, now);
        return Termination::converged;
      }
      Eigen::VectorXd tried = model_.stepped(now_, step);
      const bool at_once = is_on_course && !is_short(predicted_gain);
      Evaluation at = evaluate(model_, tried, {at_once, window, now.sums.chi2});
      if (!(at.sums.chi2 < now.sums.chi2)) {
        is_on_course = false;
        damping = std::max(damping, 1e-5) * 10.0;
        if (damping > options_.max_damping) return Termination::no_step_lowers;
        was_refused = true;
        if (outlook.is_out_of_reach(now.sums, iteration)) return Termination::out_of_reach;
        if (outlook.is_stalling(now.sums)) return Termination::max_iterations;
        continue;
      }
      now_ = std::move(tried);
      is_on_course = at.sums.chi2 < now.sums.chi2 - 0.25 * predicted_gain;
      // Along a curved minimum, reducing λ tenfold after a rejection would cause a rejection at
      // every second step.
      const double eased = was_refused ? damping : damping * 0.1;
      damping = std::max(is_on_course ? eased : damping * 3.0, options_.min_damping);
      was_refused = false;
      now = at_once ? std::move(at) : evaluate(model_, now_, {true, window});
      if (outlook.is_out_of_reach(now.sums, iteration)) return Termination::out_of_reach;
      if (outlook.is_stalling(now.sums)) return Termination::max_iterations;
    }
    return Termination::max_iterations;
  }

  // A step of at most a few standard errors.
  static bool is_short(double predicted_gain) {
    constexpr double few_sigma = 3.0;
    return predicted_gain < few_sigma * few_sigma;
  }

  // Accepts a step without a test, and further steps as long as each predicted gain is less than
  // half of the previous one.
  void polish(Eigen::VectorXd step, double gain, double damping, double window, Evaluation& now) {
    for (int k = 0; k < options_.max_iterations; ++k) {
      const Eigen::VectorXd tried = model_.stepped(now_, step);
      Evaluation at = evaluate(model_, tried, {true, window});
      if (!std::isfinite(at.sums.chi2)) return;
      now_ = tried;
      now = std::move(at);
      ++iterations_;
      const Eigen::VectorXd damped = Eigen::VectorXd::Ones(step.size());
      step = step_within_bounds(now.sums, model_.parameters(now_), damped, damping);
      const double next = step.dot(2.0 * now.sums.gradient - now.sums.matrix * step);
      if (!(next < 0.5 * gain)) return;
      gain = next;
    }
  }

  const ForwardModel& model_;
  const Options& options_;
  Eigen::VectorXd now_;
  std::optional<Evaluation> ended_at_;
  int iterations_ = 0;
  bool is_out_of_reach_ = false;  // χ² of a window alone exceeds worth_chi2
};

}  // namespace

Options Options::to_rounding() {
  Options options;
  options.max_iterations = 300;
  options.min_gain = 0.0;
  options.min_gain_fraction = 1e-14;
  options.polish = true;
  options.initial_damping = 1e-3;
  options.min_damping = 1e-14;
  options.keep_largest_scale = true;
  return options;
}

void Options::check() const {
  const auto refuse = [](const char* key, double found, const char* expected) {
    throw InputError({}, std::string("fit options: ") + key, std::to_string(found), expected);
  };
  if (windows.empty()) refuse("windows", 0.0, "at least one");
  for (const double w : windows) {
    if (!(w > 0.0 && w <= 1.0)) refuse("windows", w, "fractions in (0, 1]");
  }
  if (max_iterations < 1) refuse("max_iterations", max_iterations, "at least 1");
  if (!(min_gain >= 0.0)) refuse("min_gain", min_gain, "a number >= 0");
  if (!(min_gain_fraction >= 0.0 && min_gain_fraction < 1.0)) {
    refuse("min_gain_fraction", min_gain_fraction, "a fraction in [0, 1)");
  }
  for (const auto& [key, value] : {std::pair{"min_relative_decrease", min_relative_decrease},
                                   {"initial_damping", initial_damping},
                                   {"min_damping", min_damping}}) {
    if (!(value >= 0.0)) refuse(key, value, "a number >= 0");
  }
  if (!(max_damping > 0.0)) refuse("max_damping", max_damping, "a number > 0");
}

double Fit::variance() const {
  const int64_t freedom = samples - parameters.size();
  return freedom > 0 ? data_chi2 / static_cast<double>(freedom) : 0.0;
}

Eigen::VectorXd Fit::scatter_errors() const {
  const Covariance known = covariance();
  const double scatter = std::sqrt(variance());
  Eigen::VectorXd errors(known.matrix.rows());
  for (Eigen::Index i = 0; i < errors.size(); ++i) {
    errors[i] = known.is_determined(i) ? scatter * known.standard_error(i) : infinity;
  }
  return errors;
}

Covariance Fit::shared() const {
  const Covariance all = covariance();
  const Eigen::Index n = hessian.size() - first_shared;
  Covariance result{all.matrix.bottomRightCorner(n, n), {}};
  for (const Eigen::Index i : all.undetermined) {
    if (i >= first_shared) result.undetermined.push_back(i - first_shared);
  }
  return result;
}

Eigen::MatrixXd Fit::shared_posterior() const {
  return posterior_of(hessian.shared_information());
}

Fit fit(const ForwardModel& model, const Eigen::VectorXd& start, const Options& options) {
  options.check();
  return Fitter(model, start, options).run();
}

}  // namespace photorque::inference
