// Fit of a body that turns about one axis, with all textbook torques at once.
#pragma once

#include <optional>

#include "diagnosis/attitude/answer.h"

namespace photorque {

// Fits all these together: friction and drag by every power of the rate, a steady torque, a
// restoring torque (a weight, a twisted line), and errors of the instruments where `all` has them.
// The fit starts in pieces in which the nominal model stays near the readings, and then grows to
// the whole. A nominal model without these torques loses count of the swings, so that nothing can
// be predicted about it; about this fit each law can be left out. Nothing for other machines, and
// where the fit does not come nearer to the readings than the nominal model.
std::optional<Trial> fit_textbook_laws(const Fit& nominal_fit, const Candidates& all,
                                       const RecordedData& data);

}  // namespace photorque
