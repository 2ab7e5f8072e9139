// Rows averaged into blocks, and the instants at which a model is evaluated for their means.
#pragma once

#include <cstddef>
#include <vector>

#include "attitude/observation/observation.h"

namespace photorque {

// The instants at which a model is evaluated for the mean over a block.

// The largest observed rate of the platform, from the gyro or from consecutive attitudes; at least
// 0.1 rad/s.
double fastest_rad_s(const Observation& seen);

// When a block is looked at, and with which weights: Gauss's rules for the moments of its rows'
// times. A single reading, and what is as good as one against the noise, is one instant; two have
// the second moment, three the fourth too.
class BlockInstants {
 public:
  // `fastest_rad_s`: as fast as that the motion may oscillate.
  BlockInstants(const Observation& seen, double fastest_rad_s);

  size_t per_block() const { return per_block_; }
  // Time of the i-th of all instants. The times do not decrease.
  double time_s(size_t i) const {
    const size_t block = i / per_block_;
    return seen_.time_s[block] + since_s(block, i % per_block_);
  }
  // Interval from the block's time to one of its instants.
  double since_s(size_t block, size_t which) const {
    if (per_block_ == 1 || (per_block_ == 3 && which == 1)) return 0.0;
    return which == 0 ? -rules_[block].reach_s : rules_[block].reach_s;
  }
  double weight(size_t block, size_t which) const {
    if (per_block_ == 1) return 1.0;
    const double outer = rules_[block].outer_weight;
    return per_block_ == 3 && which == 1 ? 1.0 - 2.0 * outer : outer;
  }
  // Weight of an instant for the gyro, whose mean time may differ from the block's time.
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

// Rows of an observation on their way to one, and what their mean holds of the motion.

// A copy of an observation without its blocks.
Observation without_blocks(const Observation& seen);

// Appends the mean of the rows [first, last) of `from` as a block.
void append_mean(const Observation& from, size_t first, size_t last, Observation& to);

// Makes the first block of `to`, a mean that is the given block of `all`, a reading at its middle,
// with the curvature of the motion from its neighbours there.
void correct_first_block(const Observation& all, size_t block, Observation& to);

}  // namespace photorque
