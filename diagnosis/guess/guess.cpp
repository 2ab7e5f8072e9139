#include "diagnosis/guess/guess.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "attitude/recordings/aem.h"
#include "attitude/recordings/text_lines.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/text/format.h"
#include "core/text/parse.h"
#include "diagnosis/guess/file_head.h"
#include "diagnosis/light/model/recording.h"
#include "diagnosis/light/module/nominal.h"
#include "photovoltaics/cell/cell.h"
#include "photovoltaics/fit/curve_text.h"
#include "photovoltaics/fit/curve_words.h"
#include "photovoltaics/fit/fit.h"
#include "sources/photometry/file.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

// The curves of a file.
struct MeasuredCurves {
  fs::path file;
  double open_V = 0.0;  // the largest open-circuit voltage
  double misfit = 0.0;  // of one diode, rms relative to the short-circuit current
  bool is_density = false;
  std::optional<double> temperature_K, irradiance_W_m2;  // as the file states them
};

// The voltage at which the current of a sweep by rising voltages is zero, or that of its diode if
// it ends before.
double open_circuit_V(const ModuleSweep& sweep, const std::optional<SweepFit>& fit) {
  const std::vector<double>&volts = sweep.voltage_V, &amperes = sweep.current_A;
  size_t last = volts.size();
  while (last > 0 && amperes[last - 1] < 0.0) --last;
  if (last == 0) return 0.0;
  if (last < volts.size()) {
    const double part = amperes[last - 1] / (amperes[last - 1] - amperes[last]);
    return volts[last - 1] + part * (volts[last] - volts[last - 1]);
  }
  if (!fit) return volts.back();
  const CellCurve diode(fit->diode.parameters(298.15));
  return std::max(volts.back(), diode.open_circuit_V(fit->diode.photocurrent_A.value));
}

MeasuredCurves measured_curves(const fs::path& file, const RecordingOptions& reading) {
  const LightRecording recording = read_light_recording(file, {}, reading);
  if (recording.kind != LightRecording::Kind::sweep) {
    throw InputError({file.string()}, "header", "another kind of recording than the first",
                     "curves of current over voltage alone");
  }
  MeasuredCurves measured;
  measured.file = file;
  measured.is_density = recording.is_density;
  if (recording.has_temperatures) {
    measured.temperature_K = std::round(100.0 * median_of(recording.temperature_K)) / 100.0;
  }
  const double irradiance_W_m2 = median_of(recording.irradiance_W_m2);
  if (std::isfinite(irradiance_W_m2)) measured.irradiance_W_m2 = irradiance_W_m2;
  constexpr size_t most_points = 200;
  for (const LightRecording& curve : sweeps_of(recording)) {
    const ModuleSweep sweep = module_sweep(curve, {}, most_points, nullptr);
    const double short_A = std::ranges::max(sweep.current_A);
    std::optional<SweepFit> fit;
    try {
      fit = fit_sweeps(std::vector<IvSweep>{{sweep.voltage_V, sweep.current_A}}, {});
    } catch (const std::runtime_error&) {  // no diode fits the curve
    }
    measured.misfit = std::max(measured.misfit, fit ? fit->rms_A / short_A : INFINITY);
    measured.open_V = std::max(measured.open_V, open_circuit_V(sweep, fit));
  }
  return measured;
}

// A number of crystalline silicon cells in series for an open-circuit voltage.
struct Cells {
  int count = 1;
  int modules = 1;  // of 60 or 72 cells each, in a string
};

// At 25 °C a cell gives 0.55 to 0.74 V, and 2.2 mV less for each kelvin more. Manufacturers use
// certain numbers of cells; modules of 36, 60, 72 or 96 are by far the most frequent. Up to 1.25 V
// a single cell of another material (a perovskite, GaAs) is more frequent than two of silicon.
Cells cells_in_series(double open_V, std::optional<double> temperature_K) {
  constexpr double usual_V = 0.63, per_K = -2.2e-3, relative_spread = 0.1, rare = 2.2,
                   most_of_one_V = 1.25;
  constexpr int few[] = {2,  3,  4,  6,  8,  9,  10, 12, 18,  20,  22,  24, 32,
                         33, 40, 44, 48, 54, 66, 78, 88, 104, 108, 132, 156};
  constexpr int frequent[] = {36, 60, 72, 96, 120, 144};
  if (open_V < most_of_one_V) return {};
  const double one_V = usual_V + per_K * (temperature_K.value_or(298.15) - 298.15),
               cells = open_V / std::max(one_V, 0.4);
  Cells best;
  double least = INFINITY;
  const auto weigh = [&](Cells some, double cost) {
    cost += std::abs(std::log(some.count / cells)) / relative_spread;
    if (cost < least) best = some;
    least = std::min(least, cost);
  };
  for (const int n : few) weigh({n}, rare);
  for (const int n : frequent) weigh({n}, 0.0);
  for (const int of_module : {60, 72}) {
    const int modules = static_cast<int>(std::clamp(std::round(cells / of_module), 1.0, 100.0));
    if (modules > 2) weigh({modules * of_module, modules}, 0.0);
  }
  return best;
}

