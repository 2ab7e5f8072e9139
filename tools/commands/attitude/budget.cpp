// photorque budget: every disturbance torque at one state, ranked, beside the paper's figures.
#include "tools/tasks/budget.h"

#include "core/constants.h"
#include "core/errors.h"
#include "tools/commands/results.h"
#include "tools/commands/terminal.h"

namespace photorque::kinds::budget {
namespace {

const Table* find_table(const Product& product, const std::string& name) {
  for (const Table& table : product.tables) {
    if (table.name == name) return &table;
  }
  return nullptr;
}

const Table& table_named(const Product& product, const std::string& name) {
  const Table* table = find_table(product, name);
  if (table == nullptr) throw NumericalError("the budget has no table " + name);
  return *table;
}

void print_reasons(const Console& console, const Table& figures) {
  const auto& quantity = figures.column("quantity").texts;
  const auto& why = figures.column("why").texts;
  console.heading("Why");
  for (size_t i = 0; i < quantity.size(); ++i) console.line("  " + quantity[i] + ": " + why[i]);
}

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
  console.heading("Figures of the paper beside ours");
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

void run_budget(const CommandLine& line) {
  const Console console = terminal(line);
  const BudgetRun run = budget_of_experiment(line);
  const Product& product = run.result.product;
  const PlatformState& state = run.budget.state;
  console.line("State: tilt " + show(tilt_rad(state) / degree_rad) + " deg, heading " +
               show(heading_rad(state) / degree_rad) + " deg, rate " +
               show(state.rate_body_rad_s.norm()) + " rad/s, charge drawn " +
               show(state.charge_drawn_C / 3600.0) + " Ah");
  console.heading(
      "Disturbance torques, largest first; the angle each would turn if it stayed constant");
  print_table(console, table_named(product, "budget"),
              {{"disturbance", "disturbance"},
               {"torque [N m]", "torque_N_m"},
               {"fraction", "share_of_sum"},
               {"1 min [deg]", "angle_1_min_deg"},
               {"1 h [deg]", "angle_1_h_deg"},
               {"1 day [deg]", "angle_1_day_deg"},
               {"paper [N m]", "paper_N_m"},
               {"ours/paper", "ratio"}});
  if (const Table* air = find_table(product, "external_air")) print_air(console, *air);
  if (run.budget.beside_paper) print_paper(console, product);
  write_results(line, console, run.result);
}

}  // namespace

Verb kind() {
  return {"budget",
          "Every disturbance torque at one state, ranked; of STASIS beside published figures",
          run_budget};
}

}  // namespace photorque::kinds::budget
