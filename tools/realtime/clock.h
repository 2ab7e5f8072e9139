// Clock of a run in real time: due times of ticks, and their lateness.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/product.h"

namespace photorque {

// Time of CLOCK_MONOTONIC, which never jumps.
int64_t monotonic_ns();

// Action after a tick that is later than its deadline.
enum class OnMiss {
  catch_up,  // the following ticks run without a pause until the clock is reached
  slip,      // the clock of the run stops for the delay: all later ticks are due later
  stop,      // the run ends with an error
};

// Ticks due at start + k · step.
class TickClock {
 public:
  TickClock(double step_s, double deadline_s, OnMiss on_miss);

  void start(int64_t now_ns) { start_ns_ = now_ns; }
  // Due time of a tick on CLOCK_MONOTONIC.
  int64_t due_ns(size_t tick) const;
  // Time of the run [s] at an instant of the clock.
  double run_s(int64_t at_ns) const;
  // Records that a tick was served at `now_ns` after `computing_ns` of work. Returns whether it
  // missed its deadline. Throws NumericalError if it did and the policy is OnMiss::stop.
  bool served(size_t tick, int64_t now_ns, int64_t computing_ns);

  // Quantities ticks, ticks_missed, slipped_s, lateness and computing time (p50, p99, p99.99,
  // largest); a table and a plot of the distribution of the lateness.
  Product product() const;

 private:
  double step_ns_;
  double deadline_s_;
  OnMiss on_miss_;
  int64_t start_ns_ = 0;
  int64_t slipped_ns_ = 0;
  size_t missed_ = 0;
  std::vector<float> late_s_, computing_s_;
};

}  // namespace photorque
