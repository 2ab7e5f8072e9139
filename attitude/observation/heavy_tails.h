// Noise whose large errors are more frequent than those of a normal distribution.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "attitude/observation/prediction.h"
#include "inference/estimator/thresholds.h"

namespace photorque {

// Heavy-tailed noise, found from the distance of each reading from a smooth curve.

// The deviations of one channel in one run, in order of time.
struct Deviations {
  std::vector<size_t> block;  // of the observation
  std::vector<double> time_s;
  std::vector<double> left;       // measured − predicted [rad or rad/s]
  std::vector<double> root_rows;  // √ of the rows that were averaged into the block
  std::vector<double> curve;      // through the neighbours
  // left − curve as of one row, over the square root of the fraction of a reading's own variance
  // that the curve leaves: of white noise it has the noise's own standard deviation.
  std::vector<double> size;

  size_t count() const { return block.size(); }
};

// Readings through which a parabola is laid about each of them, itself among them.
constexpr size_t deviation_window = 15;

// The deviations with equal weights; empty if there are fewer readings than a window.
Deviations deviations(const Prediction& residuals, const Observation& seen, int channel);

// Again, with weights of the readings (> 0), as many as there are.
void fit_smooth_curves(Deviations& channel, const std::vector<double>& weight);

// Standard deviation by the median of all sizes: a few large ones do not count. 0: no reading.
double robust_level(const std::vector<Deviations>& runs);

// Whether neighbouring deviations are correlated no more than those of white noise about their own
// curve: the residual is noise, not motion. Sizes are cut at a few `level`.
bool are_independent(const std::vector<Deviations>& runs, double level);

// Student's t distribution of a channel's errors.
struct HeavyTail {
  double degrees = 0.0;        // of freedom
  double degrees_sigma = 0.0;  // standard error
  double scale = 0.0;          // rad or rad/s, of one reading
};

// Tails of channels 0 to 5 (camera about lab x, y, z, gyro about body x, y, z).
using HeavyTails = std::array<std::optional<HeavyTail>, 6>;

// Finds the channels with heavy tails. The error of a reading is its distance from a smooth curve
// through the residuals of its neighbours, independent of slow torques. `residuals`: of predictions
// near the runs, with `off`. Channels with correlated deviations are omitted, because these are due
// to motion or to another kind of noise. Deterministic.
HeavyTails heavy_tails(const std::vector<Prediction>& residuals,
                       const std::vector<Observation>& runs, const Thresholds::Noise& limits);

// Replaces the readings of those channels by pseudo-values, whose mean under least squares has the
// error of the maximum-likelihood location under Student's t (Huber 1981, section 7.8): what is far
// from the neighbours is drawn towards them. The noise that is left is near to normal; its standard
// deviation is √((ν + 3)/(ν + 1)) of the scale, the Cramér-Rao bound of a location under Student's
// t (Lange, Little, Taylor 1989, J. Am. Stat. Assoc. 84, 881).
void robustify(const HeavyTails& tails, const std::vector<Prediction>& residuals,
               std::vector<Observation>& runs);

// Standard deviation of the readings of a channel about a smooth curve through their neighbours, as
// of one row [rad or rad/s]. 0: too few.
double deviation_level(const std::vector<Prediction>& residuals,
                       const std::vector<Observation>& runs, int channel);

// Drops readings of bursts: some neighbours in a row that are far from a smooth curve, with quiet
// ones around. Returns their number.
int64_t drop_bursts(const std::vector<Prediction>& residuals, const Thresholds::Noise& limits,
                    std::vector<Observation>& runs);

}  // namespace photorque
