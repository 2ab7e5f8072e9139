// photorque propagate: propagates the platform through its disturbances.
#include <chrono>

#include "attitude/ccsds/aem.h"
#include "attitude/propagation/run.h"
#include "core/constants.h"
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

void run_propagate(const CommandLine& line) {
  const auto start = std::chrono::steady_clock::now();
  Console console(line);
  const AttitudeExperiment experiment(line);
  PropagationRun run = read_propagation(experiment.settings());
  if (line.seed) run.seed = *line.seed;
  const Provenance provenance = experiment.provenance(run.seed);
  const PropagationResult result = propagate(run, console.progress("propagating"));
  console.done();
  print_run(console, run, result);
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
