#include "attitude/observation/discrepancy.h"

#include <algorithm>
#include <cmath>

namespace photorque {

namespace {

// What is left of one channel of one run, in order of time.
struct LeftSeries {
  std::vector<double> time_s, value;
};

std::vector<LeftSeries> left_of(const std::vector<Prediction>& residuals,
                                const std::vector<Observation>& runs, int channel) {
  std::vector<LeftSeries> all(runs.size());
  for (size_t run = 0; run < runs.size(); ++run) {
    for (size_t i = 0; i < residuals[run].off.size(); ++i) {
      const double x = residuals[run].off[i][channel];
      if (!std::isfinite(x)) continue;
      all[run].time_s.push_back(runs[run].time_s[i]);
      all[run].value.push_back(x);
    }
  }
  return all;
}

double mean_square(const std::vector<LeftSeries>& all) {
  double sum = 0.0, count = 0.0;
  for (const LeftSeries& s : all) {
    for (const double x : s.value) sum += x * x;
    count += static_cast<double>(s.value.size());
  }
  return count > 0.0 ? sum / count : 0.0;
}

// The part of the mean square that neighbours share, and the time over which they do.
struct Shared {
  double fraction = 0.0, time_s = 0.0;
};

// Mean product of values so many readings apart, over the mean square.
double autocorrelation(const std::vector<LeftSeries>& all, double square, size_t lag) {
  double sum = 0.0, count = 0.0;
  for (const LeftSeries& s : all) {
    for (size_t i = lag; i < s.value.size(); ++i) sum += s.value[i] * s.value[i - lag];
    count += s.value.size() > lag ? static_cast<double>(s.value.size() - lag) : 0.0;
  }
  return count > 0.0 ? sum / count / square : 0.0;
}

// What the next neighbours share; then where that has fallen to 1/e.
Shared shared_by_neighbours(const std::vector<LeftSeries>& all, double square) {
  size_t longest = 0;
  double read_s = 0.0, intervals = 0.0;
  for (const LeftSeries& s : all) {
    longest = std::max(longest, s.value.size());
    if (s.value.size() < 2) continue;
    read_s += s.time_s.back() - s.time_s.front();
    intervals += static_cast<double>(s.value.size() - 1);
  }
  if (!(intervals > 0.0)) return {};
  const double interval_s = read_s / intervals;
  const double neighbours = std::clamp(autocorrelation(all, square, 1), 0.0, 1.0);
  double before = neighbours;
  for (size_t lag = 2; lag < longest; ++lag) {
    const double now = autocorrelation(all, square, lag), wanted = std::exp(-1.0) * neighbours;
    if (now < wanted) {
      const double part = (before - wanted) / (before - now);
      return {neighbours, (static_cast<double>(lag) - 1.0 + part) * interval_s};
    }
    before = now;
  }
  return {neighbours, static_cast<double>(longest) * interval_s};
}

}  // namespace

NoiseLevels with_discrepancy(const std::vector<Prediction>& residuals,
                             const std::vector<Observation>& runs, const NoiseLevels& own,
                             Remainder remainder) {
  NoiseLevels noise = own;
  for (int channel = 0; channel < channel_count; ++channel) {
    const std::vector<LeftSeries> left = left_of(residuals, runs, channel);
    const double square = mean_square(left), level = own.of(channel).level;
    if (!(square > level * level)) continue;
    ChannelNoise found{std::sqrt(square)};
    if (remainder == Remainder::correlated) {
      const Shared shared = shared_by_neighbours(left, square);
      found.coloured = shared.fraction;
      found.time_s = shared.time_s;
    }
    noise.set(channel, found);
  }
  return noise;
}

NoiseLevels patient_noise(const std::vector<Observation>& runs, const NoiseLevels& own) {
  constexpr double part = 0.1;
  NoiseLevels noise = own;
  for (int channel = 3; channel < channel_count; ++channel) {
    if (channel_traits(channel).measures != Measures::rate) continue;
    double sum = 0.0, square = 0.0, count = 0.0;
    for (const Observation& seen : runs) {
      for (size_t i = 0; i < seen.blocks(); ++i) {
        if (!(seen.rows_of(i, channel) > 0.0)) continue;
        const double x = channel < vector_channels
                             ? seen.gyro_rad_s[i][channel - 3]
                             : seen.scalar[static_cast<size_t>(channel - vector_channels)].value[i];
        sum += x;
        square += x * x;
        count += 1.0;
      }
    }
    if (!(count > 0.0)) continue;
    const double mean = sum / count,
                 spread = std::sqrt(std::max(0.0, square / count - mean * mean));
    noise.set(channel, {std::max(own.of(channel).level, part * spread)});
  }
  return noise;
}

bool is_quieter(const NoiseLevels& now, const NoiseLevels& before) {
  constexpr double worth = 0.9;
  for (int channel = 0; channel < channel_count; ++channel) {
    if (now.of(channel).level < worth * before.of(channel).level) return true;
  }
  return false;
}

}  // namespace photorque
