// What a fit predicts of runs that it never saw.
#pragma once

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
};

}  // namespace photorque::inference