// The assumption in words.
std::string cells_in_words(const Cells& cells, double open_V) {
  const double one_V = open_V / cells.count;
  const std::string count = std::to_string(cells.count);
  constexpr double least_V = 0.4, most_V = 0.8;  // of silicon in sunlight
  if (one_V < least_V || one_V > most_V) {
    return count + (cells.count > 1 ? " cells give " : " cell gives ") +
           readable_number(open_V, 3) +
           " V. Silicon in sunlight gives 0.4 to 0.8 V each: the light "
           "is weak, the material or the number is another, or the voltage has another unit.";
  }
  const std::string modules =
      cells.modules > 1 ? " (" + std::to_string(cells.modules) + " modules of " +
                              std::to_string(cells.count / cells.modules) + " in a string)"
                        : "";
  return count + (cells.count > 1 ? " cells" : " cell") + modules + " of silicon would give " +
         readable_number(open_V, 3) + " V at " + readable_number(one_V, 3) +
         " V each; the label of the module states the number.";
}

}  // namespace

void add_reading(TomlDocument& document, const RecordingOptions& reading) {
  if (!reading.header.empty()) {
    SettingsNode::Array names;
    for (const std::string& name : reading.header) names.push_back({name});
    document.set(document.table("recording"), "header", {names});
  }
  if (reading.rate_Hz) document.set(document.table("recording"), "rate_Hz", {*reading.rate_Hz});
}

void guess_module(TomlDocument& document, const std::vector<fs::path>& recordings,
                  const fs::path& folder, const RecordingOptions& reading) {
  std::vector<MeasuredCurves> curves;
  for (const fs::path& file : recordings) curves.push_back(measured_curves(file, reading));
  add_reading(document, reading);
  if (std::ranges::any_of(curves, &MeasuredCurves::is_density)) {
    document.comment(
        "CONFIRM: a current density is read as the current of 1 cm²: multiply currents by the area "
        "of the cell.");
  }
  for (const auto& [name, in_file] : reading.columns) {
    document.set(document.table("recording"), "columns." + name, {in_file});
  }
  const MeasuredCurves& clearest = *std::ranges::min_element(curves, {}, &MeasuredCurves::misfit);
  constexpr double largest_misfit = 0.2;
  if (!(clearest.misfit < largest_misfit)) {
    const std::string to = clearest.misfit < 10.0
                               ? " better than to " + readable_number(100.0 * clearest.misfit, 2) +
                                     " % of its largest current"
                               : "";
    throw InputError({clearest.file.string()}, "rows", "a curve that no diode fits" + to,
                     "a current-voltage curve of a lit module: not a log over time, a resistor or "
                     "a dark curve");
  }
  const Cells cells = cells_in_series(clearest.open_V, clearest.temperature_K);
  const fs::path reference = fs::absolute(clearest.file).lexically_proximate(fs::absolute(folder));
  SettingsNode::Table& module = document.table("module");
  document.comment("CONFIRM: " + cells_in_words(cells, clearest.open_V));
  document.set(module, "cells_in_series", {int64_t{cells.count}});
  document.comment(
      recordings.size() > 1
          ? "CONFIRM: of these curves one diode describes this one best (to " +
                readable_number(100.0 * clearest.misfit, 2) +
                " % of the short-circuit current): it is the reference of the nominal module."
          : "CONFIRM: there is no curve of the module before the fault. This curve is the "
            "reference, so that only deviations from the single-diode model can be found. A curve "
            "from before, or [[module.datasheet]] (docs/light_diagnosis.md), improves the "
            "diagnosis.");
  document.set(module, "reference_curve", {reference.generic_string()});
  document.comment(clearest.temperature_K
                       ? "CONFIRM: the file states the temperature; its standard error."
                       : "CONFIRM: the temperature of the cells and its standard error.");
  document.set(module, "temperature_K", {clearest.temperature_K.value_or(298.15)});
  document.set(module, "temperature_sigma_K", {int64_t{clearest.temperature_K ? 5 : 20}});
  if (clearest.irradiance_W_m2) {
    document.comment("The file states " + readable_number(*clearest.irradiance_W_m2, 4) +
                     " W/m², which is used.");
  }
  document.comment("CONFIRM: no bypass diodes are stated (bypass_every = cells under one).");
}

