// The ways themselves, each from its table of [supply_trade].
#pragma once

#include <functional>

#include "tools/runs/console.h"
#include "tools/runs/options.h"
#include "tools/supply/trade.h"

namespace photorque {

// Range of an efficiency.
inline constexpr Range conversion_range{0.0, 1.0, true, false};

// [supply_trade.battery]: specific_energy_Wh_kg (150 ± 50, of the pack), usable_fraction (0.9),
// electrodes_m (how far the lithium moves along body x, 3.2e-4).
SupplyOption battery_option(const Settings& settings, const SupplyTask& task);
// The torque of its lithium at a charge drawn, as a fraction of the task's charge, at zero tilt.
double battery_torque_N_m(const Settings& settings, const SupplyTask& task, double fraction);

// [supply_trade.cable]: voltage_V (24), length_m, strands, strand_diameter_m,
// insulation_diameter_m, insulation_modulus_Pa, attached_below_m (0 ± 0.005: of the centre of
// rotation).
SupplyOption cable_option(const Settings& settings, const SupplyTask& task);

// [[supply_trade.microwave]]: frequency_Hz, transmitter_diameter_m, rectenna_side_m, distance_m,
// height_m (of the rectenna over the centre of rotation), rectifier_efficiency,
// transmitter_efficiency, mass_kg_m2, plane ("E", "H": in which it tilts).
SupplyOption microwave_option(const Settings& settings, const SupplyTask& task);

// [supply_trade.induction]: frequency_Hz, transmitter and receiver (tables with inner_radius_m,
// outer_radius_m, turns, copper_area_m2, ac_factor), transmitter_height_m (lab) and
// receiver_height_m (body), detuning, inverter_efficiency, rectifier_efficiency, ball_radius_m,
// ball_conductivity_S_m.
SupplyOption induction_option(const Settings& settings, const SupplyTask& task);

// [[supply_trade.beam]]: name, experiment (beside this one), lamp_efficiency, converter_efficiency,
// array_mass_kg. Traces that experiment at every tilt and evaluates its array.
struct BeamSettings {
  std::string name, experiment;
  RunOptions run;
  double lamp_efficiency = 0.0, converter_efficiency = 0.0, array_mass_kg = 0.0;
};
BeamSettings read_beam(const Settings& settings, const RunOptions& options);
SupplyOption beam_option(const BeamSettings& beam, const SupplyTask& task, const Console& console);

// Their tables, as they are declared, and [supply_trade] with all of them.
Key battery_table();
Key cable_table();
Key microwave_table();
Key induction_table();
Key beam_table();
Key supply_table();

// The task in [supply_trade].
SupplyTask read_supply_task(const Settings& root, const Settings& supply_trade);

}  // namespace photorque
