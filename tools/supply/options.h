// The power supplies, each from its table of [supply_trade].
#pragma once

#include "tools/runs/console.h"
#include "tools/runs/options.h"
#include "tools/supply/trade.h"

namespace photorque {

// Range of an efficiency.
inline constexpr Range conversion_range{0.0, 1.0, true, false};

// [supply_trade.battery]
SupplyOption battery_option(const Settings& settings, const SupplyTask& task);
// Torque due to its lithium at zero tilt, at a drawn charge given as a fraction of the task's
// charge.
double battery_torque_N_m(const Settings& settings, const SupplyTask& task, double fraction);

// [supply_trade.cable]
SupplyOption cable_option(const Settings& settings, const SupplyTask& task);

// [[supply_trade.microwave]]
SupplyOption microwave_option(const Settings& settings, const SupplyTask& task);

// [supply_trade.induction]
SupplyOption induction_option(const Settings& settings, const SupplyTask& task);

// [[supply_trade.beam]]: traces its experiment at every tilt and evaluates its array.
struct BeamSettings {
  std::string name, experiment;
  RunOptions run;
  double lamp_efficiency = 0.0, converter_efficiency = 0.0, array_mass_kg = 0.0;
};
BeamSettings read_beam(const Settings& settings, const RunOptions& options);
SupplyOption beam_option(const BeamSettings& beam, const SupplyTask& task, const Console& console);

// Declarations of the tables, and of [supply_trade] with all of them.
Key battery_table();
Key cable_table();
Key microwave_table();
Key induction_table();
Key beam_table();
Key supply_table();

// Task of the supplies in [supply_trade].
SupplyTask read_supply_task(const Settings& root, const Settings& supply_trade);

}  // namespace photorque
