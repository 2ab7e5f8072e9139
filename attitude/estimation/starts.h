// Where runs begin that show neither their attitude nor their rates: searched among many starts.
#pragma once

#include <vector>

#include "attitude/estimation/fit.h"

namespace photorque {

// A tilt does not say whereto the body leans, the magnitude of a rate not about which axis it
// turns, and fits from the wrong one end in other minima. Runs that are read by scalars
// (recordings/columns.h) and not by an attitude begin where, of leans and axes all around, the fit
// of their own first blocks ends best. Other runs keep the start that they have.
void choose_starts(Hypothesis& hypothesis, const std::vector<Observation>& runs);

}  // namespace photorque
