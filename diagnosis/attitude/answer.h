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
  // Before the runs held out count: in one that diverges there all explanations differ by chance.
  std::vector<Where::Dependence> depends_on;
  inference::Decision decision;
  // Whether the decision counted the unexplained residual as noise.
  bool rest_is_noise = false;
  // If so, and if effects are named: gains in prediction of the names of the chosen trial. `sigma`:
  // standard errors by which segments are predicted better with the name than without it.
  struct BesideTheRest {
    size_t stretches = 0;
    std::vector<double> sigma;                     // of each candidate of the chosen trial
    std::vector<std::vector<std::string>> rivals;  // of each: names not distinguished from it
  };
  std::optional<BesideTheRest> beside = {};

  const Trial& chosen() const { return trials[decision.chosen]; }
};

// The answer to recordings to which the nominal model was fitted. Every effect is scored; the best
// sets are fitted, compared and weighted by the held-out data, and decided about with the noise of
// the readings. A residual above noise then counts as noise. Its level is the residual of the best
// explanation, and the search is repeated while that level falls. Names then have to predict
// segments, each from fits to others. `data` gains the noise that the readings show about the best
// explanation, and `nominal_fit` is fitted with it.
Answer explain(const NominalModel& nominal, RecordedData& data, const DiagnoseOptions& options,
               Fit& nominal_fit);

// Of two explanations that differ in one name: by how much the first's is the simpler one (below
// zero: the second's), where both brake (by the power of the speed, braking_power()) or both push
// steadily (by their parameters: a spring without stiffness is a slope). Nothing for others. Of
// such names the higher one stands only where the lower one does not do as well (marginality: J. A.
// Nelder, J. R. Statist. Soc. A 140 (1977) 48).
std::optional<double> simpler_by(const Trial& first, const Trial& second, const Answer& answer);

void tell(const DiagnoseOptions& options, const std::string& what);

}  // namespace photorque
