// The clock of a run in real time: when ticks are due, and how late they were.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/product.h"

namespace photorque {

// CLOCK_MONOTONIC: it neither jumps nor is it set.
int64_t monotonic_ns();

// Action after a tick that is later than its deadline.
enum class OnMiss {
  catch_up,  // the following ticks come without a pause until the clock is met again
  slip,      // the clock of the run stands still for as long: all later ticks are due later
  stop,      // the run ends with an error
};

// Ticks that are due at start + k · step.
class TickClock {
 public:
  TickClock(double step_s, double deadline_s, OnMiss on_miss);

  void start(int64_t now_ns) { start_ns_ = now_ns; }
  int64_t due_ns(size_t tick) const;
  // Seconds of the run at an instant of the clock.
  double run_s(int64_t at_ns) const;
  // A tick was served at `now_ns` after `computing_ns` of work; whether it missed its deadline.
  // NumericalError when it did and OnMiss::stop requires it.
  bool served(size_t tick, int64_t now_ns, int64_t computing_ns);

  // Quantities ticks, ticks_missed, slipped_s, lateness and computing time (p50, p99, p99.99,
  // largest); a table and a plot of how many ticks were later than so long.
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
