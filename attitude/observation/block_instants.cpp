#include "attitude/observation/block_instants.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace photorque {
namespace {

// How fast a scalar says that it turns: an angle from one reading to the next, a rate as it is.
double fastest_of_scalar(const ScalarReadings& read, Measures measures,
                         const std::vector<double>& time_s) {
  if (measures != Measures::angle && measures != Measures::rate) return 0.0;
  const bool is_angle = measures == Measures::angle;
  double fastest = 0.0;
  size_t before = time_s.size();
  for (size_t i = 0; i < read.rows.size(); ++i) {
    if (!(read.rows[i] > 0.0)) continue;
    if (!is_angle) fastest = std::max(fastest, read.value[i]);
    if (is_angle && before < i) {
      fastest = std::max(
          fastest, std::abs(read.value[i] - read.value[before]) / (time_s[i] - time_s[before]));
    }
    before = i;
  }
  return fastest;
}

// At how many instants each block is looked at, by what would be left of the motion's curvature
// against the noise of its means: of a motion that oscillates as fast as any is seen to turn.
size_t instants_needed(const Observation& seen, double fastest_rad_s) {
  constexpr double of_noise = 0.05;
  // Of means, what one instant leaves of second order, two of fourth: that of even times, for rates
  // and for attitudes, is within this.
  constexpr double second = 0.5, fourth = 0.1;
  size_t needed = 1;
  for (size_t block = 0; block < seen.spread.size(); ++block) {
    const double turn_rad2 = std::pow(fastest_rad_s * seen.spread[block].readings_s, 2);
    for (int channel = 0; channel < channel_count; ++channel) {
      const double rows = seen.rows_of(block, channel);
      if (!(rows > 0.0)) continue;
      double size = 1.0;
      const Measures measures = channel_traits(channel).measures;
      if (measures == Measures::rate) size = fastest_rad_s;
      if (measures != Measures::rate && measures != Measures::angle) {
        size = std::abs(seen.scalar[static_cast<size_t>(channel - vector_channels)].value[block]);
      }
      const double allowed = of_noise * seen.noise.of(channel).level / std::sqrt(rows);
      if (fourth * turn_rad2 * turn_rad2 * size > allowed) return 3;
      if (second * turn_rad2 * size > allowed) needed = 2;
    }
  }
  return needed;
}

}  // namespace

double fastest_rad_s(const Observation& seen) {
  double fastest = 0.1;
  for (int s = 0; s < scalar_count; ++s) {
    fastest = std::max(
        fastest, fastest_of_scalar(seen.scalar[static_cast<size_t>(s)],
                                   channel_traits(vector_channels + s).measures, seen.time_s));
  }
  // A gyro that reads all three axes tells better than differences of attitudes do.
  Vec3 read = Vec3::Zero();
  if (seen.has_gyro) {
    for (const Vec3& rows : seen.gyro_rows) read = read.cwiseMax(rows);
  }
  const bool whole_gyro = read.minCoeff() > 0.0;
  size_t before = seen.blocks();
  for (size_t i = 0; i < seen.blocks(); ++i) {
    if (seen.has_gyro) {
      double square = 0.0;
      for (int k = 0; k < 3; ++k) {
        if (seen.gyro_rows[i][k] > 0.0) square += seen.gyro_rad_s[i][k] * seen.gyro_rad_s[i][k];
      }
      fastest = std::max(fastest, std::sqrt(square));
    }
    if (!whole_gyro && seen.attitude_rows[i] > 0.0) {
      if (before < i) {
        const Quat turn = seen.attitude[before].conjugate() * seen.attitude[i];
        fastest = std::max(fastest,
                           rotation_vector(turn).norm() / (seen.time_s[i] - seen.time_s[before]));
      }
      before = i;
    }
  }
  return fastest;
}

BlockInstants::BlockInstants(const Observation& seen, double fastest_rad_s)
    : seen_(seen), per_block_(instants_needed(seen, fastest_rad_s)) {
  for (size_t block = 0; per_block_ > 1 && block < seen.blocks(); ++block) {
    if (rule_of(block).reach_s > widest_reach_s(block)) per_block_ = 3;
  }
  for (size_t block = 0; per_block_ > 1 && block < seen.blocks(); ++block) {
    rules_.push_back(rule_of(block));
  }
}

double BlockInstants::gyro_weight(size_t block, size_t which) const {
  const double since = since_s(block, which);
  if (since == 0.0) return weight(block, which);
  // As much more on one side as less on the other.
  const double tilt = 0.5 * seen_.spread[block].gyro_offset_s / std::abs(since);
  return weight(block, which) + (since > 0.0 ? tilt : -tilt);
}

double BlockInstants::attitudes_excess_s2(size_t block) const {
  const Observation::Spread over = seen_.spread_of(block);
  return over.attitude_s * over.attitude_s - over.readings_s * over.readings_s;
}

// Instants of neighbours must not pass each other.
double BlockInstants::widest_reach_s(size_t block) const {
  const std::vector<double>& t = seen_.time_s;
  // All of the time between where the other is a reading, else half of it.
  const auto up_to = [&](size_t other) {
    const double between_s = std::abs(t[other] - t[block]);
    return seen_.spread_of(other).readings_s > 0.0 ? 0.5 * between_s : between_s;
  };
  double widest_s = std::numeric_limits<double>::infinity();
  if (block > 0) widest_s = up_to(block - 1);
  if (block + 1 < t.size()) widest_s = std::min(widest_s, up_to(block + 1));
  return widest_s;
}

BlockInstants::Rule BlockInstants::rule_of(size_t block) const {
  const Observation::Spread over = seen_.spread_of(block);
  if (per_block_ == 2 || !(over.readings_s > 0.0)) return {over.readings_s, 0.5};
  const double reach_s = std::min(over.readings_fourth_s * over.readings_fourth_s / over.readings_s,
                                  widest_reach_s(block));
  return {reach_s, 0.5 * std::pow(over.readings_s / reach_s, 2)};
}

}  // namespace photorque
