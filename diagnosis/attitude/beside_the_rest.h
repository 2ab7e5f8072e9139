// Names beside what stays unexplained, which counts as noise.
#pragma once

#include <optional>

#include "diagnosis/attitude/answer.h"

namespace photorque {

// All candidates; those that need no scan for where to begin; of these the ones of the catalogue;
// of these the torques alone, because instruments that are wrong enough stand in for anything.
enum class Among { all, unscanned, catalogue, torques };

// All candidates of that choice, those of a narrower one first, so that a trial of theirs means the
// same among more.
Candidates candidates_among(Among among, const NominalModel& nominal,
                            const std::vector<Observation>& runs, const Thresholds& limits);

// What names are looked for among, with the rest counted as noise. Where angle and rate about one
// axis are both read, each shows errors of the other's instrument whatever the torque.
Among among_beside_the_rest(const NominalModel& nominal, const RecordedData& data);

// One search, and the decision about it, with the noise that `data` has; from `near`, a trial of no
// more candidates, where that is not null.
Answer searched(const NominalModel& nominal, const Fit& nominal_fit, const RecordedData& data,
                const DiagnoseOptions& options, Among among, const Trial* near);

// What stands out although something unexplained is left, which counts as noise: at first all that
// the nominal model leaves, then what the best explanation does, as long as names come out of it.
// Under as little noise as that of the readings alone whatever is uncertain would give way to
// anything. Every name predicts stretches of the recordings, each from fits to others, better than
// its absence, and differs from nothing by what is left, as correlated as it is. `data` keeps the
// noise of the last search. `laws`, where it is not null, is a fit of torques to the same runs:
// what it leaves is the first noise, and each search begins about it. Nothing where no name comes
// out.
std::optional<Answer> named_beside_the_rest(const NominalModel& nominal, RecordedData& data,
                                            const DiagnoseOptions& options, const Trial* laws);

// Whether a fit to recordings that have only the noise of the readings is near them.
bool leaves_only_noise(const Fit& fit, const RecordedData& data);

}  // namespace photorque
