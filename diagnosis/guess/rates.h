// About which axes the three rates of a recording turn.
#pragma once

#include <optional>
#include <vector>

#include "attitude/observation/observation.h"

namespace photorque {

// Whether the rates have no mean, as those of a swing. A free body rotates in one sense about one
// of its principal axes.
bool has_no_mean_rate(const std::vector<Observation>& runs);

// The body axis (0 to 2) that is nearest to the line along which nearly all of the rate lies.
// `across`: the largest rate across this line, as a fraction of that along it. Returns nothing if
// there is no such line.
std::optional<int> axis_of_swing(const std::vector<Observation>& runs, double across);

// The axis with nearly all of the rate; none if several have significant rates.
std::optional<int> only_axis(const std::vector<Observation>& runs);

}  // namespace photorque
