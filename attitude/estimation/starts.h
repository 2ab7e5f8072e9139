// Initial conditions of runs without readings of attitude and rates: a search over many starts.
#pragma once

#include <vector>

#include "attitude/estimation/fit.h"

namespace photorque {

// A tilt has no direction and the magnitude of a rate no axis, and fits from the wrong one end in
// other minima. Runs that are read by scalars (recordings/columns.h) and not by an attitude begin
// where, of leans and axes all around, the fit of their first blocks ends best. Other runs keep the
// start that they have.
void choose_starts(Hypothesis& hypothesis, const std::vector<Observation>& runs);

}  // namespace photorque
