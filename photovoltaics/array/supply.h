// The power system of a platform in changing light: array, tracker, converter, battery, load and
// the temperature of the cells, step by step, with a complete energy balance.
//
//   light on the cells = reflected + electric + heat given off + stored in the cells
//   electric           = lost in the converter + load + into the battery − out of the battery
//   into · η − out / η' = change of the battery's energy
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "photovoltaics/array/array.h"
#include "photovoltaics/array/day.h"
#include "photovoltaics/array/tracker_control.h"

namespace photorque {

// Times at which the lamps are switched on and off.
struct LampSchedule {
  bool on_at_start = true;
  std::vector<double> time_s;  // strictly ascending; the state changes at each of them
};

// Light relative to that of cold lamps at full power. The dependence of LampDroop on the time since
// switching on is modelled by two first-order lags. They recover with the same time constants while
// the lamp is off. At the start the lamps are cold.
class LampOutput {
 public:
  LampOutput(const LampDroop& droop, const LampSchedule& schedule, double start_s);

  // The relative light at a time ≥ start_s; at a switch the value after it.
  double at(double time_s) const;
  const std::vector<double>& switches_s() const { return switches_s_; }

 private:
  struct Stage {
    double from_s = 0.0;
    bool on = true;
    double faded = 0.0, warm = 0.0;  // at from_s, fractions of the full effects
  };

  LampDroop droop_;
  std::vector<double> switches_s_;
  std::vector<Stage> stages_;
};

// Parts of the power system. The temperature of the cells follows array.heat.
struct SupplyDesign {
  ArrayDesign array;
  std::vector<double> cell_area_m2;     // per cell of the wiring
  double max_photocurrent_A = 0.0;      // largest one of any cell, at array.temperature_K
  std::optional<Battery> battery = {};  // none: all power of the array is used
  double converter_efficiency = 1.0;    // between the array and battery and load, in (0, 1]
  double load_W = 0.0;                  // at the battery's terminals
  std::optional<Tracker> tracker = {};  // none: the best point at every step
};

// Compensated sum of many small terms.
// Source: A. Neumaier, ZAMM 54 (1974) 39.
class EnergySum {
 public:
  void add(double term) {
    const double sum = sum_ + term;
    lost_ += std::abs(sum_) >= std::abs(term) ? (sum_ - sum) + term : (term - sum) + sum_;
    sum_ = sum;
  }
  double value() const { return sum_ + lost_; }

 private:
  double sum_ = 0.0, lost_ = 0.0;
};

// Energies since the start [J], each added up separately.
struct SupplyEnergies {
  EnergySum on_cells;   // light
  EnergySum reflected;  // by CellHeat::absorptance; 0 if the cells' temperature is stated
  EnergySum given_off;  // heat, by convection and radiation
  EnergySum array;      // electric, from the array
  EnergySum best;       // energy available at the best point of the array
  EnergySum converter;  // lost in the converter
  EnergySum load;       // served
  EnergySum unserved;   // load without supply
  EnergySum into_battery, out_of_battery;  // at the battery's terminals
  EnergySum battery_loss;
};

// The relative closure of each balance: its error over the throughput.
struct SupplyClosure {
  double cells = 0.0;  // 0 if the cells' temperature is stated
  double bus = 0.0;
  double battery = 0.0;
  double largest() const { return std::max({cells, bus, battery}); }
};

// The battery reaches a limit of its charge, or leaves it by more than 1 % of the capacity.
struct SupplyEvent {
  std::string name;  // "battery_full", "battery_not_full", "battery_empty", "battery_not_empty"
  double time_s = 0.0;
};

class PowerSupply {
 public:
  // The battery, if there is one, starts with `stored_J`; the cells start at CellHeat::start_K.
  PowerSupply(SupplyDesign design, double stored_J);

  // Light during a step: photocurrents of the cells at array.temperature_K, and all light on them.
  struct Light {
    std::vector<double> photocurrent_A;
    double on_cells_W = 0.0;
  };
  // Computes one step. `judge`: whether the best point of the array is computed, which is slow.
  // Otherwise its last ratio to the light is used.
  void step(double time_s, double step_s, const Light& light, bool judge = true);

  // State after the last step; varying values are means over it.
  struct State {
    double array_W = 0.0;    // delivered
    double best_W = 0.0;     // at the best point of the array
    double voltage_V = 0.0;  // array voltage set by the tracker
    double load_W = 0.0;     // served
    double battery_W = 0.0;  // d/dt of the battery's energy
    double light_W = 0.0;    // on the cells
  };
  const State& state() const { return state_; }
  double temperature_K() const { return temperature_K_; }  // at the end of the last step
  double stored_J() const { return stored_J_; }            // at the end of the last step
  const SupplyEnergies& energies() const { return energies_; }
  const std::vector<SupplyEvent>& events() const { return events_; }
  SupplyClosure closure() const;
  const SupplyDesign& design() const { return design_; }

  void keep(Snapshot& snapshot);

 private:
  struct Curves;
  const CellTables& tables_at(int index);
  void take(double time_s, double step_s, double potential_W);
  void warm(double step_s);
  // A full or an empty battery.
  struct ChargeLimit {
    const char* reached;  // names of the events
    const char* left;
    bool is_reached = false;
    double last_s = 0.0;  // start of the last step from the limit
  };
  void add_event(ChargeLimit& limit, double before_J, double after_J, double time_s,
                 double until_limit_s);

  SupplyDesign design_;
  double area_m2_ = 0.0;
  std::optional<CellPlate> plate_;
  double start_J_, stored_J_;
  double start_K_, temperature_K_;
  std::map<int, CellTables> tables_;  // by temperature, see tables_at()
  std::optional<TrackerControl> control_;
  ChargeLimit full_{"battery_full", "battery_not_full"};
  ChargeLimit empty_{"battery_empty", "battery_not_empty"};
  double best_per_light_ = 0.0;  // best power over light on the cells, when last computed
  State state_;
  SupplyEnergies energies_;
  std::vector<SupplyEvent> events_;
};

}  // namespace photorque
