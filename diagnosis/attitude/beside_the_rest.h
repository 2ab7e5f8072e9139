// Names beside what stays unexplained, which counts as noise.
#pragma once

#include <optional>

#include "diagnosis/attitude/answer.h"

namespace photorque {

// All candidates; those that need no scan for where to begin; of these the torques of the catalogue
// alone, because instruments that are wrong enough stand in for anything.
enum class Among { all, unscanned, torques };

// One search, and the decision about it, with the noise that `data` has; from `near`, a trial of no
// more candidates, where that is not null.
Answer searched(const NominalModel& nominal, const Fit& nominal_fit, const RecordedData& data,
                const DiagnoseOptions& options, Among among, const Trial* near);

// What stands out although something unexplained is left, which counts as noise: at first all that
// the nominal model leaves, then what the best explanation does, as long as names come out of it.
// Under as little noise as that of the readings alone whatever is uncertain would give way to
// anything. Every name predicts stretches of the recordings, each from fits to others, better than
// its absence, and differs from nothing by what is left, as correlated as it is. `data` keeps the
// noise of the last search. Nothing where no name comes out.
std::optional<Answer> named_beside_the_rest(const NominalModel& nominal, RecordedData& data,
                                            const DiagnoseOptions& options);

// Whether a fit to recordings that have only the noise of the readings is near them.
bool leaves_only_noise(const Fit& fit, const RecordedData& data);

}  // namespace photorque
