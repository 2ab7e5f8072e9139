#include "tools/coupling/propagate.h"

#include <algorithm>
#include <numeric>

#include "attitude/model/platform.h"
#include "attitude/recordings/aem.h"
#include "core/constants.h"
#include "core/errors.h"
#include "tools/coupling/report.h"
#include "tools/coupling/table_cache.h"
#include "tools/runs/attitude_run.h"
#include "tools/runs/optical_run.h"

namespace photorque {
namespace {

void print_run(const Console& console, const PropagationRun& run, const CoupledResult& coupled) {
  const PropagationResult& result = coupled.motion;
  const Console details = console.details();
  details.line(std::to_string(run.model.disturbances.size()) + " disturbances");
  for (const Disturbance& disturbance : run.model.disturbances)
    details.line("  " + disturbance.kind);
  // Runs with light and power print their energies instead.
  const Console motion = coupled.beside ? details : console;
  console.heading("Trajectory");
  const PlatformState& end = result.end;
  motion.line("  " + padded("end of the run", 24) + show_duration(end.time_s));
  const auto figure = [&](const char* name) {
    const Quantity* found = find_quantity(result.product, name);
    return found == nullptr ? 0.0 : found->estimate.value;
  };
  console.line("  " + padded("largest tilt", 24) + show_brief(figure("largest_tilt_deg")) +
               " deg at " + show_duration(figure("largest_tilt_time_s")));
  motion.line("  " + padded("yaw excursion", 24) + show_brief(figure("yaw_excursion_deg")) +
              " deg between smallest and largest yaw");
  // The last curve of the fractions is the strongest torque.
  const auto fractions = std::ranges::find(result.product.plots, "torque_fractions", &Plot::name);
  if (fractions != result.product.plots.end() && !fractions->curves.empty()) {
    const Plot::Curve& strongest = fractions->curves.back();
    const double sum = std::accumulate(strongest.y.begin(), strongest.y.end(), 0.0);
    console.line("  " + padded("dominant disturbance", 24) + strongest.label + ", " +
                 show_brief(sum / static_cast<double>(strongest.y.size())) +
                 " % of the sum of all torques on average");
  }
  const auto row = [&](const std::string& name, double value, const std::string& unit) {
    motion.line("  " + padded(name, 24) + show_brief(value) + " " + unit);
  };
  row("tilt at the end", tilt_rad(end) / degree_rad, "deg");
  row("yaw at the end", yaw_rad(end) / degree_rad, "deg, between -180 and 180");
  row("rate at the end", end.rate_body_rad_s.norm(), "rad/s");
  if (end.charge_drawn_C != 0.0) row("charge drawn", end.charge_drawn_C / 3600.0, "Ah");
  details.line("  in " + std::to_string(result.statistics.steps) + " steps");
  if (coupled.attitude_error_rad) {
    console.line("  the error of the table of light turns the body by less than " +
                 show(*coupled.attitude_error_rad / degree_rad) + " deg until then");
  }
  constexpr size_t max_events = 5;
  if (!result.events.empty()) console.heading("Events");
  for (size_t i = 0; i < result.events.size(); ++i) {
    const Event& event = result.events[i];
    (i < max_events ? console : details)
        .line("  " + event.name + " at " + show(event.time_s) + " s");
  }
  if (result.events.size() > max_events) {
    console.line("  and " + std::to_string(result.events.size() - max_events) +
                 " more: events.csv");
  }
}

// Files: the channels as a recording, and the attitudes as a CCSDS message.
std::vector<RunFile> trajectory_files(const std::shared_ptr<const PropagationRun>& run,
                                      const std::shared_ptr<const CoupledResult>& coupled,
                                      const std::string& stamp, const std::string& name) {
  const auto recording = [coupled, stamp](const std::filesystem::path& path) {
    write_recording(path, coupled->motion.recording, {stamp});
  };
  const auto attitude = [run, coupled, stamp, name](const std::filesystem::path& path) {
    write_aem(path, coupled->motion.states, run->epoch, name, stamp);
  };
  return {{"recording.csv", recording}, {"attitude.aem", attitude}};
}

// Adds inputs that are missing in the provenance: scene and lamps.
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
    product.quantities.push_back(
        {"light_table_attitude_error_deg", {*coupled.attitude_error_rad / degree_rad, 0.0}});
  }
  if (!coupled.beside) return;
  print_power(console, *coupled.beside);
  append(product, power_product(*coupled.beside, product, run.history_rows));
}

// Identity of a run for its checkpoint: all inputs except the light.
std::string identity(const Provenance& provenance,
                     const std::vector<std::pair<std::string, std::string>>& seen) {
  return table_cache_version() + "seed " + std::to_string(provenance.seed) + "\n" +
         of_inputs(provenance.inputs) + of_inputs(seen);
}

}  // namespace

MotionRun run_propagate(const RunOptions& options, const Console& console,
                        const FurtherTorques& further,
                        const std::function<void(const Settings&, PropagationRun&)>& prepare,
                        CheckpointFile* checkpoint) {
  const WallTime wall;
  const AttitudeExperiment experiment(options);
  const auto run = std::make_shared<PropagationRun>(read_propagation(experiment.settings()));
  if (options.seed) run->seed = *options.seed;
  for (const Disturbance& one : further.disturbances) run->model.disturbances.push_back(one);
  const auto seen = look_through_scene(experiment.file(), run->sensors);
  if (prepare) prepare(experiment.settings(), *run);
  if (run->commander && command_delay_s(run->model.disturbances) > 0.0) {
    throw InputError({options.experiment.string()}, "disturbance",
                     "a latency of actuators in a run that is commanded tick by tick",
                     "no latency, or the commands in propagate.commands");
  }
  RunResult result;
  result.provenance = experiment.provenance(run->seed);
  const auto coupled = std::make_shared<CoupledResult>(propagate_in_light(
      options, console, experiment.file(), *run, checkpoint,
      checkpoint == nullptr ? std::string() : identity(result.provenance, seen)));
  PropagationResult& motion = coupled->motion;
  if (coupled->beside) {
    if (auto hot = hot_cells(*coupled->beside)) coupled->warnings.push_back(std::move(*hot));
  }
  if (coupled->light) add_inputs(result.provenance, coupled->light->inputs());
  add_inputs(result.provenance, seen);
  add_inputs(result.provenance, further.inputs);
  print_run(console, *run, *coupled);
  for (const std::string& warning : coupled->warnings) console.line("warning: " + warning);
  result.provenance.warnings = coupled->warnings;
  result.product = std::move(motion.product);
  add_light(console, *coupled, *run, result.product);
  const Product pointing = pointing_product(motion.states);
  print_pointing(coupled->beside ? console.details() : console, pointing);
  append(result.product, pointing);
  result.files = trajectory_files(run, coupled, result.provenance.one_line(),
                                  options.experiment.stem().string());
  result.cost = {wall.elapsed_s(), {}};
  return {run, coupled, std::move(result)};
}

}  // namespace photorque
