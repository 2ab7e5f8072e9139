// The evidence for a model: the probability of the data under it, averaged over its parameters.
//
// Laplace's approximation (D. MacKay, Information Theory, Inference, and Learning Algorithms, 2003,
// eq. 28.5) integrates the posterior as the Gaussian that it is near its maximum. It is exact for
// linear models, and gives the gain of χ² that additional parameters must bring.
#pragma once

#include <limits>
#include <vector>

#include "inference/estimator/fit.h"
#include "inference/estimator/thresholds.h"

namespace photorque::inference {

// ln p(data | model) of a fit, but for the constant −½ Σ ln(2π noise²) that all models of the same
// data share:
//
//   −½ χ² − Σ_priors ln σ − ½ ln |H| + ½ (parameters without a prior) ln 2π
//
// A parameter without a prior counts as having a flat one of density 1 in its unit: such evidences
// compare only between models that have it in common. −1e300 where the model cannot be evaluated.
double log_evidence(const Fit& fit);

// Strengths: parameters that enter linearly and whose size is unknown beforehand, such as those
// of an effect that was left out of a model.
struct Strengths {
  std::vector<Eigen::Index> at;  // which of the parameters of the covariance
  std::vector<size_t> owner;     // which effect each belongs to
  std::vector<double> value;     // fitted with a flat prior
  std::vector<double> scale;     // expected size of each, > 0
};

// ln ∫ N(θ; 0, S) … over the widths of S: the width of the prior of each effect's strengths, a
// common factor of the expected ones, is uniform in its logarithm over the range that `limits`
// gives (a millionth to a thousand times). With θ̂ and C from a fit with a flat prior, a width
// contributes N(θ̂; 0, C + S) but for a constant. −1e300 where the covariance is not finite.
double log_strength_evidence(const Strengths& strengths, const Eigen::MatrixXd& covariance,
                             size_t effects, const Thresholds::Evidence& limits = {});

// Predictions of runs that were not fitted.

// Prediction of the held-out runs by a trial that was fitted to the train runs alone. The
// prediction includes the uncertainty of the parameters: χ² is minimised over the nuisances of the
// held-out runs and over the parameters, with the posterior of the fit as their prior. This minimum
// is the χ² of the predictive distribution. Its degrees of freedom are the number of readings less
// the number of nuisances. It equals the growth of χ² when the held-out runs are fitted as well.
struct Predictive {
  double chi2_per_sample = 0.0;
  // Excess over noise in standard errors: of χ² as a whole or of the residuals over some neighbours
  // (whiteness.h), whichever is larger.
  double sigma = 0.0;
  // Natural logarithm of the probability of the held-out runs given the others, up to a constant
  // that all trials share.
  double log_score = 0.0;
  // Of the held-out runs against the fitted parameters without their errors, see expected_chi2.
  double expected_chi2_per_sample = std::numeric_limits<double>::quiet_NaN();
};

// Expected χ² per held-out number, where each held-out run starts from its measured initial
// conditions: 1 from noise, and tr(G C)/n from the errors of the parameters. C: the posterior of
// the shared parameters of `train`; G: the information of the held-out runs about them, from
// `joint`, the fit of the same model to all runs; n: the number of held-out numbers. First order;
// NaN where a matrix is not finite.
double expected_chi2_per_sample(const Fit& train, const Fit& joint);

}  // namespace photorque::inference
