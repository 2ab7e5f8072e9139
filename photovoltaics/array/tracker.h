// Maximum power point trackers of an array in changing light.
#pragma once

#include <string>
#include <vector>

#include "core/settings/settings.h"
#include "photovoltaics/network/curve.h"

namespace photorque {

// Photocurrents of every cell over time, linear between the instants and constant outside them.
struct LightHistory {
  std::vector<double> time_s;                        // strictly ascending, at least one
  std::vector<std::vector<double>> photocurrents_A;  // per instant and cell of the wiring

  std::vector<double> at(double time_s) const;
};

// A tracker measures voltage and current of the array at successive instants and sets the next
// voltage.
struct Tracker {
  enum class Kind {
    // Steps on while the power rises, otherwise reverses.
    perturb_and_observe,
    // Steps towards dI/dV = −I/V and stops there (K. H. Hussein et al., IEE Proc. 142, 59 (1995)).
    incremental_conductance,
    // Perturb and observe. At the start, and whenever the power has changed by `rescan_fraction`
    // since the last sweep, it sweeps the whole range and continues at the best point.
    global_scan,
    // Sweeps the whole range every `sweep_every_s` and keeps the best voltage in between.
    periodic_sweep,
  };
  Kind kind = Kind::perturb_and_observe;
  double period_s = 0.1;        // between two decisions, > 0
  double step_fraction = 0.01;  // fraction of the range of voltages
  double start_fraction = 0.8;  // initial fraction of the range, except for the scanning kinds
  int sweep_points = 40;        // points of one sweep, one period each
  double sweep_every_s = 60.0;
  double rescan_fraction = 0.05;
};
std::string name_of(Tracker::Kind kind);

struct TrackerRun {
  Tracker tracker;
  double efficiency = 1.0;  // energy over the energy at the global maximum
  double energy_J = 0.0, best_energy_J = 0.0;
  double false_maximum_s = 0.0;  // time on the slope of a maximum other than the global one
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
