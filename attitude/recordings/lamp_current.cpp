#include "attitude/recordings/lamp_current.h"

#include <algorithm>
#include <cmath>

#include "core/numerics/steady_stretches.h"

namespace photorque {

LampCurrent::LampCurrent(const Channel* channel) {
  if (channel == nullptr) return;
  double before_A = NAN;
  for (const double read_A : channel->values) {
    if (!std::isnan(read_A)) before_A = std::max(0.0, read_A);
    if (!std::isnan(before_A)) held_A_.push_back(before_A);
  }
  missing_ = channel->values.size() - held_A_.size();
  if (held_A_.empty()) return;
  const double noise_A = 0.01 * *std::ranges::max_element(held_A_);
  hold_means(held_A_, noise_A);
  is_lit_ = noise_A > 0.0;
}

void LampCurrent::hold(size_t row, ZeroOrderHold& held) const {
  if (!is_lit_) return;
  held.led_current_A = held_A_[row < missing_ ? 0 : row - missing_];
  held.lamps_as_stated = 0.0;
}

}  // namespace photorque
