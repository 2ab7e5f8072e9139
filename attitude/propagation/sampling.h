// States at requested times, collected while the propagator passes them.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "attitude/propagation/propagator.h"

namespace photorque {

// Up to eight states in lanes. Lanes from `count` on repeat the last state.
struct Samples {
  size_t first = 0;  // index of lane 0 among the times asked for
  int count = 0;
  Lanes time_s = 0.0;
  std::array<ZeroOrderHold, Lanes::count> held = {};
  std::vector<Lanes> y;  // Dynamics::size() components
  std::vector<Lanes>
      derivatives;  // of y, as Propagator::dense_derivatives; empty without variables

  // Stores or restores samples without derivatives: states of `components` components at some of
  // `times` times.
  void keep(Snapshot& snapshot, size_t components, size_t times);
};

// Calls `sink` with the states at time_s(0), time_s(1), …, time_s(count − 1), which must be
// non-decreasing. The memory used is independent of their number. At a jump the sample has the
// values after it.
class Sampler {
 public:
  Sampler(const Propagator& propagator, size_t count, std::function<double(size_t)> time_s,
          std::function<void(const Samples&)> sink);

  // Call after every step: takes the samples within the step, except at its end.
  void follow();
  // Call after the run has ended: takes the samples at its end too.
  void finish();

  // Stores or restores a sampler without derivatives, after a step.
  void keep(Snapshot& snapshot);

 private:
  void take(bool including_end);
  void file(const Lanes& times_s, int batch);
  void flush();

  const Propagator& propagator_;
  size_t count_;
  std::function<double(size_t)> time_s_;
  std::function<void(const Samples&)> sink_;
  std::vector<Lanes> y_, derivatives_;
  Samples samples_;
  size_t next_ = 0;
};

// Samples the whole run.
void sample(Propagator& propagator, size_t count, const std::function<double(size_t)>& time_s,
            const std::function<void(const Samples&)>& sink);

}  // namespace photorque
