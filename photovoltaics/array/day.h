// Simulation of a day: the cells become warm, the lamps lose light, the battery is discharged.
#pragma once

#include <optional>
#include <vector>

#include "core/settings/settings.h"
#include "photovoltaics/array/losses.h"

namespace photorque {

// Light of the lamps relative to that when they are switched on: (1 − depth (1 − e^{−t/τ})) (1 − k
// ΔT(t)). The first factor is measured on a lamp. The second one follows from the rise of its
// junction temperature, ΔT(t) = rise (1 − e^{−t/τ_h}), and the roll-off k of its data sheet. Both
// are 1 by default.
struct LampDroop {
  double depth = 0.0;  // in [0, 1)
  double time_constant_s = 600.0;
  double roll_off_1_K = 0.0;  // k ≥ 0, k · rise < 1; red LEDs lose about 0.5 % per kelvin
  double rise_K = 0.0;        // final rise, ≥ 0
  double rise_time_constant_s = 300.0;

  // The light after these fractions of the fading and of the rise.
  double light(double faded, double warm) const {
    return (1.0 - depth * faded) * (1.0 - roll_off_1_K * rise_K * warm);
  }
  double light_at(double time_s) const;
  double min_light() const { return light(1.0, 1.0); }
};

struct Battery {
  double capacity_J = 360.0 * 3600.0;  // > 0
  double charge = 1.0;                 // initial charge as a fraction of the capacity, in [0, 1]
  double charge_efficiency = 0.97;  // stored energy over energy delivered to the battery, in (0, 1]
  double discharge_efficiency = 0.97;  // delivered energy over that taken from it, in (0, 1]

  struct Step {
    double charge_J = 0.0;       // at the end
    double until_limit_s = 0.0;  // time until it is full or empty; the whole step if it is neither
  };
  // A step with a constant surplus of power at the terminals; a deficit is negative.
  Step step(double charge_J, double surplus_W, double step_s) const;
};

// Settings of a day; every efficiency is in (0, 1].
struct DaySettings {
  LampDroop droop;
  Battery battery;
  double converter_efficiency = 0.95;
  double tracker_efficiency = 1.0;
  double load_W = 25.0;
  double duration_s = 86400.0;
  double step_s = 30.0;  // maximum; the duration is a whole number of steps
  bool lamps_on = true;
};

// History with one entry per step and one for the start, and its sums.
struct DayResult {
  std::vector<double> time_s, temperature_K, array_W, charge_J;
  double array_energy_J = 0.0;
  std::optional<double> empty_after_s;  // time at which the load is first not served
  double mean_array_W = 0.0;
};

// The temperature of the cells follows design.heat from its start_K. `array` is the result at
// design.temperature_K, which is constant without heat. The power is interpolated bilinearly
// between a few temperatures and light levels, with an error of 1e-3.
DayResult run_day(const ArrayDesign& design, const ArrayResult& array, const DaySettings& settings);

// Reads the table `[array.day]`.
DaySettings read_day(const Settings& day);

// Final temperature and charge, mean power, the table "day" and the plot "day_history".
Product day_product(const DayResult& day);

}  // namespace photorque
