// The table [fit] of the command `fit-cell`.
#pragma once

#include "core/settings/typed_keys.h"
#include "photovoltaics/cell/model.h"

namespace photorque {

namespace fit_key {
inline constexpr Range cell_temperatures_K{coldest_cell_K, hottest_cell_K};
inline constexpr TextsKey curves(
    "curves",
    "files of voltage and current, as `voltage_V,current_A`, `V,I`, `Voltage (V);Current (mA)`; "
    "several are repeats under the same light, or have separate lights; *or*",
    {.optional = true});
inline constexpr TablesKey curve("curve", "curves whose light or temperature is stated; *or*");
inline constexpr TextKey curve_file("file", "file of the curve; it may also be in `curves`");
inline constexpr NumberKey curve_irradiance("irradiance_W_m2", Range::positive(),
                                            "irradiance of the curve",
                                            {.usually = "that in the file, if any"});
inline constexpr NumberKey curve_temperature("temperature_K", cell_temperatures_K,
                                             "temperature of the cells",
                                             {.usually = "that in the file, else that of `[fit]`"});
inline constexpr ChoiceKey shunt(
    "shunt", {"best", "constant", "inverse", "exponential"}, 0,
    "R_sh constant, inversely proportional to the irradiance (De Soto, CEC), or for curves "
    "exponential in it (PVsyst); `best`: with several irradiances, chosen by cross-validation");
inline constexpr TablesKey datasheet("datasheet", "one to several points at one temperature");
inline constexpr TextKey module_file(
    "module_file", "*or* instead: a library of modules of SAM (CSV), or a PAN file of PVsyst",
    {.optional = true});
inline constexpr TextKey module_name(
    "module_name", "Name of a module in the library, or a part of it that no other Name has",
    {.optional = true});
inline constexpr IntegerKey cells_in_series("cells_in_series", 1, 1, 2000,
                                            "number of cells in series in the device");
inline constexpr NumberKey temperature(
    "temperature_K", 298.15, cell_temperatures_K,
    "cell temperature of the curves; a datasheet gives it for each point");
inline constexpr NumberKey rounding_current("rounding_A", Range::not_negative(),
                                            "step of a datasheet's currents",
                                            {.usually = "the last decimal that any of them has"});
inline constexpr NumberKey rounding_voltage("rounding_V", Range::not_negative(),
                                            "step of a datasheet's voltages",
                                            {.usually = "the last decimal that any of them has"});
inline constexpr NumberKey tolerance(
    "tolerance", 0.0, {0.0, 0.5}, "standard error of every figure of the datasheet, as a fraction");
inline constexpr NumberKey current_noise(
    "current_noise", 1e-3, {1e-12, 1.0},
    "standard deviation of the currents of a curve, as a fraction of each reading (with "
    "`substrings`, of the short-circuit current)");
inline constexpr NumberKey voltage_noise(
    "voltage_noise", 5e-4, {1e-12, 1.0},
    "standard deviation of the voltages of a curve, as a fraction of each reading");
inline constexpr NumberKey correlation_points(
    "correlation_points", 0.0, Range::not_negative(),
    "correlation length of the noise of the current, in readings (slow drift of the light)");
inline constexpr IntegerKey substrings("substrings", 0, 0, 100,
                                       "number of groups of cells under different light in one "
                                       "curve of a partly shaded string; 0: all "
                                       "cells have the same light");
inline constexpr FlagKey even_voltage_steps(
    "even_voltage_steps", false,
    "repeats of one even ramp: reduces the noise of the voltages by averaging");
inline constexpr TableKey fit("fit", "parameters of cells from measurements");
}  // namespace fit_key

Key fit_table();

}  // namespace photorque
