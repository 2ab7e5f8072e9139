// Fit of a body that turns about one axis, with all textbook torques together.
#pragma once

#include <optional>
#include <vector>

#include "diagnosis/attitude/answer.h"

namespace photorque {

// Fits several laws together: friction and drag by every power of the rate, a steady torque, a
// restoring torque (a weight, a twisted line), and errors of the instruments where `all` has them.
// The fit starts in pieces in which the nominal model stays near the readings, and grows to the
// whole recordings. A nominal model without these torques miscounts the swings, so it is no start
// for predictions. This fit allows each law to be left out. Returns nothing for other machines, or
// if the fit is no nearer to the readings than the nominal model.
std::optional<Trial> fit_textbook_laws(const Fit& nominal_fit, const Candidates& all,
                                       const RecordedData& data);

// Fits every set of friction and drag laws in place of those of `found`, whose other laws remain.
// The sets are each power of the rate alone, and dry, viscous and quadratic friction in pairs and
// together. A search that adds laws one by one misses sets, because friction and drag imitate each
// other. Fits start from `found` and from the strengths along the recorded curve (laws_of_curve.h).
// Sets that are unphysical, and those whose χ² is far above that of the best, are omitted.
// `nominal` is fitted to the same runs.
std::vector<Trial> fit_sets_of_brakes(const Trial& nominal, const Trial& found,
                                      const Candidates& all, const RecordedData& data, int threads);

}  // namespace photorque
