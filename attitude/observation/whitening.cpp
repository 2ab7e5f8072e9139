#include "attitude/observation/whitening.h"

#include <algorithm>
#include <cmath>

namespace photorque {

MeanOfCorrelated mean_of_correlated(double n, double steps) {
  if (n <= 1.0 || !(steps > 0.0)) return {};  // one reading, or all of them one
  const double rho = std::exp(-steps), left = -std::expm1(-steps);
  const double variance =
      ((1.0 + rho) / left + 2.0 * rho * std::expm1(-n * steps) / (n * left * left)) / n;
  return {variance, std::sinh(0.5 * n * steps) / (n * std::sinh(0.5 * steps))};
}

double reading_interval_s(const Observation& seen, int channel) {
  std::vector<double> intervals_s;
  double last_s = NAN, last_rows = 0.0;
  for (size_t i = 0; i < seen.blocks(); ++i) {
    const double rows = seen.rows_of(i, channel);
    if (!(rows > 0.0)) continue;
    if (std::isfinite(last_s)) {
      intervals_s.push_back(2.0 * (seen.time_s[i] - last_s) /
                            (std::max(1.0, rows) + std::max(1.0, last_rows)));
    }
    last_s = seen.time_s[i];
    last_rows = rows;
  }
  if (intervals_s.empty()) return 0.0;
  const auto middle = intervals_s.begin() + static_cast<std::ptrdiff_t>(intervals_s.size() / 2);
  std::nth_element(intervals_s.begin(), middle, intervals_s.end());
  return *middle;
}

Whitening::Whitening(const Observation& seen, int channel, Eigen::Index width) {
  const ChannelNoise noise = seen.noise.of(channel);
  level_ = noise.level;
  if (!(noise.coloured > 0.0) || !(noise.time_s > 0.0)) return;
  coloured_ = true;
  coloured_variance_ = noise.coloured * level_ * level_;
  white_variance_ = std::max(0.0, 1.0 - noise.coloured) * level_ * level_;
  time_s_ = noise.time_s;
  interval_s_ = reading_interval_s(seen, channel);
  variance_ = coloured_variance_;
  last_s_ = seen.time_s.front();
  expected_ = Eigen::RowVectorXd::Zero(width);
}

Whitening::Gain Whitening::gain(double time_s, double rows) {
  // Means over more than so many correlation times would lose all digits to the reach; the
  // correlation of neighbours is below a twentieth there.
  constexpr double longest_means = 20.0;
  const double steps = std::min(interval_s_ / time_s_, longest_means / std::max(1.0, rows));
  const MeanOfCorrelated mean = mean_of_correlated(rows, steps);
  // A reading that counts for less than one has so much more noise of its own.
  const double own = white_variance_ / rows +
                     (rows < 1.0 ? (1.0 / rows - 1.0) * coloured_variance_ : 0.0) +
                     coloured_variance_ * mean.variance;
  const double scale = 1.0 / mean.reach;
  // The part that only this block has; below zero for means, which are more alike than the process
  // at their middles is.
  const double alone = own * scale * scale - coloured_variance_;
  const double decay = std::exp(-(time_s - last_s_) / time_s_);
  variance_ = coloured_variance_ + decay * decay * (variance_ - coloured_variance_);
  last_s_ = time_s;
  // Blocks that lie closer than their readings say would have no variance left at all.
  constexpr double least = 1e-6;
  const double total = std::max(variance_ + alone, least * own * scale * scale);
  const double gain = variance_ / total;
  variance_ *= 1.0 - gain;
  return {decay, scale, gain, 1.0 / std::sqrt(total)};
}

}  // namespace photorque
