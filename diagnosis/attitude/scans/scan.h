// Starts for effects whose parameters enter nonlinearly (a frequency, an instant, an axis): the fit
// would not find them from anywhere.
#pragma once

#include <vector>

#include "diagnosis/attitude/effects/trial.h"

namespace photorque {

// Frequencies at which what is left of a fit has power, strongest first [Hz], at most `most`, above
// those of the platform's own motion.
std::vector<double> line_frequencies_Hz(const Fit& at, const std::vector<Observation>& runs,
                                        const Thresholds::Scoring& limits, size_t most = 4);

// Where to start the fit of a candidate added to `parent`: one start, or the most promising ones of
// a scan. `slow_runs` are averages of the runs, as good for what is slow; `lines_Hz` are the
// parent's line_frequencies_Hz().
std::vector<Start> starts_of(const Candidate& candidate, const Trial& parent,
                             const std::vector<Observation>& runs,
                             const std::vector<Observation>& slow_runs,
                             const std::vector<double>& lines_Hz,
                             const Thresholds::Scoring& limits);

}  // namespace photorque
