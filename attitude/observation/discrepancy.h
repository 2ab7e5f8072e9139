// Names beside what stays unexplained. Of a real machine hardly any model leaves only noise; then
// what a fit leaves counts as noise too, correlated in time, and an effect is found with certainty
// where it stands out of that.
#pragma once

#include "attitude/observation/prediction.h"

namespace photorque {

// The noise of the runs with what a fit leaves of them (`residuals`, NaN where nothing was read) in
// it, at least `own`, the noise of the readings alone. Channel by channel, white: as loud as the
// mean square of what is left; correlated: besides over the time after which its autocorrelation
// falls below 1/e, so that a slow remainder counts for the few independent numbers that it is.
enum class Remainder { white, correlated };
NoiseLevels with_discrepancy(const std::vector<Prediction>& residuals,
                             const std::vector<Observation>& runs, const NoiseLevels& own,
                             Remainder remainder);

// Whether some channel of `now` is quieter than before by a tenth or more.
bool is_quieter(const NoiseLevels& now, const NoiseLevels& before);

// Noise under which what was stated holds, whatever the motion does: a tenth of the readings' own
// spread, or `own` where that is louder.
NoiseLevels patient_noise(const std::vector<Observation>& runs, const NoiseLevels& own);

}  // namespace photorque
