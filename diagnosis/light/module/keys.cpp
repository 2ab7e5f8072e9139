#include "diagnosis/light/module/design.h"

#include "core/settings/typed_keys.h"
#include "photovoltaics/fit/rated_keys.h"

namespace photorque {
namespace {

constexpr int64_t most_cells = 10000;

Key resistance_key(const std::string& what) {
  return NumberKey("resistance_ohm", Range::positive(), what);
}

Key count_key() {
  return IntegerKey("count", 1, 1, most_cells, "of the cells, at most all", {.varies = true});
}

// Reverse conduction of shaded and cracked cells.
std::vector<Key> breakdown_keys() {
  return {NumberKey("breakdown_fraction", 0.0, {0.0, 7.0}, "a of the reverse conduction"),
          NumberKey("breakdown_V", -15.0, {-1e308, 0.0, false, true}, "V_br of it"),
          NumberKey("breakdown_exponent", 3.0, {1.0, 1e3}, "m of it")};
}

}  // namespace

Key module_table() {
  return Key::table(
      "module",
      joined(
          {{IntegerKey("cells_in_series", 1, most_cells, "of the module"),
            IntegerKey("bypass_every", 0, 0, most_cells,
                       "cells per bypass diode, at most all; 0: no diodes", {.varies = true}),
            NumberKey("bypass_drop_V", 0.5, Range::positive(), "of a bypass diode"),
            OtherKey("reference_curve", Key::a_text | Key::an_array,
                     "curves of the module as it was, one file or several; *or* "
                     "`[[module.datasheet]]`",
                     {.optional = true}),
            Key::tables("datasheet", rated_point_keys(), "the module as its maker rates it")},
           rated_slope_keys(),
           {OtherKey("reference_temperature_K", Key::a_number | Key::an_array,
                     "of the references, one for all or one for each",
                     {.usually = "298.15, or the first of the datasheet"}),
            OtherKey("reference_irradiance_W_m2", Key::a_number | Key::an_array,
                     "that a sensor saw at the references, likewise", {.optional = true}),
            UncertainNumberKey("temperature_K", {1.0, 1000.0}, "of the curves that are diagnosed",
                               {.usually = "as the references"}),
            NumberKey("temperature_sigma_K", 2.0, Range::positive(),
                      "how well temperatures are known"),
            NumberKey("current_noise_A", Range::positive(), "of a reading",
                      {.usually = "found from second differences"}),
            NumberKey("voltage_noise_V", 0.0, Range::not_negative(), "of a reading")}}),
      "a module in sunlight, whose curves are diagnosed");
}

std::vector<Key::Choice> module_effects() {
  std::vector<Key::Choice> kinds = {
      {"cell_shaded", "cells in the shade",
       joined({{count_key(), NumberKey("factor", Range::fraction(), "of the light")},
               breakdown_keys()})},
      {"cell_cracked", "cells of which a part is reached through a resistance alone",
       joined({{count_key(), NumberKey("fraction", {0.0, 1.0, true, true}, "of the area"),
                resistance_key("in front of that part")},
               breakdown_keys()})},
      {"cell_shunted",
       "cells with a short cut",
       {count_key(), resistance_key("beside each of the cells")}},
      {"shunt", "short cuts in every cell", {resistance_key("beside every cell")}},
      {"series_resistance", "a resistance in series", {resistance_key("of the module")}},
      {"temperature",
       "warmer or colder than stated",
       {NumberKey("change_K", {-150.0, 150.0}, "of all cells")}},
      {"bypass_shorted", "a bypass diode that conducts always", {}},
      {"bypass_open", "cells in the shade whose bypass diode is open",
       joined({{count_key(), NumberKey("factor", Range::fraction(), "of the light")},
               breakdown_keys()})},
      {"substring_shaded",
       "cells of whole bypass diodes in the shade",
       {OtherKey("factor", Key::a_number | Key::an_array, "of the light, of each")}},
      {"unsteady_light",
       "light that changes while the voltage rises",
       {NumberKey("change", {-1.0, 1.0}, "from the first point to the last"),
        NumberKey("bend", 0.0, {-1.0, 1.0}, "at the ends over the middle, two thirds of")}}};
  for (Key::Choice& kind : kinds) {
    kind.keys.push_back(
        TextKey("curve", "the only curve on which the effect acts", {.usually = "all curves"}));
  }
  return kinds;
}

}  // namespace photorque
