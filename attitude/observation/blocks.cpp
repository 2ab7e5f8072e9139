#include "attitude/observation/blocks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/numerics/median.h"

namespace photorque {

namespace {

// The largest rate of rotation in a scalar channel: for an angle, its change between two readings
// per time; for a rate, its value.
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

// Number of instants at which the model is evaluated in each block (1 to 3). The error due to the
// curvature of the motion must be far below the noise of the block's mean. The motion is assumed to
// oscillate at the fastest observed rate.
size_t instants_needed(const Observation& seen, double fastest_rad_s) {
  constexpr double of_noise = 0.05;
  // Bounds of the error of a mean, for equally spaced readings: of second order with one time, of
  // fourth order with two.
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
        size = std::abs(seen.value_of(block, channel));
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
  // Differences of attitudes are used only if the gyro does not measure all three axes.
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
        fastest =
            std::max(fastest, turn_vector(turn).norm() / (seen.time_s[i] - seen.time_s[before]));
      }
      before = i;
    }
  }
  return fastest;
}

double median_gyro_rate_rad_s(const Observation& seen) {
  std::vector<double> rates;
  for (size_t i = 0; i < seen.blocks(); ++i) {
    if (seen.gyro_rows[i].minCoeff() > 0.0) rates.push_back(seen.gyro_rad_s[i].norm());
  }
  return rates.empty() ? 0.0 : upper_median(std::move(rates));
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
  // The mean time of the gyro readings differs from that of the block: the weights of the two sides
  // change by equal and opposite amounts.
  const double tilt = 0.5 * seen_.spread[block].gyro_offset_s / std::abs(since);
  return weight(block, which) + (since > 0.0 ? tilt : -tilt);
}

double BlockInstants::attitudes_excess_s2(size_t block) const {
  const Observation::Spread over = seen_.spread_of(block);
  return over.attitude_s * over.attitude_s - over.readings_s * over.readings_s;
}