namespace {

// Throws InputError for the voltage or the current of a curve in an unknown unit.
void refuse_curve_units(const fs::path& file, const RecordingOptions& reading,
                        const std::vector<GuessedColumn>& columns) {
  for (const GuessedColumn& c : columns) {
    const curve_text::Named name = curve_text::named(c.in_file);
    const bool is_voltage = name.column == curve_text::voltage,
               is_needed = is_voltage || name.column == curve_text::current;
    if (!is_needed || name.unknown_unit.empty() || name.match != curve_text::Named::plain) continue;
    const std::string command = command_for_columns(file, reading, columns);
    if (command.empty()) continue;
    throw InputError({file.string(), head_of(file, reading).line}, c.in_file,
                     "the unit " + in_quotes(name.unknown_unit),
                     (is_voltage ? "V or mV; or " : "A, mA, µA or mA/cm²; or ") + command);
  }
}

// Throws InputError for a lamp file.
void refuse_lamp_file(const fs::path& file) {
  constexpr uint64_t largest_bytes = 10'000'000;
  std::string format;
  try {
    format = read_photometric(read_file(file, largest_bytes), file.string()).format;
  } catch (const std::runtime_error&) {
    return;  // another file
  }
  throw InputError(
      {file.string()}, "", "a lamp file (" + format + ")",
      "a recording: photorque trace reads lamp files, as [[source]] kind = \"ies\" of an "
      "experiment");
}

}  // namespace

std::string guess_experiment(const std::vector<std::filesystem::path>& recordings,
                             const std::filesystem::path& folder, RecordingOptions reading) {
  if (recordings.empty()) {
    throw InputError({}, "--guess", "nothing", "a recording (CSV), or several of one machine");
  }
  const std::string names = joined_text(recordings, ", ", [&](const std::filesystem::path& path) {
    return path.filename().string();
  });
  TomlDocument document;
  document.add_to_head("Made by photorque diagnose --guess from " + names +
                       ". Values were read from there; assumptions are marked CONFIRM.");
  const fs::path& first = recordings.front();
  const auto kind = light_kind_of(first, reading);
  if (kind && *kind != LightRecording::Kind::sweep) {
    throw InputError({first.string()}, "header", "a recording of light on a scene",
                     "motion, or current over voltage: a scan or a run needs its scene, which "
                     "photorque new --scene MODEL begins");
  }
  // A machine's log may contain its voltage and current: a time and a motion count before them.
  std::vector<GuessedColumn> columns;
  std::optional<InputError> refusal;
  RecordingOptions with_header = reading;
  try {
    if (!is_aem(first)) {
      const FileHead head = head_of(first, reading);
      if (head.is_split_otherwise) with_header.header = head.header;
    }
    columns = guess_columns(first, with_header);
  } catch (const InputError& error) {
    refuse_lamp_file(first);
    refusal = error;
  }
  const bool is_lit = std::ranges::any_of(columns, [](const GuessedColumn& c) {
    return lower_case(c.in_file).find("irradiance") != std::string::npos;
  });
  const bool is_of_motion =
      is_aem(first) || (has_motion(columns) && (reading.rate_Hz || (has_time(columns) && !is_lit)));
  if (!is_of_motion) refuse_curve_units(first, with_header, columns);
  for (RecordingOptions how : {reading, with_header}) {
    if (is_of_motion) break;
    if (!light_kind_of(first, how))
      how.columns = curve_columns_in(whole_text(first, how.header), first.string());
    if (!light_kind_of(first, how)) continue;
    guess_module(document, recordings, folder, how);
    return document.text();
  }
  if (refusal) throw *refusal;
  guess_motion(document, recordings, with_header);
  return document.text();
}

}  // namespace photorque
