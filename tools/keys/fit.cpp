#include "tools/keys/fit.h"

#include "photovoltaics/fit/rated_keys.h"

namespace photorque {

Key fit_table() {
  using namespace fit_key;
  return fit.of(joined({{curves, curve.of({curve_file, curve_irradiance, curve_temperature}),
                         datasheet.of(rated_point_keys()), module_file, module_name,
                         cells_in_series, temperature, shunt},
                        rated_slope_keys(),
                        {rounding_current, rounding_voltage, tolerance, current_noise,
                         voltage_noise, correlation_points, substrings, even_voltage_steps}}));
}

}  // namespace photorque