// Largest distance of an instant from its block's time at which the instants of neighbouring blocks
// remain in order.
double BlockInstants::widest_reach_s(size_t block) const {
  const std::vector<double>& t = seen_.time_s;
  // The whole interval if the neighbour is a single reading, else half of it.
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

namespace {

// Rows [first, last) of an observation, which become one block.
struct BlockRows {
  const Observation& from;
  size_t first, last;

  // The mean time of the attitudes, which change with time; without attitudes that of all rows.
  double time_s() const {
    double rows = 0.0, sum_s = 0.0;
    for (size_t i = first; i < last; ++i) {
      rows += from.attitude_rows[i];
      sum_s += from.attitude_rows[i] * from.time_s[i];
    }
    if (rows > 0.0) return sum_s / rows;
    for (size_t i = first; i < last; ++i) sum_s += from.time_s[i];
    return sum_s / static_cast<double>(last - first);
  }

  // A mean that was extrapolated to another time, and the extrapolated amount.
  struct Moved {
    double value = NAN, by = 0.0;
  };

  // Second and fourth moments of the times of the readings. Rows that are means contribute the
  // spread of their readings.
  struct Moments {
    double rows = 0.0, sum_s2 = 0.0, sum_s4 = 0.0;

    void add(double weight, double since_s2, double own_s, double own_fourth_s) {
      const double own_s2 = own_s * own_s;
      rows += weight;
      sum_s2 += weight * (since_s2 + own_s2);
      sum_s4 +=
          weight * (since_s2 * since_s2 + 6.0 * since_s2 * own_s2 + std::pow(own_fourth_s, 4));
    }
    double second_s() const { return rows > 0.0 ? std::sqrt(sum_s2 / rows) : 0.0; }
    double fourth_s() const { return rows > 0.0 ? std::pow(sum_s4 / rows, 0.25) : 0.0; }
  };

  Observation::Spread spread(double at_s) const {
    Moments readings, attitudes;
    double gyro_rows = 0.0, gyro_sum_s = 0.0;
    for (size_t i = first; i < last; ++i) {
      const double since_s2 = std::pow(from.time_s[i] - at_s, 2);
      const Observation::Spread own = from.spread_of(i);
      double weight = from.gyro_rows[i].maxCoeff();
      gyro_rows += weight;
      gyro_sum_s += weight * (from.time_s[i] - at_s);
      for (const ScalarReadings& read : from.scalar) {
        if (!read.rows.empty()) weight = std::max(weight, read.rows[i]);
      }
      readings.add(weight, since_s2, own.readings_s, own.readings_fourth_s);
      attitudes.add(from.attitude_rows[i], since_s2, own.attitude_s, own.readings_fourth_s);
    }
    const Moments& most = readings.rows > 0.0 ? readings : attitudes;
    Observation::Spread result{most.second_s(), attitudes.second_s(), most.fourth_s()};
    if (gyro_rows > 0.0) result.gyro_offset_s = gyro_sum_s / gyro_rows;
    return result;
  }

  // The mean of the readings of a rate or scalar, extrapolated to `at_s` with the slope over three
  // blocks, because channels with different rates have different mean times.
  Moved mean_of(double at_s, int channel) const {
    const size_t length = last - first;
    const double reach_s = 1.5 * (from.time_s[last - 1] - from.time_s[first]) + 1e-9;
    double rows = 0.0, rate_sum = 0.0, time_sum_s = 0.0;
    double all = 0.0, all_rate = 0.0, all_s = 0.0, all_s2 = 0.0, all_product = 0.0;
    const size_t end = std::min(from.blocks(), last + length);
    for (size_t i = first - std::min(first, length); i < end; ++i) {
      const double weight = from.rows_of(i, channel), since_s = from.time_s[i] - at_s;
      if (!(weight > 0.0) || std::abs(since_s) > reach_s) continue;
      const double rate_rad_s = from.value_of(i, channel);
      all += weight;
      all_rate += weight * rate_rad_s;
      all_s += weight * since_s;
      all_s2 += weight * since_s * since_s;
      all_product += weight * since_s * rate_rad_s;
      if (i < first || i >= last) continue;
      rows += weight;
      rate_sum += weight * rate_rad_s;
      time_sum_s += weight * since_s;
    }
    if (rows == 0.0) return {};
    const double spread_s2 = all * all_s2 - all_s * all_s;
    if (!(spread_s2 > 0.0)) return {rate_sum / rows, 0.0};
    const double slope_rad_s2 = (all * all_product - all_s * all_rate) / spread_s2;
    const double by_rad_s = -slope_rad_s2 * time_sum_s / rows;
    return {rate_sum / rows + by_rad_s, by_rad_s};
  }

  // An attitude that was read.
  struct Turned {
    Quat attitude;
    double since_s, rows;
  };

  // Mean attitude. Each attitude is moved to the time of the block with the constant rate that
  // leaves no trend, then the rotation vectors relative to the first are averaged. The effect of a
  // changing rate remains, as in the mean of the gyro, so that the mean attitude is the integral of
  // the mean rate.
  Quat mean_attitude(double at_s) const {
    std::vector<Turned> all;
    double sum_s2 = 0.0, rows = 0.0;
    for (size_t i = first; i < last; ++i) {
      if (!(from.attitude_rows[i] > 0.0)) continue;
      all.push_back({from.attitude[i], from.time_s[i] - at_s, from.attitude_rows[i]});
      sum_s2 += all.back().rows * all.back().since_s * all.back().since_s;
      rows += all.back().rows;
    }
    if (all.empty()) return {NAN, NAN, NAN, NAN};
    Vec3 rate_rad_s = Vec3::Zero();
    if (all.size() > 1) {
      rate_rad_s = turn_vector(all.front().attitude.conjugate() * all.back().attitude) /
                   (all.back().since_s - all.front().since_s);
    }
    const auto moved = [&](const Turned& one) {
      return one.attitude * turn_by(-one.since_s * rate_rad_s);
    };
    Quat reference = moved(all.front());
    // Each iteration decreases the remaining trend by the square of the rotation angle.
    constexpr int times = 3;
    for (int again = 0; again < times && all.size() > 2; ++again) {
      Vec3 trend = Vec3::Zero();
      for (const Turned& one : all) {
        trend += one.rows * one.since_s * turn_vector(reference.conjugate() * moved(one));
      }
      rate_rad_s += trend / sum_s2;
      reference = moved(all.front());
    }
    Vec3 sum = Vec3::Zero();
    for (const Turned& one : all) {
      sum += one.rows * turn_vector(reference.conjugate() * moved(one));
    }
    return (reference * turn_by(sum / rows)).normalized();
  }

  void append_to(Observation& to) const {
    const double at_s = time_s();
    const size_t block = append_block(from, at_s, to);
    to.attitude[block] = mean_attitude(at_s);
    for (size_t i = first; i < last; ++i) to.attitude_rows[block] += from.attitude_rows[i];
    Observation::Spread over = spread(at_s);
    for (int channel = 3; channel < channel_count; ++channel) {
      if (!from.has_channel(channel)) continue;
      const Moved mean = mean_of(at_s, channel);
      to.value_of(block, channel) = mean.value;
      if (channel < vector_channels) over.gyro_moved_rad_s[channel - 3] = mean.by;
      for (size_t i = first; i < last; ++i) {
        to.rows_in(block, channel) += from.rows_of(i, channel);
      }
    }
    to.spread.push_back(over);
  }
};

// A change between two times, divided by the interval.
template <typename Value>
struct Slope {
  Value per_s;
  double between_s;
};

// The second derivative from two consecutive slopes.
template <typename Value>
Value curvature_of(const Slope<Value>& before, const Slope<Value>& after) {
  return 2.0 / (before.between_s + after.between_s) * (after.per_s - before.per_s);
}

// Converts the mean over a block of `all` to a reading at its centre. The curvature of the motion
// follows from the neighbouring blocks.
class CentredReading {
 public:
  CentredReading(const Observation& all, size_t block) : all_(all), block_(block) {}

  // Writes the reading to the first block of `to`.
  void put_into(Observation& to) const {
    const Observation::Spread over = all_.spread_of(block_);
    to.spread.front() = {};
    if (block_ == 0 || block_ + 1 >= all_.blocks() || is_far()) return;
    if (is_read([&](size_t i) { return all_.attitude_rows[i]; })) {
      const Vec3 bent = curvature_of<Vec3>({turn_rad(block_ - 1) / before_s(), before_s()},
                                           {turn_rad(block_) / after_s(), after_s()});
      to.attitude.front() =
          (all_.attitude[block_] * turn_by(-0.5 * over.attitude_s * over.attitude_s * bent))
              .normalized();
    }
    const double half_s2 = 0.5 * over.readings_s * over.readings_s;
    for (int channel = 3; channel < channel_count; ++channel) {
      if (!is_read([&](size_t i) { return all_.rows_of(i, channel); })) continue;
      to.value_of(0, channel) -= half_s2 * bent(channel);
    }
  }

 private:
  double before_s() const { return all_.time_s[block_] - all_.time_s[block_ - 1]; }
  double after_s() const { return all_.time_s[block_ + 1] - all_.time_s[block_]; }
  // For rows spread evenly over a block, the root mean square of the times is the length over √12.
  bool is_far() const {
    const double length_s = std::sqrt(12.0) * all_.spread_of(block_).readings_s;
    return std::max(before_s(), after_s()) > 2.0 * length_s;
  }
  template <typename Rows>
  bool is_read(const Rows& rows) const {
    return rows(block_ - 1) > 0.0 && rows(block_) > 0.0 && rows(block_ + 1) > 0.0;
  }
  double bent(int channel) const {
    const auto value = [&](size_t i) { return all_.value_of(i, channel); };
    return curvature_of<double>({(value(block_) - value(block_ - 1)) / before_s(), before_s()},
                                {(value(block_ + 1) - value(block_)) / after_s(), after_s()});
  }
  Vec3 turn_rad(size_t from) const {
    return turn_vector(all_.attitude[from].conjugate() * all_.attitude[from + 1]);
  }

  const Observation& all_;
  size_t block_;
};

}  // namespace

Observation without_blocks(const Observation& seen) {
  Observation result = seen;
  result.time_s.clear();
  result.spread.clear();
  result.attitude.clear();
  result.attitude_rows.clear();
  result.gyro_rad_s.clear();
  result.gyro_rows.clear();
  result.scalar = {};
  return result;
}

size_t append_block(const Observation& seen, double time_s, Observation& to) {
  to.time_s.push_back(time_s);
  to.attitude.emplace_back(NAN, NAN, NAN, NAN);
  to.attitude_rows.push_back(0.0);
  to.gyro_rad_s.emplace_back(Vec3::Constant(NAN));
  to.gyro_rows.emplace_back(Vec3::Zero());
  for (size_t s = 0; s < seen.scalar.size(); ++s) {
    if (seen.scalar[s].rows.empty()) continue;
    to.scalar[s].value.push_back(NAN);
    to.scalar[s].rows.push_back(0.0);
  }
  return to.blocks() - 1;
}

void append_mean(const Observation& from, size_t first, size_t last, Observation& to) {
  BlockRows{from, first, last}.append_to(to);
}

void correct_first_block(const Observation& all, size_t block, Observation& to) {
  CentredReading(all, block).put_into(to);
}

}  // namespace photorque
