#include "attitude/estimation/noise.h"

#include <cmath>

#include "core/errors.h"

namespace photorque {

std::vector<inference::ChannelResiduals> channels_of(const std::vector<Prediction>& residuals) {
  std::vector<inference::ChannelResiduals> runs;
  for (const Prediction& p : residuals) {
    inference::ChannelResiduals channels(static_cast<size_t>(channel_count));
    for (const WhiteRow& row : p.residual) {
      for (size_t k = 0; k < channels.size(); ++k) {
        const double white = row[static_cast<Eigen::Index>(k)];
        if (std::isfinite(white)) channels[k].push_back(white);
      }
    }
    runs.push_back(std::move(channels));
  }
  return runs;
}

double excess_sigma(const Fit& fit, const std::vector<Observation>& runs,
                    const Thresholds::Noise& limits) {
  try {
    return inference::whiteness(channels_of(residuals_of(fit, runs)), limits).excess_sigma;
  } catch (const NumericalError&) {
    return limits.excess_unknown;
  }
}

int64_t drop_outliers(const std::vector<Prediction>& residuals, const Thresholds::Noise& limits,
                      std::vector<Observation>& runs) {
  int64_t dropped = 0;
  const std::vector<inference::ChannelResiduals> all = channels_of(residuals);
  for (size_t run = 0; run < runs.size(); ++run) {
    for (Eigen::Index k = 0; k < channel_count; ++k) {
      // Neighbours are the next that were read: gaps and empty cells lie in between.
      std::vector<size_t> rows;
      for (size_t i = 0; i < residuals[run].residual.size(); ++i) {
        if (std::isfinite(residuals[run].residual[i][k])) rows.push_back(i);
      }
      for (const size_t n : inference::outliers(all[run][static_cast<size_t>(k)], limits)) {
        // An attitude is right or wrong as a whole.
        if (k >= 3 || runs[run].attitude_rows[rows[n]] > 0.0) ++dropped;
        if (k < 3) runs[run].attitude_rows[rows[n]] = 0.0;
        if (k >= 3 && k < vector_channels) runs[run].gyro_rows[rows[n]][k - 3] = 0.0;
        if (k < vector_channels) continue;
        runs[run].scalar[static_cast<size_t>(k - vector_channels)].rows[rows[n]] = 0.0;
      }
    }
  }
  return dropped;
}

}  // namespace photorque
