// The evidence for a model: the likelihood of the data, averaged over the prior of its parameters.
//
// Laplace's approximation (D. MacKay, Information Theory, Inference, and Learning Algorithms, 2003,
// eq. 28.5) replaces the posterior near its maximum by a Gaussian and integrates it. It is exact
// for linear models, and defines how much χ² additional parameters must gain.
#pragma once

#include <limits>
#include <vector>

#include "inference/estimator/fit.h"
#include "inference/estimator/thresholds.h"

namespace photorque::inference {

// ln p(data | model) of a fit, without the constant −½ Σ ln(2π noise²) of the data:
//
//   −½ χ² − Σ_priors ln σ − ½ ln |H| + ½ (parameters without a prior) ln 2π
//
// A parameter without a prior has a flat one of density 1 in its unit, so such evidences are
// comparable only between models that all contain it. −1e300 where the model cannot be evaluated.
double log_evidence(const Fit& fit);

// Strengths: parameters that enter linearly and whose size is unknown in advance, such as those of
// an effect that is missing from a model.
struct Strengths {
  std::vector<Eigen::Index> at;  // index of each parameter in the covariance
  std::vector<size_t> owner;     // index of the effect that each belongs to
  std::vector<double> value;     // fitted with a flat prior
  std::vector<double> scale;     // expected size of each, > 0
};

// ln ∫ N(θ; 0, S) … over the widths of S. The prior width of an effect's strengths is a common
// factor of their expected sizes, log-uniform over the range in `limits` (a millionth to a thousand
// times). With θ̂ and C from a fit with a flat prior, a width contributes N(θ̂; 0, C + S) up to a
// constant. −1e300 where the covariance is not finite.
double log_strength_evidence(const Strengths& strengths, const Eigen::MatrixXd& covariance,
                             size_t effects, const Thresholds::Evidence& limits = {});

// Prediction of the held-out runs by a trial that is fitted to the train runs only. It includes the
// uncertainty of the parameters: χ² is minimised over the nuisance parameters of the held-out runs
// and over the parameters, with the posterior of the train fit as prior. This minimum is the χ² of
// the predictive distribution, with as many degrees of freedom as readings minus nuisance
// parameters. It equals the growth of χ² when the held-out runs are added to the fit.
struct Predictive {
  double chi2_per_sample = 0.0;
  // Excess over noise [standard errors]: of the total χ² or of the means of neighbouring residuals
  // (whiteness.h), whichever is larger.
  double sigma = 0.0;
  // Natural logarithm of the probability of the held-out runs given the train runs, up to a
  // constant that is common to all trials.
  double log_score = 0.0;
  // For the fixed fitted parameters; see predict_held_out().
  double expected_chi2_per_sample = std::numeric_limits<double>::quiet_NaN();
};

// Comparison of the χ² of held-out runs with the value that the fit predicts.

// The held-out χ²/n against the fixed fitted parameters has the mean 1 + tr(GC)/n and the variance
// 2 (n + 2 tr(GC) + tr(GCGC))/n², to first order: n held-out numbers vary by their noise and by J C
// Jᵀ with JᵀJ = G. C is the posterior covariance of the shared parameters of `train`. G is the
// information of the held-out runs about them, from `joint`, the fit of the same model to all runs.
struct HeldOutPrediction {
  double chi2_per_sample = 0.0, standard_error = 0.0;  // NaN where a matrix is not finite
};
HeldOutPrediction predict_held_out(const Fit& train, const Fit& joint);

// Standard errors by which the held-out χ² per sample exceeds its prediction. `noise` ≥ 1 is the χ²
// per sample of noise alone, measured on the train runs. NaN where there is no prediction.
double held_out_sigma(const Fit& train, const Fit& joint, double chi2_per_sample, double noise);

}  // namespace photorque::inference
