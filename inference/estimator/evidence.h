// The evidence for a model: the probability of the data under it, whatever its parameters.
//
// Laplace's approximation (D. MacKay, Information Theory, Inference, and Learning Algorithms, 2003,
// eq. 28.5) integrates the posterior as the Gaussian that it is near its maximum. It is exact for
// linear models, and says by how much a better fit must be better to be worth its parameters.
#pragma once

#include <vector>

#include "inference/estimator/fit.h"
#include "inference/limits/thresholds.h"

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

}  // namespace photorque::inference
