#include "attitude/estimation/fit.h"

#include "attitude/estimation/forward_model.h"
#include "inference/estimator/bounds.h"

namespace photorque {

Fit fit(const Hypothesis& start, const std::vector<Observation>& runs,
        const FitSettings& settings) {
  const AttitudeForwardModel model(start, runs, {}, settings.tolerance);
  Fit result{inference::fit(model, model.point_of(start), settings), {}};
  result.best = model.hypothesis_at(result.at);
  return result;
}

Hypothesis within_bounds(const Fit& fit, std::vector<Free> free,
                         const std::vector<Observation>& runs) {
  Hypothesis bounded = fit.best;
  bounded.free = std::move(free);
  const AttitudeForwardModel model(bounded, runs, {}, FitSettings().tolerance);
  const inference::Parameters at = model.parameters(fit.at);
  return model.hypothesis_at(model.stepped(fit.at, inference::step_to_bounds(fit.hessian, at)));
}

inference::SumsOfRuns sums_at(const Hypothesis& at, const std::vector<Observation>& runs,
                              const std::vector<Free>& extra, double tolerance) {
  const AttitudeForwardModel model(at, runs, extra, tolerance);
  return inference::evaluate(model, model.point_of(at), {}).sums;
}

std::vector<Prediction> residuals_of(const Fit& fit, const std::vector<Observation>& runs) {
  PredictionOptions options;
  options.keep_residuals = true;
  std::vector<Prediction> all;
  for (size_t run = 0; run < runs.size(); ++run) {
    const Dynamics dynamics(fit.best.model_of(run, runs[run]));
    all.push_back(predict(dynamics, fit.best.runs[run].initial, runs[run], {}, options));
  }
  return all;
}

}  // namespace photorque
