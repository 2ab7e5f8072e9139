#include "attitude/estimation/fit.h"

#include "attitude/estimation/forward_model.h"

namespace photorque {

Fit fit(const Hypothesis& start, const std::vector<Observation>& runs,
        const FitSettings& settings) {
  const AttitudeForwardModel model(start, runs, {}, settings.tolerance);
  Fit result{inference::fit(model, model.point_of(start), settings), {}};
  result.best = model.hypothesis_at(result.at);
  return result;
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
