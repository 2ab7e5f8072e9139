// The recorded current of a laboratory's lamps, as a schedule holds it.
#pragma once

#include <vector>

#include "attitude/model/schedule.h"
#include "attitude/recordings/recording.h"

namespace photorque {

// What changes by less than a hundredth of the largest is noise, of which the mean is held: each
// change begins a step of the propagation.
class LampCurrent {
 public:
  // Of `led_current_A`; null: the recording has none.
  explicit LampCurrent(const Channel* channel);

  // Before the first reading as at it. Does nothing where no lamp shines.
  void hold(size_t row, ZeroOrderHold& held) const;

 private:
  std::vector<double> held_A_;
  size_t missing_ = 0;  // rows before the first reading
  bool is_lit_ = false;
};

}  // namespace photorque
