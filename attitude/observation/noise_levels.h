// Levels of noise: of single channels, and with the residual of a model counted as noise.
#pragma once

#include <optional>
#include <vector>

#include "attitude/observation/kinematics.h"
#include "attitude/observation/observation.h"
#include "attitude/observation/prediction.h"
#include "inference/estimator/thresholds.h"

namespace photorque {

// The noise of one channel from its own readings, where no other instrument checks it.

// Standard deviation of one reading of a channel (Observation::rows_of), from divided third
// differences of neighbouring readings, which smooth motion hardly affects, also with unequal
// steps. Orders up to six are used if their result is smaller by 0.7. The result is at least that
// of the digitisation steps. Rough motion counts as noise. Empty if there are fewer than ten
// differences.
std::optional<double> reading_level(const std::vector<Observation>& runs, int channel);

// The level of a gyro's white noise, from the fine end of its spectrum.

// The standard deviation of one reading, and the standard error of its logarithm.
struct NoiseLevel {
  double level = 0.0, log_sigma = 0.0;
};

// Noise level of gyro axis k (body axes) in all runs, from the upper half of the spectrum of
// differences at equal steps, without those across gaps and changes of commands. The strongest
// fifth of the frequencies is omitted, because vibrations are lines. Empty if too few data remain.
std::optional<NoiseLevel> gyro_level(const std::vector<Observation>& seen,
                                     const std::vector<KinematicRun>& runs, int k,
                                     const Thresholds::Noise& limits);

// Hardly any model of a real machine leaves only noise. The residual of a fit then counts as
// correlated noise, and an effect is certain only if it exceeds that.

// The noise of the runs including the residuals of a fit (`residuals`, NaN where nothing was read),
// at least `own`, the noise of the readings alone. Channel by channel. White: with the mean square
// of the residuals, independent from block to block; correlated: also with the time after which
// their autocorrelation falls below 1/e, so that a slow residual counts as few independent numbers.
enum class Remainder { white, correlated };
NoiseLevels with_discrepancy(const std::vector<Prediction>& residuals,
                             const std::vector<Observation>& runs, const NoiseLevels& own,
                             Remainder remainder);

// Sets the profiles of the runs, whose noise is that of with_discrepancy(): in each of about
// `parts` parts of them the mean square of the residuals, drawn towards that of all. A part in
// which something else acts then counts less, as with Student's t (K. L. Lange, R. J. A. Little and
// J. M. G. Taylor, J. Am. Stat. Assoc. 84 (1989) 881).
void set_profiles(const std::vector<Prediction>& residuals, size_t parts,
                  std::vector<Observation>& runs);

// Whether some channel of `now` is quieter than before by a tenth or more.
bool is_quieter(const NoiseLevels& now, const NoiseLevels& before);

// Noise under which what was stated holds, whatever the motion does: a tenth of the readings' own
// spread, or `own` where that is louder.
NoiseLevels noise_from_spread(const std::vector<Observation>& runs, const NoiseLevels& own);

}  // namespace photorque
