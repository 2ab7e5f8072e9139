#include "diagnosis/guess/guess.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "attitude/recordings/aem.h"
#include "core/errors.h"
#include "core/text/format.h"
#include "diagnosis/guess/file_head.h"
#include "diagnosis/light/model/recording.h"
#include "diagnosis/light/module/nominal.h"
#include "photovoltaics/fit/fit.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

// A curve and the misfit of one diode to it.
struct MeasuredCurve {
  fs::path file;
  double open_V = 0.0;
  double misfit = 0.0;  // rms relative to the short-circuit current
};

MeasuredCurve measured_curve(const fs::path& file, const RecordingOptions& reading) {
  const LightRecording recording = read_light_recording(file, {}, reading);
  if (recording.kind != LightRecording::Kind::sweep) {
    throw InputError({file.string()}, "header", "another kind of recording than the first",
                     "curves of current over voltage alone");
  }
  MeasuredCurve measured{file};
  constexpr size_t most_points = 200;
  for (const LightRecording& curve : sweeps_of(recording)) {
    const ModuleSweep sweep = module_sweep(curve, {}, most_points, nullptr);
    const double short_A = std::ranges::max(sweep.current_A);
    for (size_t i = 0; i < sweep.voltage_V.size(); ++i) {
      if (sweep.current_A[i] >= 0.0) {
        measured.open_V = std::max(measured.open_V, sweep.voltage_V[i]);
      }
    }
    try {
      const SweepFit fit = fit_sweeps(std::vector<IvSweep>{{sweep.voltage_V, sweep.current_A}}, {});
      measured.misfit = std::max(measured.misfit, fit.rms_A / short_A);
    } catch (const std::runtime_error&) {
      measured.misfit = INFINITY;  // no diode fits the curve
    }
  }
  return measured;
}

// Number of crystalline silicon cells in series. They have open-circuit voltages of 0.55 to 0.74 V
// each, and manufacturers use only certain numbers of cells.
int cells_in_series(double open_V) {
  constexpr double usual_V = 0.65;
  constexpr int usual[] = {1,  2,  3,  4,  6,  8,  9,  10, 12,  18,  20,  24, 32,
                           36, 40, 48, 54, 60, 66, 72, 96, 108, 120, 132, 144};
  const double cells = open_V / usual_V;
  int best = 1;
  for (const int n : usual) {
    if (std::abs(std::log(n / cells)) < std::abs(std::log(best / cells))) best = n;
  }
  return best;
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
                  const fs::path& folder, const GuessedCurve& named, RecordingOptions reading) {
  reading.columns = named.columns;
  std::vector<MeasuredCurve> curves;
  for (const fs::path& file : recordings) curves.push_back(measured_curve(file, reading));
  add_reading(document, reading);
  if (!named.because.empty()) document.comment("CONFIRM: " + named.because);
  for (const auto& [name, in_file] : named.columns) {
    document.set(document.table("recording"), "columns." + name, {in_file});
  }
  const MeasuredCurve& clearest = *std::min_element(
      curves.begin(), curves.end(),
      [](const MeasuredCurve& a, const MeasuredCurve& b) { return a.misfit < b.misfit; });
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
  const int cells = cells_in_series(clearest.open_V);
  const fs::path reference = fs::absolute(clearest.file).lexically_proximate(fs::absolute(folder));
  SettingsNode::Table& module = document.table("module");
  document.comment("CONFIRM: " + std::to_string(cells) + " cells of silicon give " +
                   readable_number(clearest.open_V, 3) + " V at " +
                   readable_number(clearest.open_V / cells, 3) +
                   " V each; the label says how many there are.");
  document.set(module, "cells_in_series", {int64_t{cells}});
  document.comment(
      recordings.size() > 1
          ? "CONFIRM: of these curves one diode describes this one best (to " +
                readable_number(100.0 * clearest.misfit, 2) +
                " % of the short-circuit current): it is the reference of the nominal module."
          : "CONFIRM: there is no curve of the module before the fault. This curve is the "
            "reference, so that only deviations from the single-diode model can be found. A curve "
            "from before, or [[module.datasheet]] (docs/light_diagnosis.md), says more.");
  document.set(module, "reference_curve", {reference.generic_string()});
  document.comment("CONFIRM: the temperature of the cells and its standard error.");
  document.set(module, "temperature_K", {298.15});
  document.set(module, "temperature_sigma_K", {int64_t{20}});
  document.comment("CONFIRM: no bypass diodes are stated (bypass_every = cells under one).");
}

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
  if (!is_light_recording(recordings.front(), reading)) {
    if (!is_aem(recordings.front())) {
      const FileHead head = head_of(recordings.front(), reading);
      if (head.is_split_otherwise) reading.header = head.header;
    }
    if (!has_motion(guess_columns(recordings.front(), reading))) {
      const GuessedCurve curve = guess_curve(recordings.front(), reading);
      if (!curve.columns.empty()) {
        guess_module(document, recordings, folder, curve, reading);
        return document.text();
      }
    }
    guess_motion(document, recordings, reading);
    return document.text();
  }
  if (light_kind_of(recordings.front(), reading) != LightRecording::Kind::sweep) {
    throw InputError({recordings.front().string()}, "header", "a recording of light on a scene",
                     "motion, or current over voltage: a scan or a run needs its scene, which "
                     "photorque new --scene MODEL begins");
  }
  // Columns are stated if the file is not read without, as with "Voltage (in V)", or if a current
  // density requires an assumed area.
  GuessedCurve curve = guess_curve(recordings.front(), reading);
  if (curve.because.empty()) {
    try {
      read_light_recording(recordings.front(), {}, reading);
      curve = {};
    } catch (const InputError&) {
      if (curve.columns.empty()) throw;
    }
  }
  guess_module(document, recordings, folder, curve, reading);
  return document.text();
}

}  // namespace photorque
