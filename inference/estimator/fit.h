// Nonlinear least squares with priors, bounds and nuisance parameters: the estimator of all fits.
//
// The fit minimises over the parameters θ of a forward model (forward_model.h)
//
//   χ²(θ) = Σ_runs Σ_i r_i(θ)² + Σ_k ((θ_k − μ_k)/σ_k)²   with   lowest_k ≤ θ_k ≤ highest_k,
//
// where r are residuals divided by their noise, and μ, σ are those of Gaussian priors. Up to a
// constant χ² is −2 times the log posterior. With H = Jᵀ J + Σ⁻¹ (Gauss-Newton approximation of
// half the second derivative) and g = −½ ∂χ²/∂θ, each iteration solves
//
//   (H + λ D) δ = g,   D = diag H
//
// (K. Levenberg 1944; D. Marquardt, J. SIAM 11 (1963) 431). The matrix is scaled to a unit
// diagonal, so that no result depends on the units of parameters. A step that lowers χ² is
// accepted. If χ² fell by more than a quarter of the predicted gain, λ is divided by ten, or kept
// if the step before had been rejected; otherwise λ is tripled. A step that does not lower χ² is
// repeated with ten times λ, at least 1e-4. A parameter on a bound that the step would leave is
// held there, and the step is solved again.
//
// A window is the first part of every run. Growing windows improve a poor start before a long run
// can diverge from it.
#pragma once

#include <vector>

#include "inference/estimator/covariance.h"
#include "inference/estimator/forward_model.h"

namespace photorque::inference {

struct Options {
  std::vector<double> windows = {1.0};  // fractions of each run that are fitted in turn, in (0, 1]
  int max_iterations = 25;              // > 0, per window
  // A window has converged when the predicted gain of the next step is below the larger of these
  // limits. In units of χ²: a parameter is then within √min_gain standard errors of the minimum.
  double min_gain = 0.01;
  double min_gain_fraction = 1e-6;  // fraction of χ²; negligible in a bad fit
  // Whether to continue with untested steps as long as their predicted gains fall. χ² resolves
  // parameters only to 1e-7 of their errors; its gradient is more precise.
  bool polish = false;
  // A start with a larger χ² counts as not evaluable, which saves its derivatives.
  double max_start_chi2 = infinity;
  // A fit of whole runs stops if χ² falls too slowly to reach this limit. Earlier windows then only
  // improve the start, in at most 20 iterations; a window whose χ² alone stays above the limit ends
  // the fit as if it could not be evaluated. Infinite: off.
  double worth_chi2 = infinity;
  // Stops a fit of whole runs that is bad and stalls: χ² per sample above 1.2, and a mean fall per
  // step over the last six steps below this fraction. 0: off.
  double min_relative_decrease = 0.0;
  double initial_damping = 1e-9;  // λ, ≥ 0
  double min_damping = 0.0;       // ≥ 0; fixes undetermined combinations at their values
  double max_damping = 1e9;       // beyond it no step lowers χ²
  // D is the largest diagonal so far in a window instead of the present one (J. J. Moré, Lecture
  // Notes in Mathematics 630 (1978) 105). A parameter whose slopes vanish on the way, such as the
  // rate of an exponential that has decayed, then does not diverge.
  bool keep_largest_scale = false;

  // Converges to double precision, for problems whose evaluation costs next to nothing.
  static Options to_rounding();

  // Throws InputError where a value is out of range.
  void check() const;
};

enum class Termination {
  converged,       // the predicted gain of a step is below the limit
  no_step_lowers,  // limit of precision of χ² or the derivatives
  max_iterations,
  out_of_reach,   // worth_chi2 cannot be reached
  not_evaluable,  // the model could not be evaluated at the start
};

struct Fit {
  Eigen::VectorXd at;           // final point of the model
  Parameters parameters;        // at the final point
  double chi2 = infinity;       // including the priors
  double data_chi2 = infinity;  // excluding the priors
  int64_t samples = 0;
  std::vector<double> run_chi2;  // one per run, excluding the priors
  ArrowMatrix hessian;           // H at the final point, of all parameters in their order
  Eigen::Index first_shared = 0;
  bool converged = false;
  Termination termination = Termination::not_evaluable;  // termination of the last window
  int iterations = 0;                                    // total of all windows

  double chi2_per_sample() const { return data_chi2 / static_cast<double>(samples); }
  // Data χ² per degree of freedom, without priors: 1 if the noise is as stated, 0 without degrees
  // of freedom. Standard errors multiplied by its square root are based on the scatter of the data
  // instead of the stated noise.
  double variance() const;
  // Standard errors of all parameters from the scatter of the data, √(variance · covariance),
  // independent of the stated noise; infinite where undetermined.
  Eigen::VectorXd scatter_errors() const;
  Covariance covariance() const { return covariance_of(hessian.dense()); }
  // Covariance of the shared parameters, marginalised over those of the runs.
  Covariance shared() const;
  // Covariance of the shared parameters if every parameter has a prior: always finite.
  Eigen::MatrixXd shared_posterior() const;
};

// Fits the parameters of the model, starting from `start`, a point of the model. Does not throw if
// the model cannot be evaluated there: χ² is then infinite.
Fit fit(const ForwardModel& model, const Eigen::VectorXd& start, const Options& options = {});

}  // namespace photorque::inference
