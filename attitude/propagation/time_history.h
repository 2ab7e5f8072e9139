// True states, torques and power of a run as a table, plots and headline figures.
#pragma once

#include <string>
#include <vector>

#include "attitude/propagation/propagator.h"
#include "core/product.h"

namespace photorque {

// A curve of at most about 1600 points, the number of pixel columns of a plot, that keeps every
// extreme.
Plot::Curve thinned_curve(const std::vector<double>& x, const std::vector<double>& y);

// The table "events".
Table event_table(const std::vector<Event>& events);

// Magnitudes of a torque in the rows of the table "time_history", from its columns STEM_x_N_m to
// STEM_z_N_m.
std::vector<double> torque_sizes(const Table& history, const std::string& stem);

class TimeHistory {
 public:
  explicit TimeHistory(const Dynamics& dynamics);

  // Adds a row: `state`, with the values in lane `lane` of `now`.
  void add(const PlatformState& state, const Dynamics::Instants& now, int lane);

  // Tables "time_history" and "events". Plots "tilt", "yaw", "rates", "charge" and "array_power"
  // (if they are not zero), "torque_fractions" and "torques" (magnitudes of all torques), and one
  // for each disturbance, of thinned_curve(). The largest tilt is taken from all `states` of the
  // run, not only from the rows of this history.
  Product product(const std::vector<PlatformState>& states, const std::vector<Event>& events,
                  const Propagator::Statistics& statistics) const;

  void keep(Snapshot& snapshot);

 private:
  std::vector<std::string> labels_;  // of the disturbances that act on the body
  std::vector<size_t> acting_;       // their indices
  Table table_;
};

}  // namespace photorque
