// Fit of a body that turns about one axis, with all textbook torques together.
#pragma once

#include <optional>

#include "diagnosis/attitude/answer.h"

namespace photorque {

// Fits several laws together: friction and drag by every power of the rate, a steady torque, a
// restoring torque (a weight, a twisted line), and errors of the instruments where `all` has them.
// The fit starts in pieces in which the nominal model stays near the readings, and grows to the
// whole. A nominal model without these torques miscounts the swings, so it is useless as a start
// for predictions; this fit allows each law to be left out. Returns nothing for other machines, or
// if the fit is no nearer to the readings than the nominal model.
std::optional<Trial> fit_textbook_laws(const Fit& nominal_fit, const Candidates& all,
                                       const RecordedData& data);

}  // namespace photorque
