#include "attitude/model/schedule.h"

#include <algorithm>

#include "core/errors.h"

namespace photorque {

ZeroOrderHold Schedule::at(double t_s) const {
  const auto later = std::upper_bound(time_s.begin(), time_s.end(), t_s);
  if (later == time_s.begin()) return {};
  return held[static_cast<size_t>(later - time_s.begin()) - 1];
}

void Schedule::append(double t_s, const ZeroOrderHold& values) {
  if (!time_s.empty() && t_s <= time_s.back()) {
    throw NumericalError("a schedule must be written in order of time");
  }
  if (!held.empty() && held.back() == values) return;
  time_s.push_back(t_s);
  held.push_back(values);
}

}  // namespace photorque
