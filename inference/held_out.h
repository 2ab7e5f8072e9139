// Compares χ² of held-out runs with the value that the fit predicts.
#pragma once

#include "inference/estimator/fit.h"

namespace photorque::inference {

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
