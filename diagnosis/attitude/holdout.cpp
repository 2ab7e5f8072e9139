#include "diagnosis/attitude/findings.h"

#include <algorithm>
#include <cmath>

#include "attitude/estimation/fit.h"
#include "core/errors.h"

namespace photorque {
namespace {

// Noise of channel k at one reading, in the channel's unit.
double noise_of(const Observation& seen, Eigen::Index k) {
  const auto channel = static_cast<int>(k);
  return seen.noise.of(channel).level * channel_traits(channel).per_SI;
}

double in_unit(const WhiteRow& off, Eigen::Index k) {
  return off[k] * channel_traits(static_cast<int>(k)).per_SI;
}

std::map<std::string, double> rms(const std::vector<Prediction>& residuals,
                                  const std::vector<Observation>& runs) {
  std::map<std::string, double> result;
  for (Eigen::Index k = 0; k < channel_count; ++k) {
    double sum = 0.0;
    int64_t count = 0;
    for (size_t run = 0; run < runs.size(); ++run) {
      for (const auto& off : residuals[run].off) {
        const double x = in_unit(off, k);
        if (!std::isfinite(x)) continue;
        sum += x * x;
        ++count;
      }
    }
    if (count > 0)
      result[channel_traits(static_cast<int>(k)).name] =
          std::sqrt(sum / static_cast<double>(count));
  }
  return result;
}

// Error of the mean of a block's readings. Averaging does not reduce the time-correlated part.
Vec3 attitude_error_rad(const Observation& seen, size_t block) {
  Vec3 error;
  for (int k = 0; k < 3; ++k) {
    const ChannelNoise noise = seen.noise.of(k);
    const double rows = std::max(1.0, seen.rows_of(block, k));
    error[k] = noise.level * std::sqrt(noise.coloured + (1.0 - noise.coloured) / rows);
  }
  return error;
}

AttitudeSeries attitude_of(const Prediction& before, const Prediction& after,
                           const Observation& seen) {
  AttitudeSeries series;
  if (!seen.has_some_attitude()) return series;
  for (size_t i = 0; i < seen.blocks(); ++i) {
    if (!(seen.attitude_rows[i] > 0.0)) continue;
    series.time_s.push_back(seen.time_s[i]);
    series.measured.push_back(seen.attitude[i]);
    series.off_before_rad.emplace_back(before.off[i].head<3>());
    series.off_after_rad.emplace_back(after.off[i].head<3>());
    series.error_rad.push_back(attitude_error_rad(seen, i));
  }
  return series;
}

}  // namespace

Fit propagate_model(const Fit& fitted, const std::vector<Observation>& runs,
                    const Thresholds& limits) {
  Hypothesis h = fitted.best;
  std::erase_if(h.free, [](const Free& f) { return !f.per_run; });
  h.runs = starts_from_data(h, runs);
  choose_starts(h, runs);
  FitSettings settings;
  settings.windows = limits.fitting.first_windows;
  return fit(h, runs, settings);
}

Holdout compare_holdout(const Fit& before, const Fit& after, const std::vector<Observation>& runs) {
  Holdout result;
  result.samples = after.samples;
  result.chi2_per_sample_before = before.chi2_per_sample();
  result.chi2_per_sample_after = after.chi2_per_sample();
  try {
    result.rms_before = rms(residuals_of(before, runs), runs);
    result.rms_after = rms(residuals_of(after, runs), runs);
  } catch (const NumericalError&) {
    // A model that cannot be propagated along these runs has no residuals.
  }
  return result;
}

RecordingSeries series_of(const Fit& before, const Fit& after, const Observation& seen,
                          size_t run) {
  RecordingSeries result;
  result.recording = seen.name;
  const double max_gap_s = 5.0 * seen.duration_s() / static_cast<double>(seen.blocks());
  try {
    const Prediction a = residuals_of(before, run, seen), b = residuals_of(after, run, seen);
    for (Eigen::Index k = 0; k < channel_count; ++k) {
      const ChannelTraits& traits = channel_traits(static_cast<int>(k));
      const bool is_scalar = k >= vector_channels;
      const auto scalar = static_cast<size_t>(is_scalar ? k - vector_channels : 0);
      if (is_scalar && !seen.has(static_cast<Scalar>(scalar))) continue;
      ChannelSeries c;
      c.name = traits.name;
      c.label = traits.label;
      c.unit = traits.unit;
      c.residual_unit = c.unit;
      c.noise = noise_of(seen, k);
      for (size_t i = 0; i < seen.blocks(); ++i) {
        const bool read = seen.rows_of(i, static_cast<int>(k)) > 0.0;
        // A camera may read only every second row: unread blocks are omitted, but longer gaps
        // remain visible as one.
        const bool in_gap = !c.time_s.empty() && seen.time_s[i] - c.time_s.back() > max_gap_s;
        if (!read && !in_gap) continue;
        c.time_s.push_back(seen.time_s[i]);
        c.residual_before.push_back(in_unit(a.off[i], k));
        c.residual_after.push_back(in_unit(b.off[i], k));
        if (k < 3) continue;
        const double value =
            is_scalar ? traits.per_SI * seen.scalar[scalar].value[i] : seen.gyro_rad_s[i][k - 3];
        c.measured.push_back(value);
        c.before.push_back(value - c.residual_before.back());
        c.after.push_back(value - c.residual_after.back());
      }
      if (!c.time_s.empty()) result.channels.push_back(std::move(c));
    }
    result.attitude = attitude_of(a, b, seen);
  } catch (const NumericalError&) {
    result.channels.clear();
  }
  return result;
}

}  // namespace photorque
