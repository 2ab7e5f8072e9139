// Cross-validation of models of light: prediction of segments of recordings that a fit left out.
//
// The rows of a segment are spread over the whole recording. A cell or a shadow changes only a part
// of a curve or scan, and this change must be visible in every segment.
#pragma once

#include <optional>
#include <vector>

#include "diagnosis/light/trial.h"

namespace photorque {

// The gain of the candidate `which` of the trial in five-fold cross-validation, in standard errors:
// positive if the trial predicts left-out segments of the runs better with the candidate than
// without it. Each fit leaves out a fifth of the segments. nullopt if a run has too few rows.
std::optional<double> gain_over_segments(const LightTrial& trial, size_t which,
                                         const LightCandidates& all,
                                         const std::vector<FittedRun>& runs, int threads);

}  // namespace photorque
