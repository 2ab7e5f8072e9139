// Initial conditions of runs without readings of attitude: a search over many starts.
#pragma once

#include <vector>

#include "attitude/estimation/fit.h"

namespace photorque {

// Chooses the starts of runs that have scalar readings (recordings/columns.h) but no attitude
// readings. A tilt does not determine its direction, nor the magnitude of a rate its axis, and fits
// from a wrong start end in other local minima. Many tilt directions and rotation axes are tried.
// The one whose fit of the first blocks has the smallest χ² becomes the start. Other runs keep
// their start.
void choose_starts(Hypothesis& hypothesis, const std::vector<Observation>& runs);

}  // namespace photorque
