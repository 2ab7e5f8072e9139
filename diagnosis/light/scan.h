// Starts of nonlinear parameters, from the residuals of a trial.
#pragma once

#include "diagnosis/light/trial.h"

namespace photorque {

// Residuals of a recording under a trial, with the slopes that predict how a law on the light
// lowers them.
struct LeftOfRun {
  const LightRun* run;
  std::vector<double> signals;
  Eigen::VectorXd residuals;
  SignalSlopes slopes;
};

// Opaque boxes that explain missing light of the scans, as numbers of the effect unmodelled_shadow,
// best first. A plane above the receiver is carved: an element may be opaque only if all light
// through it is missing at its destination. The result is the rectangle about the largest patch of
// such elements, at the height where it explains most.
std::vector<LightStart> shadow_starts(const LightTrial& parent, const LightCandidates& all,
                                      const std::vector<FittedRun>& runs, bool on_body);

// Waves over the receiver that explain most of the residuals of the scans. Their cycles over half
// of its width and height lie on a grid up to 16 in each direction.
std::vector<LightStart> wave_starts(const LightCandidate& wave, const std::vector<LeftOfRun>& left,
                                    const Thresholds::Scoring& limits);

// The interval in which maxima other than the highest explain most, as {from_s, to_s, recording};
// empty if it explains nothing.
std::vector<double> trapped_interval(const LightTrial& parent, const LightCandidates& all,
                                     const std::vector<FittedRun>& runs);

// The residuals of a recording's channels ordered so that neighbours in place or time are adjacent;
// scans in blocks of about four by five.
std::vector<std::vector<double>> in_order_of_place(const LightRun& run,
                                                   const Eigen::VectorXd& residuals);

}  // namespace photorque
