#include "diagnosis/light/module/design.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "attitude/recordings/recording.h"
#include "core/settings/typed_keys.h"
#include "photovoltaics/fit/rated_keys.h"

namespace photorque {
namespace {

namespace module_key {
constexpr int64_t most_cells = 10000;
constexpr IntegerKey cells("cells_in_series", 1, most_cells,
                           "number of cells in series in the module");
constexpr IntegerKey bypass_every("bypass_every", 0, 0, most_cells,
                                  "cells per bypass diode, at most all; 0: no diodes",
                                  {.varies = true});
constexpr IntegerKey chains("chains", 1, 1, 100,
                            "number of chains of cells in parallel beside each bypass diode; "
                            "half-cut modules: 2. An effect on single cells acts in one of them");
constexpr NumberKey bypass_drop("bypass_drop_V", 0.5, Range::positive(),
                                "forward voltage of a bypass diode");
constexpr OtherKey reference_curve(
    "reference_curve", Key::a_text | Key::an_array,
    "curves of the module before the fault, one file or several; *or* "
    "`[[module.datasheet]]`",
    {.optional = true});
constexpr TablesKey datasheet("datasheet", "the module as its maker rates it");
constexpr Range temperatures_K{1.0, 1000.0};
constexpr OtherKey reference_temperature(
    "reference_temperature_K", Key::a_number | Key::an_array,
    "cell temperature of the references, one for all or one for each",
    {.usually = "298.15, or the first of the datasheet"});
constexpr OtherKey reference_irradiance(
    "reference_irradiance_W_m2", Key::a_number | Key::an_array,
    "irradiance of the references, measured by a sensor, one for all or one for each",
    {.optional = true});
constexpr UncertainNumberKey temperature("temperature_K", temperatures_K,
                                         "cell temperature of the curves that are diagnosed",
                                         {.usually = "as the references"});
constexpr NumberKey temperature_sigma("temperature_sigma_K", 2.0, Range::positive(),
                                      "standard error of the temperatures");
constexpr NumberKey current_noise("current_noise_A", Range::positive(),
                                  "standard deviation of a current reading",
                                  {.usually = "found from second differences"});
constexpr NumberKey voltage_noise("voltage_noise_V", 0.0, Range::not_negative(),
                                  "standard deviation of a voltage reading");
constexpr TableKey table("module", "a module in sunlight, whose curves are diagnosed");
}  // namespace module_key

// Kinds of [[effect]] on a module.
namespace effect_key {
enum Kind : size_t {
  cell_shaded,
  cell_cracked,
  cell_shunted,
  shunt,
  series_resistance,
  temperature,
  bypass_shorted,
  bypass_open,
  substring_shaded,
  unsteady_light
};
constexpr ChoiceKey kind("kind",
                         {{"cell_shaded", "cells in the shade"},
                          {"cell_cracked",
                           "cells with a part that is connected only through a resistance"},
                          {"cell_shunted", "cells with a leakage path (shunt)"},
                          {"shunt", "short cuts in every cell"},
                          {"series_resistance", "a resistance in series"},
                          {"temperature", "the cells are warmer or colder than stated"},
                          {"bypass_shorted", "a bypass diode that conducts always"},
                          {"bypass_open", "shaded cells whose bypass diode is open"},
                          {"substring_shaded", "cells of whole bypass diodes in the shade"},
                          {"unsteady_light", "light that changes while the voltage rises"}},
                         "the effect");
constexpr IntegerKey count("count", 1, 1, module_key::most_cells, "number of affected cells",
                           {.varies = true});
constexpr NumberKey factor("factor", Range::fraction(),
                           "fraction of the light that the cells receive");
constexpr OtherKey factors("factor", Key::a_number | Key::an_array,
                           "fraction of the light that each group of cells receives");
constexpr NumberKey fraction("fraction", {0.0, 1.0, true, true},
                             "fraction of the area of a cell that is behind the resistance");
constexpr NumberKey resistance("resistance_ohm", Range::positive(), "of the module");
constexpr NumberKey change_of_temperature("change_K", {-150.0, 150.0},
                                          "temperature difference of all cells");
constexpr NumberKey change("change", {-1.0, 1.0},
                           "relative change of the light from the first point to the last");
constexpr NumberKey bend("bend", 0.0, {-1.0, 1.0},
                         "coefficient b of a curvature b (6u² − 6u + 1) of the light, u from 0 at "
                         "the first point to 1 at the last");
constexpr TextKey curve("curve", "the only curve on which the effect acts",
                        {.usually = "all curves"});
// Reverse conduction of shaded and cracked cells.
constexpr NumberKey breakdown_fraction("breakdown_fraction", 0.0, {0.0, 7.0},
                                       "parameter a of the reverse breakdown");
constexpr NumberKey breakdown("breakdown_V", -15.0, {-1e308, 0.0, false, true},
                              "parameter V_br of the reverse breakdown");
constexpr NumberKey breakdown_exponent("breakdown_exponent", 3.0, {1.0, 1e3},
                                       "parameter m of the reverse breakdown");
constexpr NumberKey leak("leak", 1.0, Range::positive(),
                         "shunt conductance of these cells relative to that of the others");
}  // namespace effect_key

// Values for the references: one number for all, or one for each file. `files` is the file index of
// each reference. Values in the recordings (`recorded`) have priority.
std::vector<double> of_references(const Settings& s, const OtherKey& key, double usual,
                                  const Range& range, const std::vector<size_t>& files,
                                  const std::vector<double>& recorded) {
  std::vector<double> stated;
  if (s.has(key)) {
    const size_t count = files.empty() ? 1 : files.back() + 1;
    stated = s.get(key).is_array() ? s.numbers(key, range)
                                   : std::vector<double>(count, s.number(key, range));
    if (stated.size() != count) {
      throw s.error(key, std::to_string(stated.size()) + " numbers",
                    "one, or one for each of " + std::to_string(count) + " reference curves");
    }
  }
  std::vector<double> result;
  for (size_t i = 0; i < files.size(); ++i) {
    const double otherwise = stated.empty() ? usual : stated[files[i]];
    result.push_back(std::isfinite(recorded[i]) ? recorded[i] : otherwise);
  }
  if (files.empty()) result.push_back(stated.empty() ? usual : stated.front());
  return result;
}

void read_temperatures(const Settings& s, const std::vector<size_t>& files, ModuleDesign& design) {
  const double usual_K = design.datasheet.empty() ? 298.15 : design.datasheet.front().temperature_K;
  std::vector<double> recorded_K, recorded_W_m2;
  for (const LightRecording& r : design.references) {
    recorded_K.push_back(r.has_temperatures ? median_of(r.temperature_K) : NAN);
    recorded_W_m2.push_back(median_of(r.irradiance_W_m2));
  }
  design.reference_temperatures_K = of_references(s, module_key::reference_temperature, usual_K,
                                                  module_key::temperatures_K, files, recorded_K);
  design.reference_irradiances_W_m2 = of_references(s, module_key::reference_irradiance, NAN,
                                                    Range::positive(), files, recorded_W_m2);
  design.reference_temperature_K = design.reference_temperatures_K.front();
  design.temperature_K = design.reference_temperature_K;
  if (s.has(module_key::temperature)) {
    const Uncertain stated = s.get(module_key::temperature);
    design.temperature_K = stated.value;
    if (stated.sigma > 0.0) design.temperature_sigma_K = stated.sigma;
  }
  design.temperature_sigma_K =
      s.get(module_key::temperature_sigma.with_default(design.temperature_sigma_K));
}

void read_effect(const Settings& s, ModuleDesign& design) {
  using namespace effect_key;
  const size_t of_kind = s.get(kind);
  const auto cells = [&] { return static_cast<int>(s.get(count.within(1, design.cells))); };
  ModuleActing& acting = design.acting[s.has(curve) ? s.get(curve) : ""];
  ModuleState& state = acting.state;
  const auto reverse = [&] {
    return ModuleState::Breakdown{s.get(breakdown_fraction), s.get(breakdown),
                                  s.get(breakdown_exponent)};
  };
  const auto require_diodes = [&](const char* found) {
    if (design.bypass_every > 0) return;
    throw s.error(kind, std::string(found) + " without bypass diodes",
                  "module.bypass_every, the cells of a substring");
  };
  switch (of_kind) {
    case cell_shaded:
      state.shaded.push_back({cells(), s.get(factor), reverse(), true, false, s.get(leak)});
      break;
    case cell_cracked:
      state.cracked.push_back(
          {cells(), s.get(fraction), s.get(resistance), reverse(), s.get(leak)});
      break;
    case cell_shunted:
      state.shunted.push_back({cells(), 1.0 / s.get(resistance)});
      break;
    case shunt:
      state.shunt_S += 1.0 / s.get(resistance);
      break;
    case series_resistance:
      state.series_ohm += s.get(resistance);
      break;
    case temperature:
      acting.warmer_K += s.get(change_of_temperature);
      break;
    case bypass_shorted:
      state.bypassed += design.bypass_every;
      break;
    case bypass_open:
      require_diodes("\"bypass_open\"");
      state.shaded.push_back({cells(), s.get(factor), reverse(), false, false, s.get(leak)});
      break;
    case substring_shaded:
      require_diodes("\"substring_shaded\"");
      for (const double one : s.get(factors).is_array() ? s.numbers(factors, factor.range)
                                                        : std::vector{s.get(factor)}) {
        state.shaded.push_back(
            {.count = design.bypass_every, .factor = one, .in_all_chains = true});
      }
      break;
    default:
      state.light_change += s.get(change);
      state.light_bend += s.get(bend);
  }
  if (s.has("count_between")) s.text("count_between");
  s.finish();
}

}  // namespace

ModuleDesign read_module(const Settings& root, const std::filesystem::path& folder) {
  const Settings s = root.get(module_key::table);
  ModuleDesign design;
  if (root.has("recording")) {
    const Settings recording = root.table("recording");
    design.reading = read_recording_options(recording);
    recording.finish();
  }
  design.cells = static_cast<int>(s.get(module_key::cells));
  design.bypass_every = static_cast<int>(s.get(module_key::bypass_every.within(0, design.cells)));
  design.bypass_drop_V = s.get(module_key::bypass_drop);
  design.chains = static_cast<int>(s.get(module_key::chains));
  if (s.has(module_key::reference_curve) == s.has(module_key::datasheet)) {
    throw s.error(module_key::reference_curve,
                  s.has(module_key::datasheet) ? "a curve and a datasheet" : "neither",
                  "reference_curve = \"curve.csv\" or [[module.datasheet]]");
  }
  std::vector<size_t> files;
  if (s.has(module_key::reference_curve)) {
    const bool is_list = s.get(module_key::reference_curve).is_array();
    const std::vector<std::string> names = is_list
                                               ? s.texts(module_key::reference_curve)
                                               : std::vector{s.text(module_key::reference_curve)};
    if (names.empty())
      throw s.error(module_key::reference_curve, "an empty list", "at least one curve");
    for (const std::string& name : names) {
      design.reference_files.push_back(folder / name);
      const LightRecording file =
          read_light_recording(design.reference_files.back(), {}, design.reading);
      if (file.kind != LightRecording::Kind::sweep) {
        throw s.error(module_key::reference_curve, "\"" + name + "\"",
                      "a file of voltage_V,current_A");
      }
      std::ranges::move(reading_notes({file}), std::back_inserter(design.notes));
      for (LightRecording& curve : sweeps_of(file)) {
        design.references.push_back(std::move(curve));
        files.push_back(design.reference_files.size() - 1);
      }
    }
  } else {
    for (const Settings& point : s.get(module_key::datasheet)) {
      design.datasheet.push_back(read_rated_point(point));
      point.finish();
    }
    design.slopes = read_rated_slopes(s);
  }
  read_temperatures(s, files, design);
  if (s.has(module_key::current_noise)) design.current_noise_A = s.get(module_key::current_noise);
  design.voltage_noise_V = s.get(module_key::voltage_noise);
  s.finish();
  if (root.has("effect")) {
    for (const Settings& effect : root.tables("effect")) read_effect(effect, design);
  }
  return design;
}

Key module_table() {
  using namespace module_key;
  return table.of(joined({{cells, bypass_every, bypass_drop, chains, reference_curve,
                           datasheet.of(rated_point_keys())},
                          rated_slope_keys(),
                          {reference_temperature, reference_irradiance, temperature,
                           temperature_sigma, current_noise, voltage_noise}}));
}

std::vector<Key::Choice> module_effects() {
  using namespace effect_key;
  const std::vector<Key> reverse = {breakdown_fraction, breakdown, breakdown_exponent, leak};
  std::vector<Key::Choice> kinds =
      kind.bringing({joined({{count, factor}, reverse}),
                     joined({{count, fraction,
                              resistance.meaning(
                                  "resistance between this part and the rest of the cell")},
                             reverse}),
                     {count, resistance.meaning("resistance in parallel with each affected cell")},
                     {resistance.meaning("beside every cell")},
                     {resistance},
                     {change_of_temperature},
                     {},
                     joined({{count, factor}, reverse}),
                     {factors},
                     {change, bend}})
          .choices;
  for (Key::Choice& one : kinds) one.keys.push_back(curve);
  return kinds;
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
