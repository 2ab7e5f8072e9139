// An explanation of recordings of light and power: the nominal model and some candidates, fitted.
#pragma once

#include "diagnosis/light/candidate.h"
#include "inference/estimator/fit.h"

namespace photorque {

struct LightTrial : inference::Explanation {
  inference::Fit fit;
  std::vector<double> priors;          // shifts of uncertain values, in sigmas
  std::vector<std::vector<double>> x;  // parameters of each candidate
};

// Whether a lamp's derating, fitted as `column`, leaves no light.
bool leaves_no_light(double derating, const inference::Fit& fit, Eigen::Index column);

// The physical state of a trial.
LightState state_of(const LightTrial& trial, const LightCandidates& all);

// The trial without candidates.
LightTrial nominal_light_trial(const LightCandidates& all, const std::vector<FittedRun>& runs);

// The trial with one more candidate that has the numbers `x`, or without its candidate `which`; not
// fitted.
LightTrial with_candidate(LightTrial trial, size_t candidate, const std::vector<double>& x);
LightTrial without_candidate(LightTrial trial, size_t which);

// Residuals of one recording.
Eigen::VectorXd residuals_of(const LightTrial& trial, const LightCandidates& all,
                             const FittedRun& run);

// Residuals of one recording, and derivatives of predicted/noise with respect to the priors, the
// fitted parameters of the candidates, and the strengths of further terms at zero strength.
struct LightSlopes {
  Eigen::VectorXd residuals;
  Eigen::MatrixXd slopes;
};
LightSlopes slopes_of(const LightTrial& trial, const LightCandidates& all,
                      const LightCandidates::Terms& more, const FittedRun& run);

// Fall of χ² by a linear fit with the normal matrix H and the gradient g.
double linear_gain(Eigen::MatrixXd H, const Eigen::VectorXd& g);

// Number of all fitted numbers of a trial: the priors, then those of its candidates.
Eigen::Index fitted_numbers(const LightTrial& trial, const LightCandidates& all);

// Columns of a trial's candidate among all fitted numbers.
std::vector<Eigen::Index> columns_of(const LightTrial& trial, const LightCandidates& all,
                                     size_t which);

}  // namespace photorque
