// Nonlinear least squares with priors, bounds and nuisances: the one estimator of this program.
//
// The fit minimises over the parameters θ of a forward model (forward_model.h)
//
//   χ²(θ) = Σ_runs Σ_i r_i(θ)² + Σ_k ((θ_k − μ_k)/σ_k)²   with   lowest_k ≤ θ_k ≤ highest_k,
//
// r being residuals over their noise, and μ, σ Gaussian priors: twice the negative logarithm of the
// posterior but for a constant. With H = Jᵀ J + Σ⁻¹ (Gauss and Newton's half second derivative) and
// g = −½ ∂χ²/∂θ, each iteration solves
//
//   (H + λ D) δ = g,   D = diag H
//
// (K. Levenberg 1944; D. Marquardt, J. SIAM 11 (1963) 431) with the matrix scaled to a unit
// diagonal, so that no result depends on the units of parameters. A step that lowers χ² is taken,
// and λ falls by ten when χ² fell by more than a quarter of what the step predicted, or stays where
// the step before was not taken, and grows by three when it fell by less; a step that does not
// lower χ² is tried again with ten times λ, 1e-4 at least. A parameter on a bound that the step
// would leave is held there and the rest solved again.
//
// A window is the first part of every run; windows that grow repair a start that is far off before
// a long run can diverge from it.
#pragma once

#include <string>
#include <vector>

#include "inference/estimator/covariance.h"
#include "inference/estimator/forward_model.h"

namespace photorque::inference {

struct Options {
  std::vector<double> windows = {1.0};  // fractions of each run that are fitted in turn, in (0, 1]
  int max_iterations = 25;              // > 0, in each window
  // A window is done when the next step predicts to lower χ² by less than the larger of these.
  // In units of χ²: a parameter is then within √min_gain of its standard error of the minimum.
  double min_gain = 0.01;
  double min_gain_fraction = 1e-6;  // of χ²: hardly visible in a bad fit
  // Whether steps are then taken untested as long as their predicted gains fall: χ² shows
  // parameters to a part in 1e7 of their errors, but its gradient is more precise.
  bool polish = false;
  // A start whose χ² is larger is not worth its derivatives: it counts as not evaluable.
  double max_start_chi2 = infinity;
  // A fit of whole runs ends where χ² falls too slowly to come below this, and windows before only
  // bring their start near, in 20 iterations at most; one whose χ² alone stays above it ends the
  // fit, as if it could not be evaluated. Infinite: none of these.
  double worth_chi2 = infinity;
  // One of whole runs also ends where χ² fell by less than this fraction a step, on average over
  // the last six, and there is more than 1.2 per sample: a bad fit that hardly moves. 0: goes on.
  double creep = 0.0;
  double initial_damping = 1e-9;  // λ, ≥ 0
  double min_damping = 0.0;  // ≥ 0: keeps combinations that nothing determines where they are
  double max_damping = 1e9;  // beyond it no step lowers χ²
  // D is the largest diagonal met in a window instead of the present one (J. J. Moré, Lecture Notes
  // in Mathematics 630 (1978) 105): a parameter whose slopes vanish on the way, as the rate of an
  // exponential that has died away, does not run away.
  bool keep_largest_scale = false;

  // For problems whose evaluation costs next to nothing: as far as double precision leads.
  static Options to_rounding();

  // InputError where a value is outside its range.
  void check() const;
};

enum class Termination {
  converged,       // no step predicts a gain above the limit
  no_step_lowers,  // at the limit of precision, or of the derivatives
  max_iterations,
  out_of_reach,   // of worth_chi2
  not_evaluable,  // the model could not be evaluated at the start
};

struct Fit {
  Eigen::VectorXd at;           // the point
  Parameters parameters;        // there
  double chi2 = infinity;       // with the priors
  double data_chi2 = infinity;  // without
  int64_t samples = 0;
  std::vector<double> run_chi2;  // of each run, without the priors
  std::vector<int64_t> run_samples;
  ArrowMatrix hessian;  // H at the point, of all parameters in their order
  Eigen::Index first_shared = 0;
  bool converged = false;
  Termination termination = Termination::not_evaluable;  // of the last window
  int iterations = 0;                                    // of all windows

  double chi2_per_sample() const { return data_chi2 / static_cast<double>(samples); }
  // χ² of the data over the degrees of freedom, without priors: 1 where the noise is as stated. By
  // its root standard errors widen that shall rest on the scatter instead. 0 without freedom.
  double variance() const;
  // Standard errors of all parameters by the scatter of the data, √(variance · covariance),
  // independent of the stated noise; infinite where undetermined.
  Eigen::VectorXd scatter_errors() const;
  Covariance covariance() const { return covariance_of(hessian.dense()); }
  // Of the shared parameters alone, with free parameters of the runs.
  Covariance shared() const;
  // Covariance of the shared parameters where every parameter has a prior: always finite, whatever
  // the data determine.
  Eigen::MatrixXd shared_posterior() const;

  // Text: one line on how the fit ended, then every parameter with its error, and whether data,
  // prior or a bound determines it.
  std::string report() const;
};

// `start` is a point of the model. Never throws for a model that cannot be evaluated there: χ² is
// then infinite.
Fit fit(const ForwardModel& model, const Eigen::VectorXd& start, const Options& options = {});

}  // namespace photorque::inference
