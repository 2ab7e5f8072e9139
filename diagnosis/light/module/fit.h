// A hypothesis fitted to curves of a module.
#pragma once

#include "diagnosis/light/module/hypothesis.h"
#include "inference/domain.h"
#include "inference/estimator/fit.h"

namespace photorque {

// A curve and which of its points are fitted.
struct ModuleRun {
  ModuleSweep sweep;
  double sigma_A = 0.0;
};

struct ModuleTrial : inference::Explanation {
  inference::Fit fit;
  Eigen::VectorXd shared;  // the nominal module's five, then the hypothesis' own
};

class ModuleFitter {
 public:
  // All references must outlive this.
  ModuleFitter(const ModuleDesign& design, const ModuleNominal& nominal, const Thresholds& limits)
      : design_(design), nominal_(nominal), limits_(limits) {}

  // From all starts of the hypothesis, or from one.
  ModuleTrial fit(const ModuleHypothesis& h, const std::vector<ModuleRun>& runs,
                  const Eigen::VectorXd* from = nullptr) const;
  // Currents by a fit with the light and temperature that it found for a run.
  std::vector<ArrayCurve::SlopedPoint> curve(const ModuleHypothesis& h, const ModuleTrial& trial,
                                             size_t run,
                                             const std::vector<double>& voltage_V) const;
  // Measured less predicted over their errors.
  Eigen::VectorXd residuals(const ModuleHypothesis& h, const Eigen::VectorXd& x,
                            const ModuleRun& run) const;
  // Of a run of a trial: its two nuisances, then what is shared.
  static Eigen::VectorXd numbers_of(const ModuleTrial& trial, size_t run);

 private:
  ModuleTrial fit_from(const ModuleHypothesis& h, const std::vector<ModuleRun>& runs,
                       const std::vector<double>& own, const Eigen::VectorXd* from) const;

  const ModuleDesign& design_;
  const ModuleNominal& nominal_;
  const Thresholds& limits_;
};

}  // namespace photorque
