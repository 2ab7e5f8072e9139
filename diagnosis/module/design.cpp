#include "diagnosis/module/design.h"

namespace photorque {
namespace {

RatedPoint rated_point(const Settings& s) {
  return {s.number_or("irradiance_W_m2", 1000.0, Range::positive()),
          s.number_or("temperature_K", 298.15, {1.0, 1000.0}),
          s.number("short_circuit_A", Range::positive()),
          s.number("open_circuit_V", Range::positive()),
          s.number("maximum_A", Range::positive()),
          s.number("maximum_V", Range::positive())};
}

void read_temperatures(const Settings& s, ModuleDesign& design) {
  const double usual_K = design.datasheet.empty() ? 298.15 : design.datasheet.front().temperature_K;
  design.reference_temperature_K = s.number_or("reference_temperature_K", usual_K, {1.0, 1000.0});
  design.temperature_K = design.reference_temperature_K;
  if (s.has("temperature_K")) {
    const Uncertain stated = s.uncertain("temperature_K", {1.0, 1000.0});
    design.temperature_K = stated.value;
    if (stated.sigma > 0.0) design.temperature_sigma_K = stated.sigma;
  }
  design.temperature_sigma_K =
      s.number_or("temperature_sigma_K", design.temperature_sigma_K, Range::positive());
}

}  // namespace

ModuleDesign read_module(const Settings& root, const std::filesystem::path& folder) {
  const Settings s = root.table("module");
  ModuleDesign design;
  design.cells = static_cast<int>(s.integer("cells_in_series", 1, 10000));
  design.bypass_every = static_cast<int>(s.integer_or("bypass_every", 0, 0, design.cells));
  design.bypass_drop_V = s.number_or("bypass_drop_V", 0.5, Range::positive());
  if (s.has("reference_curve") == s.has("datasheet")) {
    throw s.error("reference_curve", s.has("datasheet") ? "a curve and a datasheet" : "neither",
                  "reference_curve = \"curve.csv\" or [[module.datasheet]]");
  }
  if (s.has("reference_curve")) {
    const bool is_list = s.raw("reference_curve").is_array();
    const std::vector<std::string> names =
        is_list ? s.texts("reference_curve") : std::vector{s.text("reference_curve")};
    if (names.empty()) throw s.error("reference_curve", "an empty list", "at least one curve");
    for (const std::string& name : names) {
      design.reference_files.push_back(folder / name);
      design.references.push_back(read_light_recording(design.reference_files.back(), {}));
      if (design.references.back().kind != LightRecording::Kind::sweep) {
        throw s.error("reference_curve", "\"" + name + "\"", "a file of voltage_V,current_A");
      }
    }
  } else {
    for (const Settings& point : s.tables("datasheet")) {
      design.datasheet.push_back(rated_point(point));
      point.finish();
    }
    design.slopes.short_circuit_1_K = s.number_or("short_circuit_slope_per_K", 5e-4);
    design.slopes.open_circuit_1_K = s.number_or("open_circuit_slope_per_K", -3e-3);
  }
  read_temperatures(s, design);
  if (s.has("current_noise_A")) {
    design.current_noise_A = s.number("current_noise_A", Range::positive());
  }
  design.voltage_noise_V = s.number_or("voltage_noise_V", 0.0, Range::not_negative());
  s.finish();
  return design;
}

}  // namespace photorque
