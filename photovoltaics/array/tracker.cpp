#include "photovoltaics/array/tracker.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/errors.h"
#include "core/settings/typed_keys.h"
#include "photovoltaics/array/tracker_control.h"

namespace photorque {
namespace {

namespace tracker_key {
constexpr Tracker usual;
constexpr TextsKey kinds(
    "kinds",
    "any of `\"perturb_and_observe\"`, `\"incremental_conductance\"`, `\"global_scan\"`, "
    "`\"periodic_sweep\"`; the list of losses uses the first",
    {.usually = "all four"});
constexpr NumberKey period("period_s", usual.period_s, Range::positive(),
                           "time between two decisions of a tracker");
constexpr NumberKey step_fraction("step_fraction", usual.step_fraction, {0.0, 0.5, true, false},
                                  "voltage step, as a fraction of the voltage range");
constexpr NumberKey start_fraction(
    "start_fraction", usual.start_fraction, {0.0, 1.0, true, false},
    "initial voltage of trackers that do not scan, as a fraction of the voltage range");
constexpr IntegerKey sweep_points("sweep_points", usual.sweep_points, 2, 10000,
                                  "number of points of a sweep; each point takes one period");
constexpr NumberKey sweep_every("sweep_every_s", usual.sweep_every_s, Range::positive(),
                                "`periodic_sweep`: time from one sweep to the next");
constexpr NumberKey rescan_fraction("rescan_fraction", usual.rescan_fraction, Range::positive(),
                                    "`global_scan`: relative change of power that starts a sweep");
}  // namespace tracker_key

constexpr const char* names[] = {"perturb_and_observe", "incremental_conductance", "global_scan",
                                 "periodic_sweep"};

// The maximum in the direction of rising power.
const ArrayPoint* uphill(const ArrayCurve& curve, const std::vector<ArrayPoint>& maxima,
                         double voltage_V) {
  const double open_V = curve.open_circuit_V(), h = 1e-6 * open_V;
  const double low = std::max(0.0, voltage_V - h), high = std::min(open_V, voltage_V + h);
  const bool rises =
      voltage_V < open_V && high * curve.current_A(high) > low * curve.current_A(low);
  const auto right = std::ranges::upper_bound(maxima, voltage_V, {}, &ArrayPoint::voltage_V);
  if (rises) return right == maxima.end() ? &maxima.back() : &*right;
  return right == maxima.begin() ? &maxima.front() : &*(right - 1);
}

const ArrayPoint& best_of(const std::vector<ArrayPoint>& maxima) {
  return *std::ranges::max_element(maxima, {}, &ArrayPoint::power_W);
}

// Range of voltages of a tracker: up to the largest open-circuit voltage of the history.
double range_V(const ArrayWiring& wiring, const CellTables& tables, const LightHistory& light) {
  double most = 0.0;
  for (const auto& currents : light.photocurrents_A) {
    most = std::max(most, ArrayCurve(wiring, tables, currents).open_circuit_V());
  }
  return most;
}

void record(TrackerRun& run, double time_s, double voltage_V, const ArrayCurve& curve,
            const std::vector<ArrayPoint>& maxima, double power_W) {
  const double dt_s = run.tracker.period_s;
  const ArrayPoint best = maxima.empty() ? ArrayPoint{} : best_of(maxima);
  run.energy_J += power_W * dt_s;
  run.best_energy_J += best.power_W() * dt_s;
  run.duration_s += dt_s;
  const bool several = maxima.size() > 1;
  if (several && uphill(curve, maxima, voltage_V)->voltage_V != best.voltage_V) {
    run.false_maximum_s += dt_s;
  }
  run.time_s.push_back(time_s);
  run.voltage_V.push_back(voltage_V);
  run.power_W.push_back(power_W);
  run.best_W.push_back(best.power_W());
  run.best_V.push_back(best.voltage_V);
}

}  // namespace

std::string name_of(Tracker::Kind kind) {
  return names[static_cast<size_t>(kind)];
}

std::vector<double> LightHistory::at(double t) const {
  const auto after = std::ranges::upper_bound(time_s, t);
  if (after == time_s.begin()) return photocurrents_A.front();
  if (after == time_s.end()) return photocurrents_A.back();
  const auto i = static_cast<size_t>(after - time_s.begin());
  const double fraction = (t - time_s[i - 1]) / (time_s[i] - time_s[i - 1]);
  std::vector<double> between(photocurrents_A[i].size());
  for (size_t c = 0; c < between.size(); ++c) {
    between[c] = std::lerp(photocurrents_A[i - 1][c], photocurrents_A[i][c], fraction);
  }
  return between;
}

std::vector<TrackerRun> run_trackers(const std::vector<Tracker>& trackers,
                                     const ArrayWiring& wiring, const CellTables& tables,
                                     const LightHistory& light) {
  std::vector<TrackerRun> runs;
  std::vector<TrackerControl> controllers;
  const double range = range_V(wiring, tables, light);
  for (const Tracker& tracker : trackers) {
    if (tracker.period_s != trackers.front().period_s) {
      throw InputError({}, "tracker", "different periods", "one period for all trackers");
    }
    runs.push_back({tracker, 1.0, 0, 0, 0, 0, {}, {}, {}, {}, {}});
    controllers.emplace_back(tracker, range);
  }
  if (trackers.empty() || range == 0.0) return runs;
  const double period_s = trackers.front().period_s;
  const double duration_s = light.time_s.back() - light.time_s.front();
  constexpr double max_steps = 1e7;
  if (duration_s / period_s > max_steps) {
    throw InputError({}, "array.tracker.period_s", std::to_string(period_s) + " s",
                     "at most ten million periods in the motion");
  }
  const auto steps = static_cast<int64_t>(std::floor(duration_s / period_s)) + 1;
  for (int64_t k = 0; k < steps; ++k) {
    const double time_s = light.time_s.front() + static_cast<double>(k) * period_s;
    const ArrayCurve curve(wiring, tables, light.at(time_s));
    const std::vector<ArrayPoint> maxima = curve.maxima();
    const double open_V = curve.open_circuit_V();
    for (size_t i = 0; i < runs.size(); ++i) {
      const double v = controllers[i].voltage_V();
      // Above the open-circuit voltage, the diode of the converter blocks.
      const double current_A = v < open_V ? curve.current_A(v) : 0.0;
      record(runs[i], time_s, v, curve, maxima, v * current_A);
      controllers[i].observe({v, current_A});
    }
  }
  for (TrackerRun& run : runs) {
    if (run.best_energy_J > 0) run.efficiency = run.energy_J / run.best_energy_J;
  }
  return runs;
}

std::vector<Tracker> read_trackers(const Settings& s) {
  Tracker common;
  common.period_s = s.get(tracker_key::period);
  common.step_fraction = s.get(tracker_key::step_fraction);
  common.start_fraction = s.get(tracker_key::start_fraction);
  common.sweep_points = static_cast<int>(s.get(tracker_key::sweep_points));
  common.sweep_every_s = s.get(tracker_key::sweep_every);
  common.rescan_fraction = s.get(tracker_key::rescan_fraction);
  std::vector<std::string> wanted(std::begin(names), std::end(names));
  if (s.has(tracker_key::kinds)) wanted = s.get(tracker_key::kinds);
  std::vector<Tracker> trackers;
  for (const std::string& name : wanted) {
    const auto at = std::ranges::find(names, name);
    if (at == std::end(names)) {
      throw s.error(tracker_key::kinds, '"' + name + '"',
                    "perturb_and_observe, incremental_conductance, global_scan or periodic_sweep");
    }
    common.kind = static_cast<Tracker::Kind>(at - std::begin(names));
    trackers.push_back(common);
  }
  return trackers;
}

std::vector<Key> tracker_keys() {
  using namespace tracker_key;
  return {kinds, period, step_fraction, start_fraction, sweep_points, sweep_every, rescan_fraction};
}

}  // namespace photorque
