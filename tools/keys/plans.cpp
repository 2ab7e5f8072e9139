// [fit].
#include "photovoltaics/fit/rated_keys.h"
#include "tools/keys/tables.h"

namespace photorque {

Key fit_table() {
  const auto rounding = [](const char* name, const char* what) {
    return Key::number(name, Range::not_negative(), what)
        .usually_is("the last decimal that any of them has");
  };
  return Key::table(
      "fit",
      joined(
          {{Key::texts("curves",
                       "files of `voltage_V,current_A` (or `V,I`); several are repeats "
                       "under the same light; *or*")
                .optional(),
            Key::tables("datasheet", rated_point_keys(),
                        "one to several points at one temperature"),
            Key::integer_or("cells_in_series", 1, 1, 2000, "of the device"),
            Key::number_or("temperature_K", 298.15, {1.0, 1000.0},
                           "of the curves; with a datasheet it belongs to each of its points")},
           rated_slope_keys(),
           {rounding("rounding_A", "step of a datasheet's currents"),
            rounding("rounding_V", "step of its voltages"),
            Key::number_or("tolerance", 0.0, {0.0, 0.5},
                           "a fraction of every figure of it, one sigma"),
            Key::number_or("current_noise", 1e-3, {1e-12, 1.0},
                           "of curves: fraction of each reading (with `substrings`, of the "
                           "short-circuit current)"),
            Key::number_or("voltage_noise", 5e-4, {1e-12, 1.0}, "fraction of each reading"),
            Key::number_or("correlation_points", 0.0, Range::not_negative(),
                           "readings over which the noise of the current falls off (slow drift of "
                           "the light)"),
            Key::integer_or(
                "substrings", 0, 0, 100,
                "instead: one curve of a partly shaded string; 0: a whole string in even "
                "light"),
            Key::flag_or("even_voltage_steps", false,
                         "repeats of one even ramp: averages the noise of the voltages away")}}),
      "parameters of cells from measurements");
}

}  // namespace photorque
