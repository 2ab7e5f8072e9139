// How strong the effects of a case are: fitted to what its readings can show of each.
#pragma once

#include "tools/proof/case.h"
#include "tools/proof/recipes.h"

namespace photorque::injected {

// What chi² of the first run gains by knowing each effect, with all numbers of the case's other
// effects free; of a law outside the catalogue, with those of the whole catalogue free.
struct Strengths {
  std::vector<double> gains;
  // Sets of kinds that leave within the noise what one or two of the effects do.
  std::vector<std::vector<std::string>> doubles;

  double least() const;  // 0 where there are none
};

// Scales the effects until each gains about what is `wanted` of it, as far as its recipe allows
// `loosened` times over. More than 5e4 is extrapolated from there in proportion to the squared
// strength, and taken back until the platform keeps to motions that are physical.
Strengths fit_strengths(InjectedCase& c, const std::vector<Recipe>& recipes,
                        const std::vector<double>& wanted, double loosened);

// Whether the platform of both runs is a body, stays upright where it stands on something, and
// turns no faster than instruments can follow.
bool stays_physical(const InjectedCase& c);

}  // namespace photorque::injected
