// What a fit predicts of runs that it never saw.
#pragma once

#include <limits>

#include "inference/estimator/fit.h"

namespace photorque::inference {

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
