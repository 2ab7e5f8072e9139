// An explanation of recordings of light and power: the nominal model and some candidates, fitted.
#pragma once

#include "diagnosis/light/candidate.h"
#include "inference/domain.h"
#include "inference/estimator/fit.h"

namespace photorque {

struct LightTrial : inference::Explanation {
  inference::Fit fit;
  std::vector<double> priors;          // shifts of uncertain values, in sigmas
  std::vector<std::vector<double>> x;  // parameters of each candidate
};

// Start of a candidate's fit.
struct LightStart {
  std::vector<double> x;
  double gain = inference::infinity;  // predicted fall of χ² from a scan; infinite without one
};

// Whether a lamp's derating, fitted as `column`, leaves no light.
bool leaves_no_light(double derating, const inference::Fit& fit, Eigen::Index column);

// The physical state of a trial.
LightState state_of(const LightTrial& trial, const LightCandidates& all);

// The trial without candidates.
LightTrial nominal_light_trial(const LightCandidates& all, const std::vector<FittedRun>& runs);

// Fits candidates with the priors, starting from the numbers `x`.
LightTrial fit_light(const LightCandidates& all, const std::vector<size_t>& candidates,
                     const std::vector<std::vector<double>>& x, const std::vector<double>& priors,
                     const std::vector<FittedRun>& runs, int max_iterations);

// Predicts other recordings with the trial's numbers without a fit.
LightTrial predict_light(const LightTrial& trial, const LightCandidates& all,
                         const std::vector<FittedRun>& runs);

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
                      const std::vector<inference::Term<LightStart>>& more, const FittedRun& run);

// Columns of a trial's candidate among all fitted numbers.
std::vector<Eigen::Index> columns_of(const LightTrial& trial, const LightCandidates& all,
                                     size_t which);

}  // namespace photorque
