// photorque balance: centre of mass from a recording, and mass displacements that correct it.
#include "tools/verbs/attitude/balance.h"

#include "core/errors.h"
#include "tools/runs/attitude_run.h"
#include "tools/verbs/verb.h"

namespace photorque {

BalanceOutcome run_balance(const RunOptions& options,
                           const std::vector<std::filesystem::path>& recordings) {
  if (recordings.size() != 1) {
    throw InputError({options.experiment.string()}, "--recording",
                     recordings.empty() ? "nothing" : "several recordings", "one recording");
  }
  const std::filesystem::path& recording = recordings.front();
  const WallTime wall;
  AttitudeExperiment experiment(options);
  experiment.add_input(recording);
  BalanceRun run = read_balance(experiment.settings(), recording);
  BalanceResult found = balance(run);
  Product product = balance_product(run, found);
  Provenance provenance = experiment.provenance(0);
  if (found.exceeds_noise()) provenance.warnings.push_back(found.warning());
  RunResult result{std::move(product), std::move(provenance), {wall.elapsed_s(), {}}};
  return {std::move(run), std::move(found), std::move(result)};
}

}  // namespace photorque

namespace photorque::verbs::balance {
namespace {

struct Options : CommandOptions {
  std::vector<std::filesystem::path> recordings;
};

void print_balance(const Console& console, const BalanceRun& run, const BalanceResult& result,
                   const Product& product) {
  console.line("Recording");
  std::string report = run.recording.report.text();
  for (size_t at = 0; (at = report.find('\n', at)) != std::string::npos; at += 3) {
    report.replace(at, 1, "\n  ");
  }
  console.line("  " + report);
  console.heading("Centre of mass from the centre of rotation, body axes");
  for (int k = 0; k < 3; ++k) {
    console.line(std::string("  ") + "xyz"[k] + "  " +
                 show(Estimate{result.offset_body_m[k], result.sigma_m[k]}, "m"));
  }
  console.line("  chi² per sample of the fit " + show(result.chi2_per_sample));
  if (result.segments > 1) {
    console.line("  the recording is in " + std::to_string(result.segments) +
                 " segments between gaps, each with its own initial state");
  }
  if (result.exceeds_noise()) console.line("  WARNING: " + result.warning());
  console.heading("Moves of the masses");
  print_table(console, table_named(product, "moving_masses"),
              {{"mass", "mass"},
               {"x", "direction_x"},
               {"y", "direction_y"},
               {"z", "direction_z"},
               {"steps", "steps"},
               {"travel [m]", "travel_m"}});
  console.heading("Residual of whole steps");
  const auto row = [&](const char* words, const char* name, const char* unit) {
    console.line("  " + padded(words, 32) + show(find_quantity(product, name)->estimate, unit));
  };
  row("distance of the centre of mass", "left_by_steps_m", "m");
  row("largest torque", "left_by_steps_N_m", "N m");
  row("half a step, coarsest axis", "resolution_m", "m");
  row("the paper's", "published_resolution_m", "m");
}

void add_options(Command& command, Options& options) {
  command.add_experiment(options);
  command.add_recordings(options.recordings);
}

RunResult run(const Options& options, const Console& console) {
  const BalanceOutcome outcome = run_balance(options, options.recordings);
  print_balance(console, outcome.run, outcome.balance, outcome.result.product);
  return outcome.result;
}

}  // namespace

Verb kind() {
  return {"balance",
          "Centre of mass from a recording, and the displacements of the balancing masses",
          command_that_writes(add_options, run),
          {"platform", "environment", "disturbance", "sensors", "balance", "recording"},
          "[balance]",
          [](const RunOptions& options) { return run_balance(options, {}).result; }};
}

}  // namespace photorque::verbs::balance
