// An explanation of recordings of light and power: the nominal model and some candidates, fitted.
#pragma once

#include "diagnosis/light/candidate.h"
#include "inference/domain.h"
#include "inference/estimator/fit.h"

namespace photorque {

struct LightTrial : inference::Explanation {
  inference::Fit fit;
  std::vector<double> priors;          // shifts of uncertain numbers, in their sigmas
  std::vector<std::vector<double>> x;  // of each candidate, all its numbers
};

// Where a fit of a candidate starts.
struct LightStart {
  std::vector<double> x;
  double gain = inference::infinity;  // fall of χ² that a scan predicts; infinite: none was made
};

// Whether a lamp's derating, fitted as `column`, leaves nothing of it.
bool leaves_nothing(double derating, const inference::Fit& fit, Eigen::Index column);

// The state of a trial.
LightState state_of(const LightTrial& trial, const LightCandidates& all);

// The experiment alone.
LightTrial nominal_light_trial(const LightCandidates& all, const std::vector<FittedRun>& runs);

// Candidates with the numbers where their fit starts, fitted with the priors.
LightTrial fit_light(const LightCandidates& all, const std::vector<size_t>& candidates,
                     const std::vector<std::vector<double>>& x, const std::vector<double>& priors,
                     const std::vector<FittedRun>& runs, int max_iterations);

// Predicts other recordings with the numbers of the trial: nothing is fitted.
LightTrial predict_light(const LightTrial& trial, const LightCandidates& all,
                         const std::vector<FittedRun>& runs);

// Residuals of one recording.
Eigen::VectorXd residuals_of(const LightTrial& trial, const LightCandidates& all,
                             const FittedRun& run);

// ∂(predicted/noise) of one recording by the priors, by all that the trial's candidates fit, and
// by the strengths of further terms at no strength; and the residuals.
struct LightSlopes {
  Eigen::VectorXd residuals;
  Eigen::MatrixXd slopes;
};
LightSlopes slopes_of(const LightTrial& trial, const LightCandidates& all,
                      const std::vector<inference::Term<LightStart>>& more, const FittedRun& run);

// Columns of a trial's candidate among all that is fitted.
std::vector<Eigen::Index> columns_of(const LightTrial& trial, const LightCandidates& all,
                                     size_t which);

}  // namespace photorque
