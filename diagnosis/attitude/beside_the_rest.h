// Names with an unexplained residual, which counts as noise.
#pragma once

#include <optional>

#include "diagnosis/attitude/answer.h"

namespace photorque {

// All candidates; those whose start needs no scan; of these the ones of the catalogue; of these the
// torques alone, because large instrument errors can imitate any effect.
enum class Among { all, unscanned, catalogue, torques };

// All candidates of that choice, those of a narrower one first, so that a trial of theirs means the
// same among more.
Candidates candidates_among(Among among, const NominalModel& nominal,
                            const std::vector<Observation>& runs, const Thresholds& limits);

// Candidates of the search in which the residual counts as noise. Where angle and rate about one
// axis are both read, each shows errors of the other's instrument whatever the torque.
Among among_beside_the_rest(const NominalModel& nominal, const RecordedData& data);

// One search, and the decision about it, with the noise that `data` has; from `near`, a trial of no
// more candidates, where that is not null.
Answer searched(const NominalModel& nominal, const Fit& nominal_fit, const RecordedData& data,
                const DiagnoseOptions& options, Among among, const Trial* near);

// Searches for effects although an unexplained residual remains, which counts as noise: first the
// residual of the nominal model, then that of the best explanation, as long as effects are named.
// With the noise of the readings alone, every uncertain parameter would be moved by the unexplained
// part. Every name predicts segments of the recordings, each from fits to others, better than its
// absence, and differs from zero by its error with the residual's correlation. `data` keeps the
// noise of the last search. `laws`, where it is not null, is a fit of torques to the same runs: its
// residual is the first noise, and each search starts from it. Nothing where no effect is named.
std::optional<Answer> named_beside_the_rest(const NominalModel& nominal, RecordedData& data,
                                            const DiagnoseOptions& options, const Trial* laws);

// Whether a fit to recordings that have only the noise of the readings is near them.
bool leaves_only_noise(const Fit& fit, const RecordedData& data);

}  // namespace photorque
