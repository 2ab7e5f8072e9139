#include "photovoltaics/array/keys.h"

#include "core/constants.h"
#include "photovoltaics/array/day.h"
#include "photovoltaics/array/design.h"
#include "photovoltaics/array/tracker.h"

namespace photorque {
namespace {

constexpr int64_t most_cells = 100000;
constexpr Range efficiency{0.0, 1.0, true, false};

std::vector<Key> diode_keys(double drop_V) {
  const Diode usual;
  return {Key::number_or("drop_V", drop_V, Range::not_negative(),
                         "of an ideal diode, which as a bypass has one > 0"),
          Key::number_or("saturation_A", usual.saturation_A, Range::positive(), "of a junction"),
          Key::number_or("ideality", usual.ideality, Range::positive(), "of a junction"),
          Key::number_or("series_ohm", usual.series_ohm, series_ohm_range, "of a junction")};
}

Key diode_key(const std::string& name, size_t usual, const std::string& what) {
  return Key::choice_or(name,
                        {{"none", "none"},
                         {"ideal", "no current back, exactly `drop_V` on"},
                         {"junction", "an exponential with a series resistance"}},
                        usual, what);
}

std::vector<Key> cell_keys(const char* usual) {
  const auto replaced = [usual](const char* name, Range range, const char* what) {
    return Key::number(name, range, what).usually_is(usual);
  };
  return {replaced("saturation_1_A", Range::not_negative(), "I₁; not both I₁ and I₂ are 0"),
          replaced("saturation_2_A", Range::not_negative(), "I₂"),
          replaced("ideality_1", Range::positive(), "n₁"),
          replaced("ideality_2", Range::positive(), "n₂"),
          replaced("series_ohm", series_ohm_range, "R_s"),
          replaced("shunt_ohm", Range::positive(), "R_sh"),
          replaced("breakdown_fraction", {0.0, 7.0}, "a; 0: no breakdown"),
          replaced("breakdown_V", {-1e308, 0.0, false, true}, "V_br"),
          replaced("breakdown_exponent", {1.0, 1e3}, "m"),
          replaced("gap_eV", Range::positive(), "E₀"),
          replaced("gap_slope_per_K", {}, "s in E = E₀ (1 + s (T − T₀))"),
          replaced("photocurrent_slope_per_K", {}, "fraction per kelvin; about 4e-4 in sunlight")};
}

std::vector<Key> all_cells_keys() {
  constexpr const char* usual = "that of `cell`";
  return joined(
      {{Key::number("reference_area_m2", Range::positive(),
                    "the area that the others belong to; required beside currents and resistances")
            .usually_is(usual),
        Key::number("reference_temperature_K", Range::positive(), "and the temperature")
            .usually_is(usual)},
       cell_keys(usual)});
}

std::vector<Key> one_cell_keys() {
  constexpr const char* usual = "that of the others";
  return joined(
      {{Key::integer("index", 0, most_cells - 1, "row · columns + column").range_that_varies(),
        Key::number_or("photocurrent_factor", 1.0, {0.0, 1e6, false, false},
                       "of what its light would give"),
        Key::number("reference_area_m2", Range::positive(),
                    "the area that the currents and resistances of this table belong to; "
                    "required beside them where the others' is not stated")
            .usually_is(usual)},
       cell_keys(usual)});
}

std::vector<Key> cover_keys() {
  const CellFront usual;
  return {
      Key::number_or("refractive_index", usual.index, {1.0, 10.0}, "of the glass over the cells"),
      Key::number("coating_index", {1.0, 10.0},
                  "of a film on it, for the mean wavelength of each band; with the next")
          .usually_is("no film"),
      Key::number("coating_thickness_m", Range::positive(), "of that film").optional(),
      Key::numbers("angle_deg", {0.0, 0.5 * pi},
                   "instead of these: angles of incidence, from 0, rising")
          .optional(),
      Key::numbers("transmittance", Range::fraction(), "T at each of them; only ratios count")
          .optional(),
      Key::flag_or(
          "cosine_twice", false,
          "instead of all these, T = cos θ: the light on the cells, which holds the cosine "
          "already, counts with it once more; for the paper's figures "
          "([paper.md](paper.md)), not for cells")};
}

std::vector<Key> wiring_keys() {
  return {
      Key::choice_or("series", words({"columns", "rows"}), 0,
                     "serpentine in which cells follow each other"),
      Key::integer_or("strings", 1, 1, most_cells,
                      "equal parts of the serpentine, in parallel; divides the cells")
          .range_that_varies(),
      Key::integer("bypass_every", 1, most_cells,
                   "cells per bypass diode, at most those of a string, the last group shorter")
          .usually_is("a whole string")
          .range_that_varies(),
      Key::flag_or("cross_tied", false, "ties cells of equal place in all strings"),
      Key::other("wiring", Key::an_array,
                 "instead of the four keys above: `[string, …]`, a string `[substring, …]` with "
                 "a bypass diode each, a substring `[cell, …]`, each cell at most once; "
                 "`[cell, …]` in place of a cell is a row tied in parallel")
          .optional(),
      diode_key("bypass", 1, "the diode over every substring"),
      diode_key("blocking", 0, "the diode in every string"),
      Key::table("bypass_diode", diode_keys(0.5), "what the bypass diodes are").optional(),
      Key::table("blocking_diode", diode_keys(0.0), "what the blocking diodes are").optional()};
}

std::vector<Key> place_keys() {
  return {
      Key::other("cells", Key::an_array | Key::a_text,
                 "[columns, rows], at most 100000, along u and v of the map: cell number = row · "
                 "columns + column, from 0; or `\"mesh\"`: every connected piece of the surface "
                 "under the map is a cell (triangles that share an edge, on one instance of a "
                 "mesh); the receiver's node holds the cells alone. A lattice is numbered as "
                 "above; others stand in one row in their order, with their centres in "
                 "`cells.csv`"),
      Key::tables("rectangle",
                  {Key::numbers("low_m", {}, "[u, v] of its lower corner").of_size(2),
                   Key::numbers("high_m", {}, "[u, v] of its upper corner").of_size(2)},
                  "one per cell, instead of `cells`, anywhere on the map (in the coordinates of "
                  "the irradiance map; on a map over `\"uv\"` those)")
          .that_completes(),
      Key::number_or("gap_m", 0.0, Range::not_negative(),
                     "between cells; on a map over `\"uv\"` a fraction of it"),
      Key::number_or("margin_m", 0.0, Range::not_negative(), "around them, likewise")};
}

}  // namespace

std::vector<Key> array_design_keys() {
  std::vector<Key::Choice> cells;
  for (const NamedCell& cell : known_cells()) cells.push_back({cell.name, cell.summary});
  const ArrayDesign usual;
  return joined(
      {place_keys(),
       wiring_keys(),
       {Key::number_or("temperature_K", usual.temperature_K, {1.0, 1000.0},
                       "of cells and diodes; the diodes' `saturation_A` is the one at this "
                       "temperature, and warmer cells (`[array.day]`, \"temperature +10 K\") leave "
                       "the diodes as they are"),
        Key::choice_or("cell", std::move(cells), 1, "what the cells are"),
        Key::table("cell_parameters", all_cells_keys(),
                   "single numbers of it replaced, for one area"),
        Key::tables("cell_override", one_cell_keys(),
                    "a cell that differs from the others; where cells are warmed (`[array.day]`, "
                    "`supply`, \"temperature +10 K\") its photocurrent grows as theirs"),
        Key::number_or("quantum_efficiency_peak", 0.95, Range::fraction(),
                       "of the default shape, at 800 nm; or `[array.quantum_efficiency]`"),
        Key::table("quantum_efficiency",
                   {Key::numbers("wavelength_nm", Range::positive(), "at least two, rising"),
                    Key::numbers("efficiency", Range::fraction(), "electrons per photon at each")},
                   "as measured"),
        Key::table("cover", cover_keys(), "the glass over the cells, where their material has none")
            .usually_is("none")}});
}

std::vector<Key> tracker_keys() {
  const Tracker usual;
  return {
      Key::texts("kinds",
                 "of `\"perturb_and_observe\"`, `\"incremental_conductance\"`, "
                 "`\"global_scan\"`, `\"periodic_sweep\"`; the first counts in the losses")
          .usually_is("all four"),
      Key::number_or("period_s", usual.period_s, Range::positive(), "between decisions"),
      Key::number_or("step_fraction", usual.step_fraction, {0.0, 0.5, true, false},
                     "step, of the range of voltages"),
      Key::number_or("start_fraction", usual.start_fraction, efficiency,
                     "where those begin that do not scan"),
      Key::integer_or("sweep_points", usual.sweep_points, 2, 10000, "of a sweep, one period each"),
      Key::number_or("sweep_every_s", usual.sweep_every_s, Range::positive(),
                     "of `periodic_sweep`"),
      Key::number_or("rescan_fraction", usual.rescan_fraction, Range::positive(),
                     "of `global_scan`: change of power that starts a sweep")};
}

std::vector<Key> day_keys() {
  constexpr double year_s = 366.0 * 86400.0;
  const DaySettings usual;
  const CellHeat heat;
  return {
      Key::number_or("load_W", usual.load_W, Range::not_negative(), "what is drawn all the time"),
      Key::number_or("duration_s", usual.duration_s, {0.0, year_s, true, false},
                     "in steps of at most 30 s"),
      Key::flag_or("lamps_on", true, "false: the battery alone"),
      Key::number_or("battery_Wh", usual.battery.capacity_J, Range::positive(), "capacity"),
      Key::number_or("battery_charge", usual.battery.charge, Range::fraction(), "at the start"),
      Key::number_or("charge_efficiency", usual.battery.charge_efficiency, efficiency,
                     "stored over delivered to it"),
      Key::number_or("discharge_efficiency", usual.battery.discharge_efficiency, efficiency,
                     "delivered over taken out of store"),
      Key::number_or("converter_efficiency", usual.converter_efficiency, efficiency,
                     "between array and battery; not that of `[array.chain]`"),
      Key::number_or("droop_depth", usual.droop.depth, {0.0, 1.0, false, true},
                     "fraction of their light that lamps lose when warm"),
      Key::number_or("droop_time_s", usual.droop.time_constant_s, Range::positive(),
                     "within this time constant"),
      Key::number_or("roll_off_per_K", usual.droop.roll_off_1_K, {0.0, 0.1},
                     "fraction of their light that lamps lose per kelvin of their junctions (red "
                     "LEDs about 5e-3)"),
      Key::number_or("lamp_rise_K", usual.droop.rise_K, {0.0, 300.0},
                     "how much warmer the junctions become"),
      Key::number_or("lamp_rise_time_s", usual.droop.rise_time_constant_s, Range::positive(),
                     "within this time constant"),
      Key::flag_or("heat", true,
                   "cell temperature from the light, beginning at `air_K`; false: "
                   "`array.temperature_K`, and the four keys below are unknown"),
      Key::number_or("air_K", heat.air_K, Range::positive(), "of the room"),
      Key::number_or("convection_W_m2_K", heat.convection_W_m2_K, Range::positive(),
                     "both faces and radiation, per area of the cells"),
      Key::number_or("absorptance", heat.absorptance, Range::fraction(),
                     "of the light on the cells; at least what they deliver"),
      Key::number_or("capacity_J_m2_K", heat.capacity_J_m2_K, Range::positive(),
                     "about 1 mm of glass")};
}

}  // namespace photorque
