// Maximum power point trackers on an array whose light changes.
#pragma once

#include <string>
#include <vector>

#include "core/settings/settings.h"
#include "photovoltaics/network/curve.h"

namespace photorque {

// Photocurrents of every cell over time, straight between the instants and constant outside them.
struct LightHistory {
  std::vector<double> time_s;                        // rises strictly, at least one
  std::vector<std::vector<double>> photocurrents_A;  // per instant, as the wiring's cells

  std::vector<double> at(double time_s) const;
};

// A tracker measures voltage and current of the array at successive instants and sets the next
// voltage.
struct Tracker {
  enum class Kind {
    // Keep stepping while the power rises, else turn round.
    perturb_and_observe,
    // Step towards dI/dV = −I/V (K. H. Hussein et al., IEE Proc. 142, 59 (1995)); stands still
    // there.
    incremental_conductance,
    // Perturb and observe; at the start, and whenever the power has changed by `rescan_fraction`
    // since the last sweep, sweep the whole range and continue at the best point.
    global_scan,
    // Sweep the whole range every `sweep_every_s` and stay at the best voltage between.
    periodic_sweep,
  };
  Kind kind = Kind::perturb_and_observe;
  double period_s = 0.1;        // between two decisions, > 0
  double step_fraction = 0.01;  // of the range of voltages
  double start_fraction = 0.8;  // of the range, the start of all but the scanning kinds
  int sweep_points = 40;        // of one sweep, one period each
  double sweep_every_s = 60.0;
  double rescan_fraction = 0.05;
};
std::string name_of(Tracker::Kind kind);

struct TrackerRun {
  Tracker tracker;
  double efficiency = 1.0;  // energy over that at the global maximum
  double energy_J = 0.0, best_energy_J = 0.0;
  double false_maximum_s = 0.0;  // on the slope of another maximum than the global one
  double duration_s = 0.0;
  std::vector<double> time_s, voltage_V, power_W, best_W, best_V;
};

// Runs each tracker over the history, from its first to its last instant, on the exact curves.
// Several trackers share the work of finding the true maxima if their periods are equal.
std::vector<TrackerRun> run_trackers(const std::vector<Tracker>& trackers,
                                     const ArrayWiring& wiring, const CellTables& tables,
                                     const LightHistory& light);

// Reads the table `[array.tracker]`: one tracker of each of its kinds.
std::vector<Tracker> read_trackers(const Settings& tracker);

}  // namespace photorque
