#include "tools/keys/registry.h"

#include <set>
#include <string>

#include "attitude/camera/study.h"
#include "attitude/disturbances/kind.h"
#include "attitude/environment/environment.h"
#include "attitude/filtering/study.h"
#include "attitude/model/platform.h"
#include "attitude/propagation/run.h"
#include "attitude/recordings/sensors.h"
#include "attitude/studies/balance.h"
#include "attitude/studies/budget.h"
#include "diagnosis/light/model/lab.h"
#include "diagnosis/light/module/design.h"
#include "photovoltaics/fit/rated_keys.h"
#include "scenes/effects/stated.h"
#include "scenes/experiment/keys.h"
#include "tools/coupling/light_model.h"
#include "tools/keys/fit.h"
#include "tools/realtime/session.h"
#include "tools/runs/array_report.h"
#include "tools/supply/trade.h"
#include "tools/sweeps/plan.h"

namespace photorque {
namespace {

Key sensors_table() {
  return Key::table(
      "sensors", joined({sensor_keys(), light_sensor_keys()}),
      "without it an ideal camera and gyro are recorded; with it, only the instruments "
      "named");
}

Key effect_table() {
  std::vector<Key::Choice> kinds = light_effects();
  for (Key::Choice& of_module : module_effects()) add_choice(kinds, std::move(of_module));
  const auto result_key = [](const char* name, unsigned forms) {
    return OtherKey(name, forms, "additional result of a diagnosis; the commands ignore it",
                    {.optional = true});
  };
  return Key::tables(
      "effect",
      {Key::choice("kind", std::move(kinds), "kind of the effect").range_that_varies(),
       result_key("u_m", Key::a_number | Key::an_array),
       result_key("v_m", Key::a_number | Key::an_array), result_key("darkest", Key::a_number),
       result_key("count_between", Key::a_text)},
      "an effect on light or power, for example of a diagnosis");
}

// Marks every number of the table and its sub-tables as one that may have an error
// (scenes/experiment/uncertain.h).
Key with_errors(Key key) {
  const bool is_number = key.type == Key::Type::number || key.type == Key::Type::numbers ||
                         key.type == Key::Type::vector;
  key.has_error = key.has_error || is_number;
  for (Key& inner : key.keys) inner = with_errors(std::move(inner));
  for (Key::Choice& choice : key.choices) {
    for (Key& inner : choice.keys) inner = with_errors(std::move(inner));
  }
  return key;
}

// Marks the keys of an array that a diagnosis of light may vary; days, trackers and reports have no
// errors.
Key with_errors_of_cells(Key array) {
  static const std::set<std::string> known = {
      "temperature_K", "bypass_diode", "blocking_diode",     "cell_parameters",
      "cell_override", "cover",        "quantum_efficiency", "quantum_efficiency_peak"};
  for (Key& key : array.keys) {
    if (known.contains(key.name)) key = with_errors(std::move(key));
  }
  return array;
}

std::vector<Key> with_errors_of_lamps(std::vector<Key> tables) {
  for (Key& table : tables) {
    if (table.name == "source" || table.name == "attitude") table = with_errors(std::move(table));
  }
  return tables;
}

}  // namespace

Key fit_table() {
  using namespace fit_key;
  return fit_key::fit.of(
      joined({{curves, curve.of({curve_file, curve_irradiance, curve_temperature}),
               datasheet.of(rated_point_keys()), module_file, module_name, cells_in_series,
               temperature, shunt},
              rated_slope_keys(),
              {rounding_current, rounding_voltage, tolerance, current_noise, voltage_noise,
               correlation_points, substrings, even_voltage_steps}}));
}

std::vector<Key> experiment_keys() {
  return joined({with_errors_of_lamps(scene_tables()),
                 {with_errors_of_cells(array_table()), published_table(), effect_table(),
                  light_table(), platform_table(), environment_table(), disturbance_table(),
                  sensors_table(), propagate_table(), serve_table(), budget_table(),
                  balance_table(), recording_table(), estimate_table(), camera_study_table(),
                  supply_table(), sweep_table(), fit_table(), module_table()}});
}

}  // namespace photorque
