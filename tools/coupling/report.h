// Results of a run with light as figures, tables, plots and text.
#pragma once

#include <optional>
#include <string>

#include "core/product.h"
#include "tools/coupling/coupled_run.h"
#include "tools/runs/console.h"

namespace photorque {

// Table "light_table": interpolation error of the table of light at attitudes outside the table.
Product table_product(const RotationTable& table);
void print_light_table(const Console& console, const RotationTable& table);

// Tables "power" (at most `max_rows` rows) and "energy_balance", the energies, and the plot
// "power_and_attitude" with power, charge, tilt and torque of light over one time axis. `history`
// is the product of the motion.
Product power_product(const CoupledRun& run, const Product& history, size_t max_rows);
void print_power(const Console& console, const CoupledRun& run);
// Warning for cells above their rated temperature; empty if there are none.
std::optional<std::string> hot_cells(const CoupledRun& run);

// Pointing stability of the body's z axis, from the true attitudes at equal intervals.
// Source of the measures: ECSS-E-ST-60-10C (absolute error, and relative error over a window).
Product pointing_product(const std::vector<PlatformState>& states);
void print_pointing(const Console& console, const Product& pointing);

}  // namespace photorque
