#include "diagnosis/light/module/design.h"

#include "photovoltaics/fit/rated_keys.h"

namespace photorque {
namespace {

constexpr int64_t most_cells = 10000;

Key resistance_key(const std::string& what) {
  return Key::number("resistance_ohm", Range::positive(), what);
}

Key count_key() {
  return Key::integer_or("count", 1, 1, most_cells, "of the cells, at most all")
      .range_that_varies();
}

// Reverse conduction of shaded and cracked cells.
std::vector<Key> breakdown_keys() {
  return {
      Key::number_or("breakdown_fraction", 0.0, {0.0, 7.0}, "parameter a of the reverse breakdown"),
      Key::number_or("breakdown_V", -15.0, {-1e308, 0.0, false, true},
                     "parameter V_br of the reverse breakdown"),
      Key::number_or("breakdown_exponent", 3.0, {1.0, 1e3},
                     "parameter m of the reverse breakdown")};
}

}  // namespace

Key module_table() {
  return Key::table(
      "module",
      joined({{Key::integer("cells_in_series", 1, most_cells, "of the module"),
               Key::integer_or("bypass_every", 0, 0, most_cells,
                               "cells per bypass diode, at most all; 0: no diodes")
                   .range_that_varies(),
               Key::number_or("bypass_drop_V", 0.5, Range::positive(), "of a bypass diode"),
               Key::other("reference_curve", Key::a_text | Key::an_array,
                          "curves of the module before the fault, one file or several; *or* "
                          "`[[module.datasheet]]`")
                   .optional(),
               Key::tables("datasheet", rated_point_keys(), "the module as its maker rates it")},
              rated_slope_keys(),
              {Key::other("reference_temperature_K", Key::a_number | Key::an_array,
                          "of the references, one for all or one for each")
                   .usually_is("298.15, or the first of the datasheet"),
               Key::other("reference_irradiance_W_m2", Key::a_number | Key::an_array,
                          "measured by a sensor at the references, likewise")
                   .optional(),
               Key::uncertain("temperature_K", {1.0, 1000.0}, "of the curves that are diagnosed")
                   .usually_is("as the references"),
               Key::number_or("temperature_sigma_K", 2.0, Range::positive(),
                              "standard error of the temperatures"),
               Key::number("current_noise_A", Range::positive(), "of a reading")
                   .usually_is("found from second differences"),
               Key::number_or("voltage_noise_V", 0.0, Range::not_negative(), "of a reading")}}),
      "a module in sunlight, whose curves are diagnosed");
}

std::vector<Key::Choice> module_effects() {
  std::vector<Key::Choice> kinds = {
      {"cell_shaded", "cells in the shade",
       joined({{count_key(), Key::number("factor", Range::fraction(), "of the light")},
               breakdown_keys()})},
      {"cell_cracked", "cells with a part that is connected only through a resistance",
       joined({{count_key(), Key::number("fraction", {0.0, 1.0, true, true}, "of the area"),
                resistance_key("in front of that part")},
               breakdown_keys()})},
      {"cell_shunted",
       "cells with a short cut",
       {count_key(), resistance_key("in parallel with each of the cells")}},
      {"shunt", "short cuts in every cell", {resistance_key("beside every cell")}},
      {"series_resistance", "a resistance in series", {resistance_key("of the module")}},
      {"temperature",
       "warmer or colder than stated",
       {Key::number("change_K", {-150.0, 150.0}, "temperature difference of all cells")}},
      {"bypass_shorted", "a bypass diode that conducts always", {}},
      {"bypass_open", "shaded cells whose bypass diode is open",
       joined({{count_key(), Key::number("factor", Range::fraction(), "of the light")},
               breakdown_keys()})},
      {"substring_shaded",
       "cells of whole bypass diodes in the shade",
       {Key::other("factor", Key::a_number | Key::an_array, "of the light, of each")}},
      {"unsteady_light",
       "light that changes while the voltage rises",
       {Key::number("change", {-1.0, 1.0}, "from the first point to the last"),
        Key::number_or("bend", 0.0, {-1.0, 1.0}, "at the ends over the middle, two thirds of")}}};
  for (Key::Choice& kind : kinds) {
    kind.keys.push_back(
        Key::text("curve", "the only curve on which the effect acts").usually_is("all curves"));
  }
  return kinds;
}

}  // namespace photorque
