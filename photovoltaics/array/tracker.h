// Maximum power point trackers on an array whose light changes.
#pragma once

#include <string>
#include <vector>

#include "core/settings/settings.h"
#include "photovoltaics/network/curve.h"

namespace photorque {

// Photocurrents of every cell over time, linear between the instants and constant outside them.
struct LightHistory {
  std::vector<double> time_s;                        // strictly rising, at least one
  std::vector<std::vector<double>> photocurrents_A;  // per instant, in the order of the cells

  std::vector<double> at(double time_s) const;
};

// A tracker measures voltage and current of the array at successive instants and sets the next
// voltage.
struct Tracker {
  enum class Kind {
    // Steps the voltage in one direction while the power rises, else reverses the direction.
    perturb_and_observe,
    // Steps towards dI/dV = −I/V and stops there (K. H. Hussein et al., IEE Proc. 142, 59 (1995)).
    incremental_conductance,
    // As perturb_and_observe. At the start, and when the power has changed by `rescan_fraction`
    // since the last sweep, it sweeps the whole range and continues at the best point.
    global_scan,
    // Sweeps the whole range every `sweep_every_s` and keeps the best voltage in between.
    periodic_sweep,
  };
  Kind kind = Kind::perturb_and_observe;
  double period_s = 0.1;        // between two decisions, > 0
  double step_fraction = 0.01;  // voltage step, as a fraction of the voltage range
  double start_fraction = 0.8;  // initial voltage of kinds that do not scan, likewise
  int sweep_points = 40;        // number of points of a sweep, one period each
  double sweep_every_s = 60.0;
  double rescan_fraction = 0.05;
};
std::string name_of(Tracker::Kind kind);
std::vector<Tracker::Kind> all_tracker_kinds();

struct TrackerRun {
  Tracker tracker;
  double efficiency = 1.0;  // energy divided by that at the global maximum
  double energy_J = 0.0, best_energy_J = 0.0;
  double false_maximum_s = 0.0;  // time near a local maximum other than the global one
  double duration_s = 0.0;
  std::vector<double> time_s, voltage_V, power_W, best_W, best_V;
};

// Runs each tracker over the history, from its first to its last instant, on the exact curves.
// Trackers with equal periods share the computation of the true maxima.
std::vector<TrackerRun> run_trackers(const std::vector<Tracker>& trackers,
                                     const ArrayWiring& wiring, const CellTables& tables,
                                     const LightHistory& light);

// Reads the table `[array.tracker]`, all keys optional:
//   kinds = ["perturb_and_observe", "incremental_conductance", "global_scan", "periodic_sweep"]
//   period_s = 0.1, step_fraction = 0.01, start_fraction = 0.8, sweep_points = 40,
//   sweep_every_s = 60, rescan_fraction = 0.05
std::vector<Tracker> read_trackers(const Settings& tracker);

}  // namespace photorque
