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

// Largest tilt and range of yaw during a run, from the states within the steps and not only those
// of its rows.
class Excursion {
 public:
  explicit Excursion(const PlatformState& initial);

  // Call after every step.
  void follow(const Propagator& motion);

  double largest_tilt_rad() const { return largest_tilt_rad_; }
  double largest_tilt_time_s() const { return largest_tilt_time_s_; }
  // Largest minus least yaw, with whole turns counted.
  double yaw_rad() const { return most_yaw_rad_ - least_yaw_rad_; }

  void keep(Snapshot& snapshot);

 private:
  // Looks at eight instants in [from_s, to_s], refined about the largest tilt.
  void look(const Propagator& motion, double from_s, double to_s, int refinements);

  double until_s_, largest_tilt_rad_, largest_tilt_time_s_;
  double read_yaw_rad_;                                              // the last, within a turn
  double yaw_rad_ = 0.0, least_yaw_rad_ = 0.0, most_yaw_rad_ = 0.0;  // since the start
};

class TimeHistory {
 public:
  explicit TimeHistory(const Dynamics& dynamics);

  // Adds a row: `state`, with the values in lane `lane` of `now`.
  void add(const PlatformState& state, const Dynamics::Instants& now, int lane);

  // Tables "time_history" and "events". Plots "tilt", "yaw", "rates", "charge" and "array_power"
  // (if they are not zero), "torque_fractions" and "torques" (magnitudes of all torques), and one
  // for each disturbance, of thinned_curve().
  Product product(const Excursion& excursion, const std::vector<Event>& events,
                  const Propagator::Statistics& statistics) const;

  void keep(Snapshot& snapshot);

 private:
  std::vector<std::string> labels_;  // of the disturbances that act on the body
  std::vector<size_t> acting_;       // their indices
  Table table_;
};

}  // namespace photorque
