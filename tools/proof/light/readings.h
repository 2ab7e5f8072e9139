// What is read of an injected case: scans, sweeps and runs, without noise and with it.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "attitude/injection/draw.h"
#include "tools/proof/light/circuit.h"
#include "tools/proof/light/world.h"

namespace photorque::injected {

// Where and when a reading was taken, for laws outside the catalogue.
struct InjectedPlace {
  double u_m = 0.0, v_m = 0.0, time_s = 0.0;
};

// Everything that the readings depend on.
struct LightWorld {
  InjectedLight light;
  InjectedCircuit circuit;
  double detector_gain = 1.0, droop_depth = 0.0, droop_time_s = 1.0;
  std::vector<std::array<double, 2>> trapped_s;  // of the first run
  // Factors on readings of a scan, and on the light of a run.
  std::vector<std::function<double(const InjectedPlace&)>> laws;
};

struct LightNoiseStated {
  double irradiance_W_m2 = 4.0, relative = 0.01;
  double voltage_V = 0.006, current_A = 0.004;
  double tracker_step_V = 0.0;  // 0: the tracker holds the highest maximum
};

// Rows before anything is read: where the plate stands, and what is set.
struct LightRows {
  enum class Kind { scan, sweep, run };
  Kind kind = Kind::scan;
  bool first = true;  // a recording; else a hold-out
  std::vector<Quaternion> attitude;
  std::vector<double> tilt_deg, heading_deg;                       // scans and sweeps
  std::vector<double> u_m, v_m, voltage_V, time_s, temperature_K;  // those of its kind
  std::vector<int> sweep;

  size_t size() const { return attitude.size(); }
  LightRows part(const std::vector<size_t>& rows) const;
};

// Without noise: of a scan the irradiance, of a sweep the current at each voltage, of a run voltage
// and current in turn (where its voltage is set, that one again).
std::vector<double> injected_readings(const LightWorld& world, const LightRows& rows,
                                      bool voltage_is_set);
// Standard deviation of each of them as it shows: that of a sweep's current holds the voltage's.
std::vector<double> reading_errors(const LightWorld& world, const LightRows& rows,
                                   const LightNoiseStated& noise,
                                   const std::vector<double>& readings);
// Light on every cell at one attitude.
std::vector<double> light_on_cells(const LightWorld& world, const Quaternion& attitude);

}  // namespace photorque::injected
