// Noise levels of single channels, and noise levels that include the residual of a model.
#pragma once

#include <optional>
#include <vector>

#include "attitude/observation/kinematics.h"
#include "attitude/observation/observation.h"
#include "attitude/observation/prediction.h"
#include "inference/estimator/thresholds.h"

namespace photorque {

// Standard deviation of one reading of a channel (Observation::rows_of), for channels that no other
// instrument checks. It follows from divided third differences of neighbouring readings, which
// smooth motion hardly affects, even for unequal steps. Higher orders, up to six, are used while
// each reduces the result to less than 0.7. The result is at least the noise of the digitisation,
// 1/√12 of a step. It equals this noise if the third differences are those of rounded values. Rough
// motion counts as noise. Empty if there are fewer than ten differences, or if the result is higher
// than the scatter of the readings, because of too few readings per period.
std::optional<double> reading_level(const std::vector<Observation>& runs, int channel);

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

// Models of real machines rarely leave only noise. The functions below count the residual of a fit
// as noise, and an effect is certain only if it is larger.

// The noise of the runs including the residuals of a fit (`residuals`, NaN for missing readings),
// channel by channel. It is at least `own`, the noise of the readings alone. `white`: the level is
// the root mean square of the residuals, which are independent from block to block. `correlated`:
// also with the time after which their autocorrelation falls below 1/e, so that a slow residual
// counts as few independent numbers.
enum class Remainder { white, correlated };
NoiseLevels with_discrepancy(const std::vector<Prediction>& residuals,
                             const std::vector<Observation>& runs, const NoiseLevels& own,
                             Remainder remainder);

// Sets the profiles of the runs, whose noise is that of with_discrepancy(). Each run is divided
// into parts, about `parts` in all. The factor of a part follows from the mean square of its
// residuals, shrunk towards that of all. A part with an unmodelled effect then has less weight, as
// with Student's t (K. L. Lange, R. J. A. Little and J. M. G. Taylor, J. Am. Stat. Assoc. 84 (1989)
// 881).
void set_profiles(const std::vector<Prediction>& residuals, size_t parts,
                  std::vector<Observation>& runs);

// Whether the level of some channel decreased by a tenth or more.
bool is_quieter(const NoiseLevels& now, const NoiseLevels& before);

// A large noise, under which the stated model holds for any motion: a tenth of the spread of the
// readings of each rate, or `own` if that is larger.
NoiseLevels noise_from_spread(const std::vector<Observation>& runs, const NoiseLevels& own);

}  // namespace photorque
