// photorque balance: the centre of mass from a recording, and the masses' moves that remove it.
#include "tools/tasks/balance.h"

#include "core/errors.h"
#include "tools/commands/results.h"
#include "tools/commands/terminal.h"

namespace photorque::kinds::balance {
namespace {

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
  if (result.stretches > 1) {
    console.line("  the recording is in " + std::to_string(result.stretches) +
                 " stretches between gaps, each with a start of its own");
  }
  if (result.leaves_more_than_noise()) console.line("  WARNING: " + result.warning());
  console.heading("Moves of the masses");
  for (const Table& table : product.tables) {
    if (table.name != "moving_masses") continue;
    print_table(console, table,
                {{"mass", "mass"},
                 {"x", "direction_x"},
                 {"y", "direction_y"},
                 {"z", "direction_z"},
                 {"steps", "steps"},
                 {"travel [m]", "travel_m"}});
  }
  console.heading("Left by whole steps");
  for (const Quantity& quantity : product.quantities) {
    if (quantity.name == "left_by_steps_m") {
      console.line("  distance of the centre of mass  " + show(quantity.estimate, "m"));
    } else if (quantity.name == "left_by_steps_N_m") {
      console.line("  largest torque                  " + show(quantity.estimate, "N m"));
    } else if (quantity.name == "resolution_m") {
      console.line("  half a step, coarsest axis      " + show(quantity.estimate, "m"));
    } else if (quantity.name == "published_resolution_m") {
      console.line("  the paper's                     " + show(quantity.estimate, "m"));
    }
  }
}

void run_balance(const CommandLine& line) {
  const Console console = terminal(line);
  if (line.recordings.size() != 1) {
    throw InputError({line.experiment.string()}, "--recording",
                     line.recordings.empty() ? "nothing" : "several recordings", "one recording");
  }
  const BalanceOutcome outcome = balance_of_experiment(line, line.recordings.front());
  print_balance(console, outcome.run, outcome.balance, outcome.result.product);
  write_results(line, console, outcome.result);
}

}  // namespace

Verb kind() {
  Verb verb{"balance", "Centre of mass from a recording, and the balancing masses' moves",
            run_balance};
  verb.takes_recordings = true;
  return verb;
}

}  // namespace photorque::kinds::balance
