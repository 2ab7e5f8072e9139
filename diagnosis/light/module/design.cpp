#include "diagnosis/light/module/design.h"

#include "photovoltaics/fit/rated_keys.h"

namespace photorque {
namespace {

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

void read_effect(const Settings& s, ModuleDesign& design) {
  const std::vector<std::string> kinds = {"cell_shaded",   "cell_cracked",      "cell_shunted",
                                          "shunt",         "series_resistance", "temperature",
                                          "bypass_shorted"};
  const size_t kind = s.choice("kind", kinds);
  const auto count = [&] { return static_cast<int>(s.integer_or("count", 1, 1, design.cells)); };
  const auto resistance = [&] { return s.number("resistance_ohm", Range::positive()); };
  ModuleState& state = design.acting;
  switch (kind) {
    case 0:
      state.shaded.push_back({count(), s.number("factor", Range::fraction()),
                              s.number_or("breakdown_fraction", 0.0, {0.0, 7.0}),
                              s.number_or("breakdown_V", -15.0, {-1e308, 0.0, false, true}),
                              s.number_or("breakdown_exponent", 3.0, {1.0, 1e3})});
      break;
    case 1:
      state.cracked.push_back(
          {count(), s.number("fraction", {0.0, 1.0, true, true}), resistance()});
      break;
    case 2:
      state.shunted.push_back({1, 1.0 / resistance()});
      break;
    case 3:
      state.shunt_S += 1.0 / resistance();
      break;
    case 4:
      state.series_ohm += resistance();
      break;
    case 5:
      design.warmer_K += s.number("change_K", {-150.0, 150.0});
      break;
    default:
      state.bypassed += design.bypass_every;
  }
  if (s.has("count_between")) s.text("count_between");
  s.finish();
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
      design.datasheet.push_back(read_rated_point(point));
      point.finish();
    }
    design.slopes = read_rated_slopes(s);
  }
  read_temperatures(s, design);
  if (s.has("current_noise_A")) {
    design.current_noise_A = s.number("current_noise_A", Range::positive());
  }
  design.voltage_noise_V = s.number_or("voltage_noise_V", 0.0, Range::not_negative());
  s.finish();
  if (root.has("effect")) {
    for (const Settings& effect : root.tables("effect")) read_effect(effect, design);
  }
  return design;
}

}  // namespace photorque
