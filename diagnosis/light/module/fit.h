// Hypotheses about a module (parameters, their effect on it, and their priors), and their fit to
// curves.
#pragma once

#include <functional>
#include <span>

#include "diagnosis/light/module/nominal.h"
#include "inference/domain.h"
#include "inference/estimator/fit.h"
#include "inference/estimator/parameter.h"

namespace photorque {

struct ModuleHypothesis {
  std::string kind;         // empty: nothing, or a law without physics
  std::string label;        // as printed: "cell_cracked (3 cells)"
  std::string explanation;  // a sentence of physics without a full stop
  bool is_empirical = false;
  int count = 0;            // of cells; 0: not a number of cells
  int largest_count = 0;    // of those that are tried of the kind
  double alternatives = 1;  // of which this is one: other numbers of cells
  std::vector<inference::Parameter> parameters;
  std::vector<std::vector<double>> starts;  // of the parameters; none: as they are
  std::function<void(std::span<const double> x, ModuleState& state, ModuleCell& cell)> act;
  // Whether the first parameter, a fraction of the light, may limit the current at short circuit,
  // from which the light of a curve is found.
  bool limits_current = false;
  // The keys of the report from the parameters, in SI.
  struct Number {
    std::string key;
    std::function<double(std::span<const double> x)> value;
  };
  std::vector<Number> numbers;
};

// The first is that nothing is missing.
std::vector<ModuleHypothesis> module_hypotheses(const ModuleDesign& design,
                                                const ModuleNominal& nominal);

// Cells of which a part is cut off and that conduct in reverse as `shaded` ones with the numbers
// `own`: with no light on that part, or no connection, the curves differ by n kT/q ln(factor) and
// by the series resistance of one cell. `any_cracked`: one of the other hypotheses of cracks.
ModuleHypothesis cracked_like(const ModuleDesign& design, const ModuleNominal& nominal,
                              const ModuleHypothesis& shaded, std::span<const double> own,
                              const ModuleHypothesis& any_cracked);

// A curve and which of its points are fitted.
struct ModuleRun {
  ModuleSweep sweep;
  double sigma_A = 0.0;
  double irradiance_W_m2 = std::numeric_limits<double>::quiet_NaN();  // by a sensor
};

struct ModuleTrial : inference::Explanation {
  inference::Fit fit;
  Eigen::VectorXd shared;  // those of the nominal module, then the hypothesis' own
};

class ModuleFitter {
 public:
  // All references must outlive this.
  ModuleFitter(const ModuleDesign& design, const ModuleNominal& nominal, const Thresholds& limits)
      : design_(design), nominal_(nominal), limits_(limits) {}

  // From all starts of the hypothesis, or from one.
  ModuleTrial fit(const ModuleHypothesis& h, const std::vector<ModuleRun>& runs,
                  const Eigen::VectorXd* from = nullptr) const;
  // Currents by a fit with the light and temperature that it found for its run number `run`, at the
  // voltages of `at`, a part of the same curve.
  std::vector<ArrayCurve::SlopedPoint> curve(const ModuleHypothesis& h, const ModuleTrial& trial,
                                             size_t run, const ModuleRun& at) const;
  // Measured less predicted over their errors.
  Eigen::VectorXd residuals(const ModuleHypothesis& h, const Eigen::VectorXd& x,
                            const ModuleRun& run) const;
  // Of a run of a trial: its two nuisances, then the shared parameters.
  static Eigen::VectorXd numbers_of(const ModuleTrial& trial, size_t run);

 private:
  // Logarithm of the light where a fit of the run begins.
  double first_light(const ModuleHypothesis& h, const ModuleRun& run,
                     const inference::Parameters& parameters) const;
  ModuleTrial fit_from(const ModuleHypothesis& h, const std::vector<ModuleRun>& runs,
                       const std::vector<double>& own, const Eigen::VectorXd* from) const;

  const ModuleDesign& design_;
  const ModuleNominal& nominal_;
  const Thresholds& limits_;
};

}  // namespace photorque
