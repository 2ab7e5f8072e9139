// Names in the presence of an unexplained residual, which counts as noise (model discrepancy).
#pragma once

#include <optional>

#include "diagnosis/attitude/answer.h"

namespace photorque {

// Candidates to search, each a subset of the previous: all; those whose start requires no scan;
// those of the catalogue; torques and the bias of a gyro; torques only, because large instrument
// errors can mimic any effect.
enum class Among { all, unscanned, catalogue, torques_and_bias, torques };

// The chosen candidates, those of narrower choices first, so that indices of a trial remain valid
// among more candidates.
Candidates candidates_among(Among among, const NominalModel& nominal,
                            const std::vector<Observation>& runs, const Thresholds& limits);

// Candidates of the search in which the residual counts as noise. If angle and rate about one axis
// are both measured, each reveals errors of the other instrument independently of the torque. Of
// rates alone, the bias is revealed by a swing, whose mean rate is zero.
Among among_with_discrepancy(const NominalModel& nominal, const RecordedData& data);

// Whether the machine has textbook torques only: no commands, fields, wheels or light.
bool is_of_textbook(const Candidates& all);

// One search and its decision with the noise of `data`. It starts from the trial `near`, unless
// that is null. The candidates of `near` must be among those searched.
Answer searched(const NominalModel& nominal, const Fit& nominal_fit, const RecordedData& data,
                const DiagnoseOptions& options, Among among, const Trial* near);

// Searches for effects in the presence of an unexplained residual, which counts as noise. With the
// noise of the readings alone, the residual would bias every uncertain parameter. The noise is
// first the residual of the nominal model. As long as effects are named, it is then the residual of
// the best explanation. Every name must improve the prediction of segments from fits to other
// segments, and must differ significantly from zero under correlated noise. `data` keeps the noise
// of the last search. `laws`, if not null, is a fit of torques to the same runs: its residual is
// the first noise, and each search starts from it. Returns nothing if no effect is named.
std::optional<Answer> identify_with_discrepancy(const NominalModel& nominal, RecordedData& data,
                                                const DiagnoseOptions& options, const Trial* laws);

// Whether a fit agrees with recordings whose noise is that of the readings alone.
bool is_consistent_with_noise(const Fit& fit, const RecordedData& data);

}  // namespace photorque
