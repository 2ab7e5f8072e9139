// What an experiment says about a module in sunlight: its cells, and what is known of it as it was.
//
//   [module]
//   cells_in_series = 96
//   bypass_every = 32                cells under one bypass diode; default: none
//   bypass_drop_V = 0.5
//   reference_curve = "before.csv"   or a list of them: the nominal module, or
//   [[module.datasheet]]             its datasheet, with the keys of fit-cell
//   reference_temperature_K = 298.15 of the first reference
//   temperature_K = 298.15           of the recordings, the reference's by default; {value, sigma}
//   temperature_sigma_K = 2          how well that is known, of references as well
//   current_noise_A, voltage_noise_V errors of a reading; found from the curves where not stated
//
// The irradiance may differ from curve to curve. [[effect]] with the kinds and keys of a diagnosis
// states what is known to act on the recordings, and not on the references.
#pragma once

#include <optional>

#include "core/settings/keys.h"
#include "core/settings/settings.h"
#include "diagnosis/light/model/recording.h"
#include "diagnosis/light/module/curve.h"
#include "photovoltaics/fit/fit.h"

namespace photorque {

struct ModuleDesign {
  int cells = 1;
  int bypass_every = 0;  // 0: no bypass diodes
  double bypass_drop_V = 0.5;
  std::vector<std::filesystem::path> reference_files;
  std::vector<LightRecording> references;
  std::vector<RatedPoint> datasheet;
  TemperatureSlopes slopes;
  double reference_temperature_K = 298.15;
  double temperature_K = 298.15, temperature_sigma_K = 2.0;
  std::optional<double> current_noise_A;
  double voltage_noise_V = 0.0;  // 0: a ten-thousandth of the open-circuit voltage
  ModuleState acting;            // on the recordings; light and temperature aside
  double warmer_K = 0.0;
};

// Reads [module] of an experiment whose files stand in `folder`. InputError for bad keys.
ModuleDesign read_module(const Settings& root, const std::filesystem::path& folder);

// [module] and its effects as they are declared.
Key module_table();
// The kinds of [[effect]] on a module, with their keys.
std::vector<Key::Choice> module_effects();

}  // namespace photorque
