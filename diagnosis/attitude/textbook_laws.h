// Fit of a body that turns about one axis, with all textbook torques at once.
#pragma once

#include <optional>

#include "diagnosis/attitude/answer.h"

namespace photorque {

// Friction and drag by every power of the rate, a steady torque, and what pulls back (a weight, a
// twisted line), and errors of the instruments where `all` has them, fitted together: first in
// pieces in which the nominal model stays near the readings, then to the growing whole. A nominal
// model without them loses count of the swings, and about it nothing can be predicted; about this
// fit each law can be left out. Nothing for other machines, and where the fit does not come nearer
// to the readings than the nominal model.
std::optional<Trial> fit_textbook_laws(const Fit& nominal_fit, const Candidates& all,
                                       const RecordedData& data);

}  // namespace photorque
