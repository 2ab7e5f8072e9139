// How well explanations of light predict segments of recordings that their fits left out.
//
// A segment holds rows from everywhere in a recording: a cell or a shadow changes a part of a curve
// or a scan, and every segment has to show it.
#pragma once

#include <optional>
#include <vector>

#include "diagnosis/light/trial.h"

namespace photorque {

// Standard errors by which segments of the runs are predicted better with the candidate at `which`
// of the trial than without it; a fifth of the segments is left out of the fits in turn. Nothing
// where the runs have too few rows.
std::optional<double> gain_over_segments(const LightTrial& trial, size_t which,
                                         const LightCandidates& all,
                                         const std::vector<FittedRun>& runs, int threads);

}  // namespace photorque
