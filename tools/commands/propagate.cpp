// photorque propagate: propagates the platform through its disturbances.
#include <algorithm>
#include <chrono>

#include "attitude/ccsds/aem.h"
#include "attitude/propagation/run.h"
#include "core/constants.h"
#include "tools/coupling/couple.h"
#include "tools/coupling/report.h"
#include "tools/runs/attitude_run.h"
#include "tools/runs/optical_run.h"

namespace photorque {
namespace {

void print_run(const Console& console, const PropagationRun& run, const PropagationResult& result) {
  console.line("Disturbances");
  for (const Disturbance& disturbance : run.model.disturbances)
    console.line("  " + disturbance.kind);
  console.heading("Trajectory");
  const PlatformState& end = result.states.back();
  const auto row = [&](const std::string& name, double value, const std::string& unit) {
    console.line("  " + name + std::string(24 - name.size(), ' ') + show(value) + " " + unit);
  };
  row("until", end.time_s, "s");
  row("tilt at the end", tilt_rad(end) / degree_rad, "deg");
  row("heading at the end", heading_rad(end) / degree_rad, "deg");
  row("rate at the end", end.rate_body_rad_s.norm(), "rad/s");
  if (end.charge_drawn_C != 0.0) row("charge drawn", end.charge_drawn_C / 3600.0, "Ah");
  console.line("  in " + std::to_string(result.statistics.steps) + " steps");
  constexpr size_t max_events = 12;
  if (!result.events.empty()) console.heading("Events");
  for (size_t i = 0; i < std::min(max_events, result.events.size()); ++i) {
    const Event& event = result.events[i];
    console.line("  " + event.name + " at " + show(event.time_s) + " s");
  }
  if (result.events.size() > max_events) {
    console.line("  and " + std::to_string(result.events.size() - max_events) +
                 " more: events.csv");
  }
}

// The channels as a recording and the attitudes as CCSDS message.
void write_trajectory(const std::filesystem::path& folder, const PropagationRun& run,
                      const PropagationResult& result, const Provenance& provenance,
                      const std::string& name) {
  write_recording(folder / "recording.csv", result.recording, {provenance.one_line()});
  // Dated by the trajectory, not by the clock: equal runs give equal files.
  AttitudeEphemeris ephemeris = make_aem(result.states, run.epoch, name, run.epoch);
  ephemeris.comments = {provenance.one_line()};
  write_aem(folder / "attitude.aem", ephemeris);
}

CommandLine with_orbit_overrides(const CommandLine& line) {
  CommandLine full = line;
  for (const std::string& one :
       orbit_overrides(read_experiment_file(line.experiment, line.overrides))) {
    full.overrides.push_back(one);
  }
  return full;
}

// Those that are not there yet: scene and lamps.
void add_inputs(Provenance& provenance,
                const std::vector<std::pair<std::string, std::string>>& inputs) {
  for (const auto& input : inputs) {
    if (std::ranges::find(provenance.inputs, input) == provenance.inputs.end()) {
      provenance.inputs.push_back(input);
    }
  }
}

void add_light(const Console& console, const CoupledResult& coupled, const PropagationRun& run,
               Product& product) {
  if (coupled.table) append(product, table_product(*coupled.table));
  if (coupled.attitude_error_rad) {
    const double bound_deg = *coupled.attitude_error_rad / degree_rad;
    console.line("  the error of the table of light turns the body by less than " +
                 show(bound_deg) + " deg until then");
    product.quantities.push_back({"light_table_attitude_error_deg", {bound_deg, 0.0}});
  }
  if (!coupled.beside) return;
  print_power(console, *coupled.beside);
  append(product, power_product(*coupled.beside, product, run.history_rows));
}

void run_propagate(const CommandLine& line) {
  const auto start = std::chrono::steady_clock::now();
  Console console(line);
  const CommandLine full = with_orbit_overrides(line);
  const AttitudeExperiment experiment(full);
  PropagationRun run = read_propagation(experiment.settings());
  if (line.seed) run.seed = *line.seed;
  CoupledResult coupled = propagate_in_light(full, console, experiment.file(), run);
  PropagationResult& result = coupled.motion;
  Provenance provenance = experiment.provenance(run.seed);
  if (coupled.light) add_inputs(provenance, coupled.light->inputs());
  print_run(console, run, result);
  add_light(console, coupled, run, result.product);
  const Product pointing = pointing_product(result.states);
  print_pointing(console, pointing);
  append(result.product, pointing);
  write_trajectory(line.out_folder(), run, result, provenance, line.experiment.stem().string());
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  write_results(line, console, result.product, provenance, {wall.count(), {}});
  console.line("  and recording.csv, attitude.aem");
}

}  // namespace

Verb propagate_verb() {
  return {"propagate", "Fly the platform: attitude, rates, charge, every torque; a recording",
          run_propagate};
}

}  // namespace photorque
