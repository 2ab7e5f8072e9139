// The keys of [array] that this room reads.
#pragma once

#include <vector>

#include "core/settings/typed_keys.h"
#include "photovoltaics/array/design.h"

namespace photorque {

// The greatest number of cells of an array.
inline constexpr int most_cells = 100000;

inline constexpr double bypass_drop_V = 0.5;
namespace diode_key {
inline constexpr Diode usual;
inline constexpr NumberKey drop("drop_V", bypass_drop_V, Range::not_negative(),
                                "of an ideal diode, which as a bypass has one > 0");
inline constexpr NumberKey saturation("saturation_A", usual.saturation_A, Range::positive(),
                                      "of a junction");
inline constexpr NumberKey ideality("ideality", usual.ideality, Range::positive(), "of a junction");
inline constexpr NumberKey series("series_ohm", usual.series_ohm, series_ohm_range,
                                  "of a junction");
}  // namespace diode_key

// Of the cells, in place of what they have; of all, and of one.
namespace cell_key {
inline constexpr NumberKey reference_area(
    "reference_area_m2", Range::positive(),
    "the area that the others belong to; required beside currents and resistances");
inline constexpr NumberKey reference_temperature("reference_temperature_K", Range::positive(),
                                                 "and the temperature");
inline constexpr NumberKey saturation_1("saturation_1_A", Range::not_negative(),
                                        "I₁; not both I₁ and I₂ are 0");
inline constexpr NumberKey saturation_2("saturation_2_A", Range::not_negative(), "I₂");
inline constexpr NumberKey ideality_1("ideality_1", Range{0.01, 100.0}, "n₁");
inline constexpr NumberKey ideality_2("ideality_2", Range{0.01, 100.0}, "n₂");
inline constexpr NumberKey series("series_ohm", series_ohm_range, "R_s");
inline constexpr NumberKey shunt("shunt_ohm", Range::positive(), "R_sh");
inline constexpr NumberKey shunt_photocurrent(
    "shunt_photocurrent_A", Range::not_negative(),
    "photocurrent at which the shunt is R_sh; at others it is inversely proportional to the "
    "photocurrent (De Soto, CEC). 0: R_sh in any light");
inline constexpr NumberKey shunt_dark("shunt_dark_ohm", Range::positive(),
                                      "with `shunt_photocurrent_A`: R_sh in the dark, to which it "
                                      "goes exponentially (PVsyst)");
inline constexpr NumberKey shunt_exponent("shunt_exponent", Range{0.01, 100.0},
                                          "with `shunt_dark_ohm`: c in e^(−c·light); PVsyst has "
                                          "5.5");
inline constexpr NumberKey breakdown_fraction("breakdown_fraction", {0.0, 7.0},
                                              "a; 0: no breakdown");
inline constexpr NumberKey breakdown("breakdown_V", {-1e308, 0.0, false, true}, "V_br");
inline constexpr NumberKey breakdown_exponent("breakdown_exponent", {1.0, 1e3}, "m");
inline constexpr NumberKey gap("gap_eV", Range::positive(), "E₀");
inline constexpr NumberKey gap_slope("gap_slope_per_K", {}, "s in E = E₀ (1 + s (T − T₀))");
inline constexpr NumberKey photocurrent_slope("photocurrent_slope_per_K", {},
                                              "fraction per kelvin; about 4e-4 in sunlight");
inline constexpr IntegerKey index("index", 0, most_cells - 1, "row · columns + column",
                                  {.varies = true});
inline constexpr NumberKey photocurrent_factor("photocurrent_factor", 1.0, {0.0, 1e6, false, false},
                                               "of what its light would give");
}  // namespace cell_key

namespace array_key {
inline constexpr Word diodes[] = {{"none", "none"},
                                  {"ideal", "no current back, exactly `drop_V` on"},
                                  {"junction", "an exponential with a series resistance"}};

inline constexpr ChoiceKey series("series", {"columns", "rows"}, 0,
                                  "serpentine in which cells follow each other");
inline constexpr IntegerKey strings("strings", 1, 1, most_cells,
                                    "equal parts of the serpentine, in parallel; divides the cells",
                                    {.varies = true});
inline constexpr IntegerKey bypass_every(
    "bypass_every", 1, most_cells,
    "cells per bypass diode, at most those of a string, the last group shorter",
    {.usually = "a whole string", .varies = true});
inline constexpr FlagKey cross_tied("cross_tied", false,
                                    "ties cells of equal place in all strings");
inline constexpr TextsKey circuit(
    "circuit",
    "instead of `strings`, `bypass_every` and `cross_tied`: the serpentine in equal parts, the "
    "outermost level first, as `\"series N\"` or `\"parallel N\"`; with `bypass` after it each of "
    "the N parts has a bypass diode. The numbers multiply to the number of cells. Half-cut: "
    "`[\"series 3 bypass\", \"parallel 2\", \"series 20\"]`",
    {.optional = true});
inline constexpr OtherKey wiring(
    "wiring", Key::an_array,
    "instead of the five keys above: `[string, …]`, a string `[substring, …]` with a "
    "bypass diode each, a substring `[cell, …]`, each cell at most once; `[cell, …]` in "
    "place of a cell is cells in parallel, a list in place of one of those is cells in series, "
    "and so on by turns; `\"bypass\"` at the head of such a list is a diode beside it",
    {.optional = true});
inline constexpr ChoiceKey bypass("bypass", diodes, 1, "the diode over every substring");
inline constexpr ChoiceKey blocking("blocking", diodes, 0, "the diode in every string");
inline constexpr TableKey bypass_diode("bypass_diode", "what the bypass diodes are");
inline constexpr TableKey blocking_diode("blocking_diode", "what the blocking diodes are");
inline constexpr OtherKey cells(
    "cells", Key::an_array | Key::a_text,
    "[columns, rows], at most 100000, along u and v of the map: cell number = row · columns + "
    "column, from 0; or `\"mesh\"`: every connected piece of the surface under the map is a cell "
    "(triangles that share an edge, on one instance of a mesh); the receiver's node holds the "
    "cells alone. A lattice is numbered as above; others stand in one row in their order, with "
    "their centres in `cells.csv`");
inline constexpr NumbersKey low("low_m", {}, "[u, v] of its lower corner", {.size = 2});
inline constexpr NumbersKey high("high_m", {}, "[u, v] of its upper corner", {.size = 2});
inline constexpr TablesKey rectangle(
    "rectangle",
    "one per cell, instead of `cells`, anywhere on the map (in the coordinates of the "
    "irradiance map; on a map over `\"uv\"` those)",
    {.completes = true});
inline constexpr NumberKey gap("gap_m", 0.0, Range::not_negative(),
                               "between cells; on a map over `\"uv\"` a fraction of it");
inline constexpr NumberKey margin("margin_m", 0.0, Range::not_negative(), "around them, likewise");
inline constexpr NumberKey temperature(
    "temperature_K", {1.0, 1000.0},
    "of cells and diodes, in every run; the diodes' `saturation_A` is the one at this temperature, "
    "or at 298.15 K, and does not change with that of the cells",
    {.usually = "the steady state of `[array.thermal]`, over time its balance; `diagnose` 298.15"});
inline constexpr NumberKey rated_temperature(
    "rated_temperature_K", ArrayDesign{}.rated_temperature_K, {1.0, 1000.0},
    "of the cells, above which there is a warning: 85 °C, the hot end of the thermal cycles that "
    "modules pass (IEC 61215)");
inline constexpr TableKey thermal(
    "thermal", "what the cells' temperature follows from, where `temperature_K` is not stated");
inline constexpr TableKey cell_parameters("cell_parameters",
                                          "single numbers of it replaced, for one area");
inline constexpr TablesKey cell_override(
    "cell_override",
    "a cell that differs from the others; its photocurrent grows with the temperature as theirs");
inline constexpr NumberKey quantum_efficiency_peak(
    "quantum_efficiency_peak", 0.95, Range::fraction(),
    "of the default shape, at 800 nm; or `[array.quantum_efficiency]`");
inline constexpr NumbersKey wavelength("wavelength_nm", Range::positive(), "at least two, rising");
inline constexpr NumbersKey efficiency("efficiency", Range::fraction(),
                                       "electrons per photon at each");
inline constexpr TableKey quantum_efficiency("quantum_efficiency", "as measured");
inline constexpr TableKey cover("cover", "the glass over the cells, where their material has none",
                                {.usually = "none"});
}  // namespace array_key

// read_array_design() and read_cell_places().
std::vector<Key> array_design_keys();
// read_trackers().
std::vector<Key> tracker_keys();
// read_cell_heat().
std::vector<Key> thermal_keys();
// read_day().
std::vector<Key> day_keys();

}  // namespace photorque
