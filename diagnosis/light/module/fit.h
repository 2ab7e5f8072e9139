// Hypotheses about a module (parameters, their effect, their priors) and their fit to curves.
#pragma once

#include <functional>
#include <span>

#include "diagnosis/light/module/nominal.h"
#include "inference/domain.h"
#include "inference/estimator/fit.h"
#include "inference/estimator/parameter.h"

namespace photorque {

struct ModuleHypothesis {
  std::string kind;         // empty: no effect, or an empirical law
  int effects = 0;          // number of effects; 2 for a pair
  std::string label;        // as printed: "cell_cracked (3 cells)"
  std::string explanation;  // a sentence of physics without a full stop
  bool is_empirical = false;
  int count = 0;            // number of cells; 0: not applicable
  int largest_count = 0;    // largest count of the tested hypotheses of the kind
  double alternatives = 1;  // number of alternatives, including this: other numbers of cells
  std::vector<inference::Parameter> parameters;
  std::vector<std::vector<double>> starts;  // starts of the parameters; empty: their values
  std::function<void(std::span<const double> x, ModuleState& state, ModuleCell& cell)> act;
  // Whether the first parameter, a fraction of the light, may limit the short-circuit current, from
  // which the light of a curve is estimated.
  bool limits_current = false;
  // Keys of the report computed from the parameters, in SI.
  struct Number {
    std::string key;
    std::function<double(std::span<const double> x)> value;
  };
  std::vector<Number> numbers;
  // For two effects together, the index of each among the hypotheses, and its parameters here.
  struct Member {
    size_t hypothesis;
    std::vector<size_t> at;
  };
  std::vector<Member> members;
};

// All hypotheses about the module of a design; the first one is "nothing missing".
std::vector<ModuleHypothesis> module_hypotheses(const ModuleDesign& design,
                                                const ModuleNominal& nominal);

// Cracked cells with reverse conduction, similar to the `shaded` ones with parameters `own`. A part
// of a cell without light and a part without connection change the curve almost equally: the curves
// differ by n kT/q ln(factor) and by the series resistance of one cell. `any_cracked`: one of the
// other hypotheses of cracks.
ModuleHypothesis cracked_hypothesis(const ModuleDesign& design, const ModuleNominal& nominal,
                                    const ModuleHypothesis& shaded, std::span<const double> own,
                                    const ModuleHypothesis& any_cracked);

// Two effects together. The breakdown of the cells and the drop of the diodes are properties of the
// type of module and therefore common to both. `of_a` and `of_b`: indices of the effects.
ModuleHypothesis both(const ModuleHypothesis& a, size_t of_a, const ModuleHypothesis& b,
                      size_t of_b);

// A curve with the selection of its fitted points.
struct ModuleRun {
  ModuleSweep sweep;
  double sigma_A = 0.0;
  double irradiance_W_m2 = std::numeric_limits<double>::quiet_NaN();  // from a sensor
};

struct ModuleTrial : inference::Explanation {
  inference::Fit fit;
  Eigen::VectorXd shared;  // parameters of the nominal module, then of the hypothesis
  // χ² of the deviations of the module from its references and of the temperatures from the
  // thermometer, and its excess over chance [sigma].
  double prior_chi2() const;
  double prior_excess_sigma() const;

 private:
  double runs() const;
};

class ModuleFitter {
 public:
  // All references must outlive this object.
  ModuleFitter(const ModuleDesign& design, const ModuleNominal& nominal, const Thresholds& limits)
      : design_(design), nominal_(nominal), limits_(limits) {}

  // Fits from all starts of the hypothesis, or from one.
  ModuleTrial fit(const ModuleHypothesis& h, const std::vector<ModuleRun>& runs,
                  const Eigen::VectorXd* from = nullptr) const;
  // Currents of a fit at the voltages of `at`, a part of run number `run`, with the fitted light
  // and temperature of that run.
  std::vector<ArrayCurve::SlopedPoint> curve(const ModuleHypothesis& h, const ModuleTrial& trial,
                                             size_t run, const ModuleRun& at) const {
    return curve(h, numbers_of(trial, run), at);
  }
  // Residuals (measured − predicted)/error of the points of a run at parameters x.
  Eigen::VectorXd residuals(const ModuleHypothesis& h, const Eigen::VectorXd& x,
                            const ModuleRun& run) const;
  // Parameters of one run of a trial: its two nuisance parameters, then the shared ones.
  static Eigen::VectorXd numbers_of(const ModuleTrial& trial, size_t run);

 private:
  // Currents at parameters x.
  std::vector<ArrayCurve::SlopedPoint> curve(const ModuleHypothesis& h, const Eigen::VectorXd& x,
                                             const ModuleRun& at) const;
  // Initial log light of the run in a fit.
  double first_light(const ModuleHypothesis& h, const ModuleRun& run,
                     const inference::Parameters& parameters) const;
  // `from`: shared parameters, or nullptr for `own` and the nominal module; `at`: all parameters.
  // `translates`: whether the powers of the translation are free.
  ModuleTrial fit_from(const ModuleHypothesis& h, const std::vector<ModuleRun>& runs,
                       const std::vector<double>& own, const Eigen::VectorXd* from,
                       const Eigen::VectorXd* at, bool translates) const;

  const ModuleDesign& design_;
  const ModuleNominal& nominal_;
  const Thresholds& limits_;
};

}  // namespace photorque
