#include "tools/cells/task.h"

#include <algorithm>
#include <string>

#include "core/constants.h"
#include "core/errors.h"
#include "core/text/format.h"
#include "core/text/parse.h"
#include "diagnosis/light/model/recording.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

// voltage_V,current_A; or V,I as some instruments write.
IvSweep read_sweep(const fs::path& file) {
  if (file.extension() == ".gz") {
    const LightRecording recording = read_light_recording(file, {});
    if (recording.kind != LightRecording::Kind::sweep) {
      throw InputError({file.string()}, "header", "another recording of light",
                       "a curve with voltage_V,current_A");
    }
    return {recording.voltage_V, recording.current_A};
  }
  const std::vector<std::string> header = read_column_names(file);
  const auto named = [&](const std::string& name, const std::string& other) {
    const bool has_other = std::ranges::find(header, name) == header.end() &&
                           std::ranges::find(header, other) != header.end();
    return has_other ? other : name;
  };
  const NumberColumns numbers =
      read_number_columns(file, {named("voltage_V", "V"), named("current_A", "I")});
  return {numbers.columns[0], numbers.columns[1]};
}

RatedPoint read_point(const Settings& s) {
  return {s.number_or("irradiance_W_m2", 1000.0, Range::positive()),
          s.number_or("temperature_K", 298.15, {1.0, 1000.0}),
          s.number("short_circuit_A", Range::positive()),
          s.number("open_circuit_V", Range::positive()),
          s.number("maximum_A", Range::positive()),
          s.number("maximum_V", Range::positive())};
}

// The open-circuit voltage of one cell: 0.3 V in moonlight, 4.5 V of the best stacks of junctions.
void check_cells(const Settings& s, const FitTask& task) {
  if (task.substrings > 0 && task.cells_in_series == 1) return;  // not stated
  double open_V = 0.0;
  for (const RatedPoint& p : task.datasheet) open_V = std::max(open_V, p.open_circuit_V);
  for (const IvSweep& sweep : task.sweeps) {
    for (size_t i = 0; i < std::min(sweep.voltage_V.size(), sweep.current_A.size()); ++i) {
      if (sweep.current_A[i] >= 0.0) open_V = std::max(open_V, sweep.voltage_V[i]);
    }
  }
  constexpr double lowest_V = 0.1, highest_V = 5.0;
  const double one_V = open_V / task.cells_in_series;
  if (open_V == 0.0 || (one_V >= lowest_V && one_V <= highest_V)) return;
  throw s.error("cells_in_series",
                std::to_string(task.cells_in_series) + " cells, of " + readable_number(one_V, 3) +
                    " V each at open circuit",
                "cells that give 0.1 to 5 V each of these " + readable_number(open_V, 3) + " V");
}

}  // namespace

double FitTask::thermal_V() const {
  return cells_in_series * boltzmann_J_K * temperature_K / elementary_charge_C;
}

FitTask read_fit_task(const Settings& root, const fs::path& folder) {
  const Settings s = root.table("fit");
  FitTask task;
  task.cells_in_series = static_cast<int>(s.integer_or("cells_in_series", 1, 1, 2000));
  task.temperature_K = s.number_or("temperature_K", 298.15, {1.0, 1000.0});
  if (s.has("curves") == s.has("datasheet")) {
    throw s.error("curves", s.has("curves") ? "curves and a datasheet" : "neither",
                  "either curves = [\"sweep.csv\"] or [[fit.datasheet]]");
  }
  if (s.has("datasheet")) {
    if (s.has("temperature_K")) {
      throw s.error("temperature_K", "a temperature beside a datasheet",
                    "temperature_K in [[fit.datasheet]]");
    }
    for (const Settings& point : s.tables("datasheet")) task.datasheet.push_back(read_point(point));
    task.slopes.short_circuit_1_K = s.number_or("short_circuit_slope_per_K", 5e-4);
    task.slopes.open_circuit_1_K = s.number_or("open_circuit_slope_per_K", -3e-3);
    const RatedTolerance written = written_steps(task.datasheet);
    task.tolerance = {s.number_or("rounding_A", written.step_A, Range::not_negative()),
                      s.number_or("rounding_V", written.step_V, Range::not_negative()),
                      s.number_or("tolerance", 0.0, {0.0, 0.5})};
  } else {
    for (const std::string& name : s.texts("curves")) {
      task.files.push_back(folder / name);
      task.sweeps.push_back(read_sweep(task.files.back()));
    }
    task.noise.current_fraction = s.number_or("current_noise", 1e-3, {1e-12, 1.0});
    task.noise.voltage_fraction = s.number_or("voltage_noise", 5e-4, {1e-12, 1.0});
    task.noise.correlation_points = s.number_or("correlation_points", 0.0, Range::not_negative());
    task.substrings = static_cast<int>(s.integer_or("substrings", 0, 0, 100));
    if (task.substrings > 0 && task.cells_in_series > 1 &&
        task.cells_in_series % task.substrings != 0) {
      throw s.error("cells_in_series", std::to_string(task.cells_in_series),
                    "a multiple of substrings, " + std::to_string(task.substrings));
    }
    if (task.substrings > 0 && s.has("correlation_points")) {
      throw s.error("correlation_points", "a correlation for a partly shaded string",
                    "none: there every point has an error of its own");
    }
    if (s.flag_or("even_voltage_steps", false)) {
      const EvenSweeps even = with_even_steps(task.sweeps, task.noise);
      task.sweeps = even.sweeps;
      task.noise = even.noise;
    }
  }
  root.finish();
  check_cells(s, task);
  return task;
}

}  // namespace photorque
