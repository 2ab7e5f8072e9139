// The module in sunlight of an experiment: its cells, and the nominal values of the undamaged
// module.
//
// Files may contain cell_temperature_K and irradiance_W_m2 for each curve (`sweep`), which then
// replace these keys. The irradiance may differ from curve to curve. [[effect]] with the kinds and
// keys of a diagnosis states known effects on the recordings, and not on the references; with the
// key `curve` on the curve of that name alone ("day.csv, sweep 6").
#pragma once

#include <map>
#include <optional>

#include "core/settings/keys.h"
#include "core/settings/settings.h"
#include "diagnosis/light/model/recording.h"
#include "diagnosis/light/module/curve.h"
#include "photovoltaics/fit/fit.h"

namespace photorque {

struct ModuleActing {
  ModuleState state;  // without light and temperature
  double warmer_K = 0.0;
};

struct ModuleDesign : ModuleWiring {
  std::vector<std::filesystem::path> reference_files;
  std::vector<LightRecording> references;  // one per curve
  std::vector<std::string> notes;          // on the references, for the user
  // For each reference. If empty, all have reference_temperature_K, and their light is not
  // measured.
  std::vector<double> reference_temperatures_K, reference_irradiances_W_m2;
  std::vector<RatedPoint> datasheet;
  TemperatureSlopes slopes;
  double reference_temperature_K = 298.15;
  double temperature_K = 298.15, temperature_sigma_K = 2.0;
  std::optional<double> current_noise_A;
  double voltage_noise_V = 0.0;  // 0: a ten-thousandth of the open-circuit voltage
  // Effects on the recordings by name of the curve; "" applies to all.
  std::map<std::string, ModuleActing> acting;
  RecordingOptions reading;  // of all files: [recording]
};

// All effects on a curve, whose name may include folders.
ModuleActing acting_on(const ModuleDesign& design, const std::string& curve);

// Reads [module] of an experiment whose files are in `folder`. Throws InputError for bad keys.
ModuleDesign read_module(const Settings& root, const std::filesystem::path& folder);

// Keys of [module] and its effects.
Key module_table();
// The kinds of [[effect]] on a module, with their keys.
std::vector<Key::Choice> module_effects();

}  // namespace photorque
