// What explains recordings of light as well as an effect that was found.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/light/account.h"

namespace photorque {

// Kinds other than that of the chosen trial's candidate `which` that explain all `runs` as well in
// its place.
std::vector<std::string> light_rivals(const LightAnswer& answer, size_t which,
                                      const std::vector<FittedRun>& runs);

}  // namespace photorque
