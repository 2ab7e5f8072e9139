// Result of search and decision for recordings of motion.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "diagnosis/attitude/effects/trial.h"
#include "diagnosis/attitude/recorded_data.h"
#include "diagnosis/diagnosis.h"
#include "inference/decide.h"

namespace photorque {

// All fits, and the decision about them.
struct Answer {
  Candidates all;
  std::vector<Trial> trials;
  // Variables on which the nominal model's residual depends. Computed before the held-out runs are
  // used, because all explanations of a diverged run differ by chance.
  std::vector<Where::Dependence> depends_on;
  inference::Decision decision;
  // Whether the decision treated the unexplained residual as noise.
  bool rest_is_noise = false;
  // Set if `rest_is_noise` and effects are named: the evidence for each name of the chosen trial.
  // `sigma` is the improvement of the prediction of segments by a name, in standard errors.
  struct WithDiscrepancy {
    size_t segments = 0;
    std::vector<double> sigma;                     // for each candidate of the chosen trial
    std::vector<std::vector<std::string>> rivals;  // for each: indistinguishable names
    std::vector<std::string> tied;                 // sets of names that predict as well
  };
  std::optional<WithDiscrepancy> beside = {};

  const Trial& chosen() const { return trials[decision.chosen]; }
};

// Explains recordings to which the nominal model is fitted. Every effect is scored; the best sets
// are fitted, compared and weighed with the held-out data. The decision first uses the noise of the
// readings. A residual above it then counts as noise at the level of the best explanation, and the
// search is repeated while that level falls. Names must then predict segments, each from fits to
// other segments. `data` receives the noise estimate about the best explanation, and `nominal_fit`
// is fitted with it.
Answer explain(const NominalModel& nominal, RecordedData& data, const DiagnoseOptions& options,
               Fit& nominal_fit);

// Compares two explanations that differ in one name. A positive result means that the name of the
// first is simpler. Two kinds of drag are compared by the power of the speed (braking_power()), two
// steady forces by the number of parameters (a spring without stiffness is a slope); others give 0.
// The more complex name is kept only if the simpler one fits worse (marginality: J. A. Nelder, J.
// R. Statist. Soc. A 140 (1977) 48).
std::optional<double> simpler_by(const Trial& first, const Trial& second, const Answer& answer);

// Reports the name of a step to `options.progress`, if that is set.
void report_step(const DiagnoseOptions& options, const std::string& what);

}  // namespace photorque
