// photorque budget: every disturbance torque at one state, ranked, with the paper's figures.
#include "tools/verbs/attitude/budget.h"

#include <algorithm>

#include "attitude/model/platform.h"
#include "core/constants.h"
#include "tools/runs/attitude_run.h"
#include "tools/verbs/verb.h"

namespace photorque {

BudgetRun run_budget(const RunOptions& options) {
  const WallTime wall;
  const AttitudeExperiment experiment(options);
  Budget budget = read_budget(experiment.settings());
  Product product = budget_product(budget);
  RunResult result{std::move(product), experiment.provenance(0), {wall.elapsed_s(), {}}};
  return {std::move(budget), std::move(result)};
}

}  // namespace photorque

namespace photorque::verbs::budget {
namespace {

void print_air(const Console& console, const Table& parts) {
  console.heading(parts.title);
  print_table(console, parts,
              {{"part", "part"},
               {"torque [N m]", "torque_N_m"},
               {"fraction", "share"},
               {"Reynolds", "reynolds"},
               {"transition", "transition_reynolds"},
               {"law holds", "law_holds"}});
}

void print_paper(const Console& console, const Product& product) {
  const Table& figures = table_named(product, "paper_figures");
  console.heading("Published figures compared with photorque");
  print_table(console, figures,
              {{"quantity", "quantity"},
               {"section", "section"},
               {"paper", "published"},
               {"ours", "ours"},
               {"ratio", "ratio"},
               {"as published", "ours_as_published"}});
  print_reasons(console, figures);
  print_air(console, table_named(product, "paper_external_air"));
}

RunResult run(const CommandOptions& options, const Console& console) {
  const BudgetRun found = run_budget(options);
  const Product& product = found.result.product;
  const PlatformState& state = found.budget.state;
  console.line("State: tilt " + show(tilt_rad(state) / degree_rad) + " deg, heading " +
               show(heading_rad(state) / degree_rad) + " deg, yaw " +
               show(yaw_rad(state) / degree_rad) + " deg, rate " +
               show(state.rate_body_rad_s.norm()) + " rad/s, charge drawn " +
               show(state.charge_drawn_C / 3600.0) + " Ah");
  console.heading(
      "Disturbance torques, largest first, and the rotation by each if it stayed constant");
  print_table(console, table_named(product, "budget"),
              {{"disturbance", "disturbance"},
               {"torque [N m]", "torque_N_m"},
               {"fraction", "share_of_sum"},
               {"1 min [deg]", "angle_1_min_deg"},
               {"1 h [deg]", "angle_1_h_deg"},
               {"1 day [deg]", "angle_1_day_deg"},
               {"paper [N m]", "paper_N_m"},
               {"ratio to paper", "ratio"}},
              12);
  const auto acts = [](const BudgetEntry& e) { return !e.torque_body_N_m.isZero(0.0); };
  if (!std::ranges::any_of(found.budget.entries, acts)) {
    console.line(
        "No torque acts in this state: [budget] tilt_deg, spin_rpm, rate_rad_s or time_s "
        "state another.");
  }
  const Table* air = find_table(product, "external_air");
  if (air != nullptr) print_air(console.details(), *air);
  if (found.budget.beside_paper) print_paper(console.details(), product);
  if (!options.verbose && (air != nullptr || found.budget.beside_paper)) {
    console.line(std::string("  --verbose prints all torques") +
                 (air != nullptr ? ", the air drag of each part" : "") +
                 (found.budget.beside_paper ? ", the paper's figures" : ""));
  }
  return found.result;
}

}  // namespace

Verb kind() {
  return {"budget",
          "Every disturbance torque at one state, largest first; for STASIS also the "
          "figures of the paper",
          command_that_writes(experiment_options, run),
          {"platform", "environment", "disturbance", "sensors", "budget"},
          "[platform]",
          [](const RunOptions& options) { return run_budget(options).result; }};
}

}  // namespace photorque::verbs::budget
