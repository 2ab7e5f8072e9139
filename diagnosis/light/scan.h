// Starts of nonlinear parameters, from the residuals of a trial.
#pragma once

#include "diagnosis/light/trial.h"

namespace photorque {

// Residuals of a recording under a trial, with the slopes that predict how a law on the light would
// lower them.
struct LeftOfRun {
  const LightRun* run;
  std::vector<double> signals;
  Eigen::VectorXd residuals;
  SignalSlopes slopes;
};

// Of each candidate, the few starts with the largest predicted gains; none without a gain.
std::vector<std::vector<LightStart>> scanned_starts(const LightTrial& parent,
                                                    const LightCandidates& all,
                                                    const std::vector<size_t>& candidates,
                                                    const std::vector<FittedRun>& runs,
                                                    int threads);

// Opaque boxes that could cause the missing light of the scans: numbers of the effect
// unmodelled_shadow, the best first. A plane above the receiver is carved: an element of it may be
// opaque only where every ray of light through it is missing at its end. The rectangle about the
// largest patch of such elements, at the height where it explains most.
std::vector<LightStart> shadow_starts(const LightTrial& parent, const LightCandidates& all,
                                      const std::vector<FittedRun>& runs, bool on_body);

// Waves over the receiver, of those whose cycles over half of its width and height lie on a grid up
// to 16 each way, that explain most of the residuals of the scans.
std::vector<LightStart> wave_starts(const LightCandidate& wave, const std::vector<LeftOfRun>& left,
                                    const Thresholds::Scoring& limits);

// The interval over which maxima other than the highest explain most, {from_s, to_s, recording}; of
// no length where it explains nothing.
std::vector<double> trapped_interval(const LightTrial& parent, const LightCandidates& all,
                                     const std::vector<FittedRun>& runs);

// The residuals of a recording's channels, neighbours in place or time side by side: scans in
// blocks of some four by five.
std::vector<std::vector<double>> in_order_of_place(const LightRun& run,
                                                   const Eigen::VectorXd& residuals);

}  // namespace photorque
