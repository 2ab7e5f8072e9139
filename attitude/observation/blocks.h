// Rows averaged into blocks, and the times at which a model is evaluated for their means.
#pragma once

#include <cstddef>
#include <vector>

#include "attitude/observation/observation.h"

namespace photorque {

// The largest observed rate of the platform, from the gyro or from consecutive attitudes; at least
// 0.1 rad/s.
double fastest_rad_s(const Observation& seen);

// The median rate of the rows that have all three axes of the gyro; 0 without any.
double median_gyro_rate_rad_s(const Observation& seen);

// The times at which a model is evaluated for the mean over a block, and their weights: Gauss's
// rules for the moments of the times of the rows. One time is enough for a single reading, and for
// a block whose curvature is far below the noise. Two match the second moment, three the fourth
// moment too.
class BlockInstants {
 public:
  // `fastest_rad_s`: the assumed largest angular frequency of the motion.
  BlockInstants(const Observation& seen, double fastest_rad_s);

  size_t per_block() const { return per_block_; }
  // The i-th of all times. The times do not decrease.
  double time_s(size_t i) const {
    const size_t block = i / per_block_;
    return seen_.time_s[block] + since_s(block, i % per_block_);
  }
  // Interval from the time of the block to one of its evaluation times.
  double since_s(size_t block, size_t which) const {
    if (per_block_ == 1 || (per_block_ == 3 && which == 1)) return 0.0;
    return which == 0 ? -rules_[block].reach_s : rules_[block].reach_s;
  }
  double weight(size_t block, size_t which) const {
    if (per_block_ == 1) return 1.0;
    const double outer = rules_[block].outer_weight;
    return per_block_ == 3 && which == 1 ? 1.0 - 2.0 * outer : outer;
  }
  // Weight of a time for the gyro, whose mean time may differ from that of the block.
  double gyro_weight(size_t block, size_t which) const;
  // Difference of the second moments of the times of attitudes and of other readings.
  double attitudes_excess_s2(size_t block) const;

 private:
  struct Rule {
    double reach_s = 0.0, outer_weight = 0.5;
  };

  double widest_reach_s(size_t block) const;
  Rule rule_of(size_t block) const;

  const Observation& seen_;
  size_t per_block_;
  std::vector<Rule> rules_;
};

// A copy of an observation without its blocks.
Observation without_blocks(const Observation& seen);
// Appends a block without readings to such a copy of `seen`. Returns its index.
size_t append_block(const Observation& seen, double time_s, Observation& to);

// Appends the mean of the rows [first, last) of `from` as a block.
void append_mean(const Observation& from, size_t first, size_t last, Observation& to);

// Converts the first block of `to`, which is the mean over block `block` of `all`, to a reading at
// its centre. The curvature of the motion follows from the neighbouring blocks of `all`.
void correct_first_block(const Observation& all, size_t block, Observation& to);

}  // namespace photorque
