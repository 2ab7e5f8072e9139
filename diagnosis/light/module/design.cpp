#include "diagnosis/light/module/design.h"

#include <cmath>

#include "attitude/recordings/recording.h"
#include "photovoltaics/fit/rated_keys.h"

namespace photorque {
namespace {

// One number for all references, or one for each file; `files` is the file index of each. Values in
// the curves themselves have priority.
std::vector<double> of_references(const Settings& s, const std::string& key, double usual,
                                  const Range& range, const std::vector<size_t>& files,
                                  const std::vector<double>& said) {
  std::vector<double> stated;
  if (s.has(key)) {
    const size_t count = files.empty() ? 1 : files.back() + 1;
    stated = s.raw(key).is_array() ? s.numbers(key, range)
                                   : std::vector<double>(count, s.number(key, range));
    if (stated.size() != count) {
      throw s.error(key, std::to_string(stated.size()) + " numbers",
                    "one, or one for each of " + std::to_string(count) + " reference curves");
    }
  }
  std::vector<double> result;
  for (size_t i = 0; i < files.size(); ++i) {
    const double otherwise = stated.empty() ? usual : stated[files[i]];
    result.push_back(std::isfinite(said[i]) ? said[i] : otherwise);
  }
  if (files.empty()) result.push_back(stated.empty() ? usual : stated.front());
  return result;
}

void read_temperatures(const Settings& s, const std::vector<size_t>& files, ModuleDesign& design) {
  const double usual_K = design.datasheet.empty() ? 298.15 : design.datasheet.front().temperature_K;
  std::vector<double> said_K, said_W_m2;
  for (const LightRecording& r : design.references) {
    said_K.push_back(r.has_temperatures ? median_of(r.temperature_K) : NAN);
    said_W_m2.push_back(median_of(r.irradiance_W_m2));
  }
  design.reference_temperatures_K =
      of_references(s, "reference_temperature_K", usual_K, {1.0, 1000.0}, files, said_K);
  design.reference_irradiances_W_m2 =
      of_references(s, "reference_irradiance_W_m2", NAN, Range::positive(), files, said_W_m2);
  design.reference_temperature_K = design.reference_temperatures_K.front();
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
  const std::vector<std::string> kinds = {
      "cell_shaded", "cell_cracked",   "cell_shunted",     "shunt",          "series_resistance",
      "temperature", "bypass_shorted", "substring_shaded", "unsteady_light", "bypass_open"};
  const size_t kind = s.choice("kind", kinds);
  const auto count = [&] { return static_cast<int>(s.integer_or("count", 1, 1, design.cells)); };
  const auto resistance = [&] { return s.number("resistance_ohm", Range::positive()); };
  ModuleActing& acting = design.acting[s.has("curve") ? s.text("curve") : ""];
  ModuleState& state = acting.state;
  const auto breakdown = [&] {
    return ModuleState::Breakdown{s.number_or("breakdown_fraction", 0.0, {0.0, 7.0}),
                                  s.number_or("breakdown_V", -15.0, {-1e308, 0.0, false, true}),
                                  s.number_or("breakdown_exponent", 3.0, {1.0, 1e3})};
  };
  const auto require_diodes = [&](const char* found) {
    if (design.bypass_every > 0) return;
    throw s.error("kind", std::string(found) + " without bypass diodes",
                  "module.bypass_every, the cells of a substring");
  };
  switch (kind) {
    case 0:
      state.shaded.push_back({count(), s.number("factor", Range::fraction()), breakdown()});
      break;
    case 1:
      state.cracked.push_back(
          {count(), s.number("fraction", {0.0, 1.0, true, true}), resistance(), breakdown()});
      break;
    case 2:
      state.shunted.push_back({count(), 1.0 / resistance()});
      break;
    case 3:
      state.shunt_S += 1.0 / resistance();
      break;
    case 4:
      state.series_ohm += resistance();
      break;
    case 5:
      acting.warmer_K += s.number("change_K", {-150.0, 150.0});
      break;
    case 6:
      state.bypassed += design.bypass_every;
      break;
    case 7:
      require_diodes("\"substring_shaded\"");
      for (const double factor : s.raw("factor").is_array()
                                     ? s.numbers("factor", Range::fraction())
                                     : std::vector{s.number("factor", Range::fraction())}) {
        state.shaded.push_back({design.bypass_every, factor});
      }
      break;
    case 9:
      require_diodes("\"bypass_open\"");
      state.shaded.push_back({count(), s.number("factor", Range::fraction()), breakdown(), false});
      break;
    default:
      state.light_change += s.number("change", {-1.0, 1.0});
      state.light_bend += s.number_or("bend", 0.0, {-1.0, 1.0});
  }
  if (s.has("count_between")) s.text("count_between");
  s.finish();
}

}  // namespace

ModuleDesign read_module(const Settings& root, const std::filesystem::path& folder) {
  const Settings s = root.table("module");
  ModuleDesign design;
  if (root.has("recording")) {
    const Settings recording = root.table("recording");
    design.columns = read_recording_options(recording).columns;
    recording.finish();
  }
  design.cells = static_cast<int>(s.integer("cells_in_series", 1, 10000));
  design.bypass_every = static_cast<int>(s.integer_or("bypass_every", 0, 0, design.cells));
  design.bypass_drop_V = s.number_or("bypass_drop_V", 0.5, Range::positive());
  if (s.has("reference_curve") == s.has("datasheet")) {
    throw s.error("reference_curve", s.has("datasheet") ? "a curve and a datasheet" : "neither",
                  "reference_curve = \"curve.csv\" or [[module.datasheet]]");
  }
  std::vector<size_t> files;
  if (s.has("reference_curve")) {
    const bool is_list = s.raw("reference_curve").is_array();
    const std::vector<std::string> names =
        is_list ? s.texts("reference_curve") : std::vector{s.text("reference_curve")};
    if (names.empty()) throw s.error("reference_curve", "an empty list", "at least one curve");
    for (const std::string& name : names) {
      design.reference_files.push_back(folder / name);
      const LightRecording file =
          read_light_recording(design.reference_files.back(), {}, design.columns);
      if (file.kind != LightRecording::Kind::sweep) {
        throw s.error("reference_curve", "\"" + name + "\"", "a file of voltage_V,current_A");
      }
      for (LightRecording& curve : sweeps_of(file)) {
        design.references.push_back(std::move(curve));
        files.push_back(design.reference_files.size() - 1);
      }
    }
  } else {
    for (const Settings& point : s.tables("datasheet")) {
      design.datasheet.push_back(read_rated_point(point));
      point.finish();
    }
    design.slopes = read_rated_slopes(s);
  }
  read_temperatures(s, files, design);
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

ModuleActing acting_on(const ModuleDesign& design, const std::string& curve) {
  ModuleActing all;
  const std::string name = std::filesystem::path(curve).filename().string();
  const auto append = [](auto& to, const auto& more) {
    to.insert(to.end(), more.begin(), more.end());
  };
  for (const auto& [of, acting] : design.acting) {
    if (!of.empty() && of != name) continue;
    const ModuleState& more = acting.state;
    all.warmer_K += acting.warmer_K;
    all.state.series_ohm += more.series_ohm;
    all.state.shunt_S += more.shunt_S;
    all.state.bypassed += more.bypassed;
    all.state.light_change += more.light_change;
    all.state.light_bend += more.light_bend;
    append(all.state.shaded, more.shaded);
    append(all.state.cracked, more.cracked);
    append(all.state.shunted, more.shunted);
  }
  return all;
}

}  // namespace photorque
