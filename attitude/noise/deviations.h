// How far each reading is from a smooth curve through its neighbours.
#pragma once

#include <vector>

#include "attitude/observation/prediction.h"

namespace photorque {

// One channel of one run, the readings alone, in order of time.
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

// All readings weigh alike; none where there are fewer than a window.
Deviations deviations(const Prediction& residuals, const Observation& seen, int channel);

// Anew, with weights of the readings (> 0), as many as there are.
void lay_curves(Deviations& channel, const std::vector<double>& weight);

// Standard deviation by the median of all sizes: a few large ones do not count. 0: no reading.
double robust_level(const std::vector<Deviations>& runs);

// Whether neighbouring deviations hang together no more than those of white noise do through a
// curve of their own: what is left is noise, not motion. Sizes are cut at a few `level`.
bool are_independent(const std::vector<Deviations>& runs, double level);

}  // namespace photorque
