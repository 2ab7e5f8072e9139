// The best of many trials, fitted with more patience than all of them could be.
#pragma once

#include "diagnosis/attitude/trial.h"

namespace photorque {

// Indices of trials on the same runs, the largest evidence first.
std::vector<size_t> by_evidence(const std::vector<Trial>& trials);

// Until a fit converges: one that is given up early makes whatever goes on from it seem to gain.
FitSettings patient_fit(const Thresholds& limits);

// Whether a trial explains nearly as much as the best on the same runs: where even the nominal
// model has diverged, most others are no leaders, however few they are.
bool is_near(const Trial& trial, const Trial& best, const Thresholds& limits);

// The leaders' fits are carried on until they converge: what only goes on where its parent's fit
// stopped would seem to gain by the effect that it adds. For the same reason they, and the parents,
// have a second chance from where the best of them ended; `trials` holds the parents, among others.
void settle_leaders(std::vector<Trial>& found, std::vector<Trial>& parents,
                    std::vector<Trial>& trials, const Candidates& all,
                    const std::vector<Observation>& runs, int threads);

// Second chances for trials fitted to the same runs, from where the best of them ended.
void learn_from_best(std::vector<Trial>& trials, const Candidates& all,
                     const std::vector<Observation>& runs, int threads);

}  // namespace photorque
