// Compares χ² of held-out runs with the value that the fit predicts.
#pragma once

#include "inference/estimator/fit.h"

namespace photorque::inference {

// With n held-out numbers, C the posterior of the shared parameters of `train`, and G what the
// held-out runs say of them (from `joint`, the fit of the same model to all runs): held-out numbers
// vary by their noise and by J C Jᵀ, JᵀJ = G, so that χ²/n against the parameters as they stand has
// the mean 1 + tr(GC)/n and the variance 2 (n + 2 tr(GC) + tr(GCGC))/n². To first order.
struct HeldOutPrediction {
  double chi2_per_sample = 0.0, standard_error = 0.0;  // NaN where a matrix is not finite
};
HeldOutPrediction predict_held_out(const Fit& train, const Fit& joint);

// Standard errors by which held-out χ² per sample lies above its prediction. `noise` ≥ 1: χ² per
// sample of noise alone, as the train runs show it. NaN where nothing is predicted.
double held_out_sigma(const Fit& train, const Fit& joint, double chi2_per_sample, double noise);

}  // namespace photorque::inference
