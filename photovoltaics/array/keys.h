// The keys of [array] that are read in this folder.
#pragma once

#include <vector>

#include "core/settings/typed_keys.h"
#include "photovoltaics/array/design.h"

namespace photorque {

// Maximum number of cells of an array.
inline constexpr int most_cells = 100000;

inline constexpr Range cell_temperatures_K{coldest_cell_K, hottest_cell_K};

inline constexpr double bypass_drop_V = 0.5;
namespace diode_key {
inline constexpr Diode usual;
inline constexpr NumberKey drop("drop_V", bypass_drop_V, Range::not_negative(),
                                "forward voltage of an ideal diode; above 0 for a bypass diode");
inline constexpr NumberKey saturation("saturation_A", usual.saturation_A, Range::positive(),
                                      "saturation current of a junction");
inline constexpr NumberKey ideality("ideality", usual.ideality, Range::positive(),
                                    "ideality factor of a junction");
inline constexpr NumberKey series("series_ohm", usual.series_ohm, series_ohm_range,
                                  "series resistance of a junction");
}  // namespace diode_key

// Parameters that replace those of all cells, or of one cell.
namespace cell_key {
inline constexpr NumberKey reference_area(
    "reference_area_m2", Range::positive(),
    "area to which currents and resistances refer; required with them");
inline constexpr NumberKey reference_temperature("reference_temperature_K", cell_temperatures_K,
                                                 "temperature T₀ to which the parameters refer");
inline constexpr NumberKey saturation_1(
    "saturation_1_A", Range::not_negative(),
    "saturation current I₁ of the first diode; I₁ and I₂ must not both be 0");
inline constexpr NumberKey saturation_2("saturation_2_A", Range::not_negative(),
                                        "saturation current I₂ of the second diode");
inline constexpr NumberKey ideality_1("ideality_1", Range{0.01, 100.0},
                                      "ideality factor n₁ of the first diode");
inline constexpr NumberKey ideality_2("ideality_2", Range{0.01, 100.0},
                                      "ideality factor n₂ of the second diode");
inline constexpr NumberKey series("series_ohm", series_ohm_range, "series resistance R_s");
inline constexpr NumberKey shunt("shunt_ohm", Range::positive(), "shunt resistance R_sh");
inline constexpr NumberKey shunt_photocurrent(
    "shunt_photocurrent_A", Range::not_negative(),
    "photocurrent at which the shunt is R_sh; at others it is inversely proportional to the "
    "photocurrent (De Soto, CEC). 0: R_sh in any light");
inline constexpr NumberKey shunt_dark("shunt_dark_ohm", Range::positive(),
                                      "with `shunt_photocurrent_A`: R_sh in the dark, approached "
                                      "exponentially (PVsyst)");
inline constexpr NumberKey shunt_exponent(
    "shunt_exponent", Range{0.01, 100.0},
    "with `shunt_dark_ohm`: exponent c in e^(−c·light); PVsyst uses 5.5");
inline constexpr NumberKey breakdown_fraction(
    "breakdown_fraction", {0.0, 7.0}, "coefficient a of the reverse breakdown; 0: no breakdown");
inline constexpr NumberKey breakdown("breakdown_V", {-1e308, 0.0, false, true},
                                     "breakdown voltage V_br");
inline constexpr NumberKey breakdown_exponent("breakdown_exponent", {1.0, 1e3},
                                              "exponent m of the reverse breakdown");
inline constexpr NumberKey gap("gap_eV", Range::positive(), "band gap E₀ at T₀");
inline constexpr NumberKey gap_slope("gap_slope_per_K", {},
                                     "relative slope s of the band gap, E = E₀ (1 + s (T − T₀))");
inline constexpr NumberKey photocurrent_slope(
    "photocurrent_slope_per_K", {},
    "relative slope of the photocurrent over temperature; about 4e-4 in sunlight");
inline constexpr IntegerKey index("index", 0, most_cells - 1,
                                  "number of the cell: row · columns + column, from 0",
                                  {.varies = true});
inline constexpr NumberKey photocurrent_factor(
    "photocurrent_factor", 1.0, {0.0, 1e6, false, false},
    "multiplies the photocurrent that follows from the light on the cell");
}  // namespace cell_key

namespace array_key {
inline constexpr Word diodes[] = {
    {"none", "none"},
    {"ideal", "no reverse current; exactly `drop_V` when it conducts"},
    {"junction", "an exponential with a series resistance"}};

inline constexpr ChoiceKey series("series", {"columns", "rows"}, 0,
                                  "order of the cells: a serpentine along columns or rows");
inline constexpr IntegerKey strings(
    "strings", 1, 1, most_cells,
    "number of equal parts of the serpentine, in parallel; must divide the number of cells",
    {.varies = true});
inline constexpr IntegerKey bypass_every(
    "bypass_every", 1, most_cells,
    "number of cells per bypass diode, at most that of a string; the last group may have fewer",
    {.usually = "a whole string", .varies = true});
inline constexpr FlagKey cross_tied("cross_tied", false,
                                    "connects cells at equal positions of all strings in parallel");
inline constexpr TextsKey circuit(
    "circuit",
    "instead of `strings`, `bypass_every` and `cross_tied`: the serpentine in equal parts, the "
    "outermost level first, as `\"series N\"` or `\"parallel N\"`; with `bypass` after it each of "
    "the N parts has a bypass diode. The numbers multiply to the number of cells. Half-cut: "
    "`[\"series 3 bypass\", \"parallel 2\", \"series 20\"]`",
    {.optional = true});
inline constexpr OtherKey wiring(
    "wiring", Key::an_array,
    "instead of the five keys above: `[string, …]`. A string is `[substring, …]`, each with a "
    "bypass diode; a substring is `[cell, …]`, each cell at most once. A list in place of a cell "
    "contains cells in parallel, a list inside that list cells in series, and so on alternately. "
    "`\"bypass\"` at the head of such a list adds a diode in parallel with it",
    {.optional = true});
inline constexpr ChoiceKey bypass("bypass", diodes, 1,
                                  "bypass diode in parallel with every substring");
inline constexpr ChoiceKey blocking("blocking", diodes, 0,
                                    "blocking diode in series with every string");
inline constexpr TableKey bypass_diode("bypass_diode", "parameters of the bypass diodes");
inline constexpr TableKey blocking_diode("blocking_diode", "parameters of the blocking diodes");
inline constexpr OtherKey cells(
    "cells", Key::an_array | Key::a_text,
    "[columns, rows], at most 100000, along u and v of the map: cell number = row · columns + "
    "column, from 0; or `\"mesh\"`: every connected piece of the surface under the map is a cell "
    "(triangles that share an edge, on one instance of a mesh). The receiver's node must then "
    "contain cells only. Cells on a lattice are numbered as above, others in their order in the "
    "mesh, as one row; `cells.csv` has their centres");
inline constexpr NumbersKey low("low_m", {}, "[u, v] of the lower corner of the cell", {.size = 2});
inline constexpr NumbersKey high("high_m", {}, "[u, v] of the upper corner of the cell",
                                 {.size = 2});
inline constexpr TablesKey rectangle(
    "rectangle",
    "one rectangle per cell, instead of `cells`, anywhere on the irradiance map, in the "
    "coordinates u and v of the map",
    {.completes = true});
inline constexpr NumberKey gap("gap_m", 0.0, Range::not_negative(),
                               "gap between cells; on a map over `\"uv\"` a fraction of the map");
inline constexpr NumberKey margin("margin_m", 0.0, Range::not_negative(),
                                  "margin around the cells, in the same unit");
inline constexpr NumberKey temperature(
    "temperature_K", cell_temperatures_K,
    "temperature of cells and diodes in every run. The `saturation_A` of the diodes is valid at "
    "this temperature, or at 298.15 K if it is not given; it is independent of the temperature of "
    "the cells",
    {.usually = "the steady state of `[array.thermal]`, over time its balance; `diagnose` 298.15"});
inline constexpr NumberKey rated_temperature(
    "rated_temperature_K", ArrayDesign{}.rated_temperature_K, cell_temperatures_K,
    "rated temperature of the cells; warmer cells give a warning. 85 °C is the maximum of the "
    "thermal cycling test of modules (IEC 61215)");
inline constexpr TableKey thermal(
    "thermal", "heat balance of the cells, used if `temperature_K` is not given");
inline constexpr TableKey cell_parameters(
    "cell_parameters", "parameters that replace those of `cell`, for one reference area");
inline constexpr TablesKey cell_override(
    "cell_override",
    "a cell that differs from the others; its photocurrent has their temperature coefficient");
inline constexpr NumberKey quantum_efficiency_peak(
    "quantum_efficiency_peak", Range::fraction(),
    "largest external quantum efficiency, with the shape that belongs to `cell` (of silicon at "
    "800 nm); or `[array.quantum_efficiency]`",
    {.usually = "silicon 0.95, gallium arsenide 0.95, cadmium telluride 0.949"});
inline constexpr NumbersKey wavelength("wavelength_nm", Range::positive(),
                                       "wavelengths of the table, at least two, in rising order");
inline constexpr NumbersKey efficiency("efficiency", Range::fraction(),
                                       "electrons per photon at each wavelength");
inline constexpr TableKey quantum_efficiency("quantum_efficiency",
                                             "measured external quantum efficiency");
inline constexpr TableKey cover("cover", "cover glass, if the material of the cells has none",
                                {.usually = "none"});
inline constexpr TableKey back("back", "light on the back of bifacial cells");
inline constexpr TextKey back_receiver(
    "receiver",
    "irradiance map of the same node and grid with `side = \"back\"`; its light is treated "
    "as perpendicular to the cells");
inline constexpr NumberKey bifaciality(
    "bifaciality", 0.7, Range::fraction(),
    "short-circuit current by the light of the back over that by equal light of the front "
    "(IEC TS 60904-1-2): about 0.7 for PERC, 0.85 for TOPCon, 0.92 for heterojunction");
}  // namespace array_key

// Keys of read_array_design() and read_cell_places().
std::vector<Key> array_design_keys();
// Keys of read_trackers().
std::vector<Key> tracker_keys();
// Keys of read_cell_heat().
std::vector<Key> thermal_keys();
// Keys of read_day().
std::vector<Key> day_keys();

}  // namespace photorque
