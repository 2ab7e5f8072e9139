// The evidence for a model: the probability of the data under it, whatever its parameters.
//
// Laplace's approximation (D. MacKay, Information Theory, Inference, and Learning Algorithms, 2003,
// eq. 28.5) integrates the posterior as the Gaussian that it is near its maximum. It is exact for
// linear models, and says by how much a better fit must be better to be worth its parameters.
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

// Strengths: parameters that enter linearly and whose size nobody knows beforehand, such as those
// of an effect that was left out of a model.
struct Strengths {
  std::vector<Eigen::Index> at;  // which of the parameters of the covariance
  std::vector<size_t> owner;     // which effect each belongs to
  std::vector<double> value;     // fitted with a flat prior
  std::vector<double> scale;     // what is expected of each, > 0
};

// ln ∫ N(θ; 0, S) … over the widths of S: the width of the prior of each effect's strengths, a
// common factor of the expected ones, is uniform in its logarithm over the range that `limits`
// gives (a millionth to a thousand times). With θ̂ and C from a fit with a flat prior, a width
// contributes N(θ̂; 0, C + S) but for a constant. −1e300 where the covariance is not finite.
double log_strength_evidence(const Strengths& strengths, const Eigen::MatrixXd& covariance,
                             size_t effects, const Thresholds::Evidence& limits = {});

// What a fit predicts of runs that it never saw.

// How a trial, fitted to the train runs alone, predicts those held out. Its parameters are as
// uncertain as the fit says, and so is the prediction: the least of χ² over the held-out runs'
// nuisances and the parameters, these with the fit's posterior as their prior, is that of the
// predictive distribution, with as many degrees of freedom as there are numbers, less the
// nuisances. It is by how much χ² grows when the held-out runs are fitted as well.
struct Predictive {
  double chi2_per_sample = 0.0;
  // Beyond what noise makes, in standard errors: of χ² as a whole or of what is left over some
  // neighbours (whiteness.h), whichever is larger.
  double sigma = 0.0;
  // Natural logarithm of the probability of the held-out runs given the others, up to a constant
  // that all trials share.
  double log_score = 0.0;
  // Of the held-out runs against the fitted parameters as they stand, as expected_chi2 says.
  double expected_chi2_per_sample = std::numeric_limits<double>::quiet_NaN();
};

// What the parameters of a fit leave per number of runs that it never saw, each of which starts
// where it was seen to: 1 by their noise, and by the errors of the parameters, which the motion
// carries along, tr(G C)/n more. C: the posterior of the shared parameters of `train`; G: what
// the held-out runs tell of them, from `joint`, the fit of the same model to all runs; n: held-out
// numbers. To first order; NaN where a matrix is not finite.
double expected_chi2_per_sample(const Fit& train, const Fit& joint);

}  // namespace photorque::inference
