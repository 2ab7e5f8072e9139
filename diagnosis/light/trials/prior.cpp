#include "diagnosis/light/trials/prior.h"

namespace photorque {

Eigen::MatrixXd slopes_by_priors(const LightRun& run, const std::vector<LightPrior>& priors) {
  Eigen::MatrixXd slopes(static_cast<Eigen::Index>(run.samples()),
                         static_cast<Eigen::Index>(priors.size()));
  const auto residuals = [&](const LightPrior::Side& side) {
    const LightRun there = run.in(*side.lab);
    return there.residuals(side.state, there.signals(side.state, there.fields(side.state, nullptr)),
                           nullptr);
  };
  for (size_t k = 0; k < priors.size(); ++k) {
    const LightPrior::Side &low = priors[k].low, &high = priors[k].high;
    slopes.col(static_cast<Eigen::Index>(k)) =
        (residuals(low) - residuals(high)) / (high.errors - low.errors);
  }
  return slopes;
}

}  // namespace photorque
