// The truth of a run as a table, plots and headline figures.
#pragma once

#include <string>
#include <vector>

#include "attitude/propagation/propagator.h"
#include "core/product.h"

namespace photorque {

class TimeHistory {
 public:
  explicit TimeHistory(const Dynamics& dynamics);

  // One row: lane `lane` of `now` belongs to `state`.
  void add(const PlatformState& state, const Dynamics::Instants& now, int lane);

  // Tables "time_history" and "events"; plots "tilt", "yaw", "rates", "charge" and "power"
  // (where there are any), "torques" (largest sizes of all) and one for each disturbance. Curves
  // are thinned to a few thousand points that keep every extreme. The largest tilt is that of all
  // the states of the run, of which a row here may stand for many.
  Product product(const std::vector<PlatformState>& states, const std::vector<Event>& events,
                  const Propagator::Statistics& statistics) const;

  void keep(Snapshot& snapshot);

 private:
  std::vector<std::string> labels_;  // of the disturbances that act on the body
  std::vector<size_t> acting_;       // their indices
  std::vector<Table::Column> columns_;
  size_t first_torque_ = 0;  // column of the first disturbance's x torque
};

}  // namespace photorque
