#include "tools/sweeps/report.h"

#include <algorithm>
#include <cmath>

#include "core/errors.h"
#include "core/settings/settings.h"
#include "core/text/numbers.h"

namespace photorque {
namespace {

constexpr const char* error_suffix = "_standard_error";

double not_a_number() {
  return std::numeric_limits<double>::quiet_NaN();
}

// The value of an axis as a column: numbers where all are numbers.
void add_axis(Table& table, const SweepPlan& plan, size_t axis) {
  std::vector<double> numbers;
  std::vector<std::string> texts;
  for (size_t d = 0; d < plan.designs(); ++d) {
    const std::string& text = plan.value(d, axis);
    if (const auto number = number_in(text)) numbers.push_back(*number);
    texts.push_back(text);
  }
  if (numbers.size() == texts.size()) {
    table.add(plan.axes[axis].key, numbers);
  } else {
    table.add(plan.axes[axis].key, texts);
  }
}

void add_figure(Table& table, const std::vector<Design>& designs, const std::string& name) {
  std::vector<double> values, errors;
  for (const Design& design : designs) {
    const Estimate none{not_a_number(), not_a_number()};
    const Estimate estimate = figure_of(design, name).value_or(none);
    values.push_back(estimate.value);
    errors.push_back(estimate.standard_error);
  }
  table.add(name, values).add(name + error_suffix, errors);
}

const std::vector<Quantity>& first_figures(const SweepResult& result) {
  const auto first =
      std::ranges::find_if(result.designs, [](const Design& d) { return d.error.empty(); });
  if (first == result.designs.end()) throw NumericalError("no design of the sweep succeeded");
  return first->figures;
}

// Against the last axis, a curve for every combination of the others; of random plans, points.
Plot figure_plot(const SweepPlan& plan, const Table& table, const std::string& figure) {
  const size_t axes = plan.axes.size();
  const Table::Column& x = table.column(plan.axes.back().key);
  const Table::Column& y = table.column(figure);
  const Table::Column& error = table.column(figure + error_suffix);
  Plot plot{"sweep_" + y.name, y.name + " over " + x.name, x.name, y.name, {}, false, false, {}};
  const size_t along = plan.grid ? plan.axes.back().values.size() : plan.designs();
  for (size_t begin = 0; begin < plan.designs(); begin += along) {
    Plot::Curve curve;
    for (size_t axis = 0; plan.grid && axis + 1 < axes; ++axis) {
      curve.label += (axis > 0 ? ", " : "") + plan.axes[axis].key + " " + plan.value(begin, axis);
    }
    curve.markers = !plan.grid;
    for (size_t d = begin; d < begin + along; ++d) {
      curve.x.push_back(x.values[d]);
      curve.y.push_back(y.values[d]);
      curve.y_error.push_back(error.values[d]);
    }
    plot.curves.push_back(std::move(curve));
  }
  return plot;
}

// With as many digits as a bound of 1e-6 leaves where the error is less.
std::string shown(Estimate value) {
  constexpr double finest = 1e-6;
  if (value.standard_error < finest * std::abs(value.value)) return show(value.value);
  std::string text = show(value, "");
  while (text.ends_with(' ')) text.pop_back();
  return text;
}

std::vector<double> flags(const std::vector<size_t>& chosen, size_t count) {
  std::vector<double> all(count, 0.0);
  for (const size_t d : chosen) all[d] = 1.0;
  return all;
}

}  // namespace

std::vector<std::string> figure_columns(const SweepPlan& plan,
                                        const std::vector<Quantity>& figures) {
  std::vector<std::string> names;
  for (const Quantity& q : figures) names.push_back(q.name);
  const auto require = [&names](const std::string& key, const std::string& name) {
    if (std::ranges::find(names, name) != names.end()) return;
    const std::string suggestion = nearest(name, {names.begin(), names.end()});
    throw InputError({}, key, '"' + name + '"',
                     suggestion.empty() ? "a figure of the command's summary.json"
                                        : "a figure of the summary, perhaps \"" + suggestion + '"');
  };
  for (const std::string& name : plan.figures) {
    if (std::ranges::count(plan.figures, name) > 1) {
      throw InputError({}, "sweep.figures", '"' + name + "\" twice", "every figure once");
    }
    require("sweep.figures", name);
  }
  std::vector<std::string> columns = plan.figures.empty() ? names : plan.figures;
  const auto add = [&](const std::string& key, const SweepFigure& figure) {
    require(key, figure.name);
    const std::string column = figure.column();
    if (std::ranges::find(columns, column) == columns.end()) columns.push_back(column);
  };
  for (const Objective& objective : plan.objectives) {
    add(objective.maximise ? "sweep.maximise" : "sweep.minimise", objective.figure);
  }
  for (const Constraint& constraint : plan.constraints) {
    add("sweep.constraint.figure", constraint.figure);
  }
  return columns;
}

Table sweep_table(const SweepPlan& plan, const SweepResult& result) {
  const std::vector<Design>& designs = result.designs;
  Table table = Table::of("sweep", "What " + plan.verb + " gave, design by design", {"design"});
  for (size_t d = 0; d < designs.size(); ++d) table.row().set("design", static_cast<double>(d + 1));
  for (size_t axis = 0; axis < plan.axes.size(); ++axis) add_axis(table, plan, axis);
  for (const std::string& name : figure_columns(plan, first_figures(result))) {
    add_figure(table, designs, name);
  }
  if (!plan.constraints.empty()) {
    std::vector<double> feasible;
    for (const Design& design : designs) feasible.push_back(design.feasible ? 1.0 : 0.0);
    table.add("feasible", feasible);
  }
  if (plan.objectives.size() > 1) {
    table.add("pareto", flags(pareto_designs(plan, designs), designs.size()));
  }
  if (std::ranges::any_of(designs, [](const Design& d) { return !d.error.empty(); })) {
    std::vector<std::string> errors;
    for (const Design& design : designs) errors.push_back(design.error);
    table.add("error", errors);
  }
  return table;
}

Product sweep_product(const SweepPlan& plan, const SweepResult& result) {
  Product product;
  Table table = sweep_table(plan, result);
  constexpr size_t max_curves = 12;
  const size_t curves = plan.grid ? plan.designs() / plan.axes.back().values.size() : 1;
  const bool plots = !plan.figures.empty() && curves <= max_curves &&
                     !table.column(plan.axes.back().key).values.empty();
  if (plots) {
    for (const std::string& name : figure_columns(plan, first_figures(result))) {
      product.plots.push_back(figure_plot(plan, table, name));
    }
  }
  const size_t failed = static_cast<size_t>(
      std::ranges::count_if(result.designs, [](const Design& d) { return !d.error.empty(); }));
  const auto count = [&product](const std::string& name, size_t value) {
    product.quantities.push_back({name, {static_cast<double>(value), 0.0}});
  };
  count("designs", result.designs.size());
  if (failed > 0) count("failed_designs", failed);
  if (result.best) count("best_design", *result.best + 1);
  for (const Objective& objective : plan.objectives) {
    const std::string column = objective.figure.column();
    if (!result.best) continue;
    product.quantities.push_back(
        {"best_" + column, *figure_of(result.designs[*result.best], column)});
    if (!result.nominal || !result.nominal->error.empty()) continue;
    product.quantities.push_back({"nominal_" + column, *figure_of(*result.nominal, column)});
  }
  product.tables.push_back(std::move(table));
  return product;
}

void print_best(const Console& console, const SweepPlan& plan, const SweepResult& result,
                const Changes& changes) {
  if (!result.best) return;
  const Design& best = result.designs[*result.best];
  console.heading("Best: design " + std::to_string(*result.best + 1) + " of " +
                  std::to_string(result.designs.size()));
  for (const std::string& change : changes) console.line("  " + change);
  for (const Objective& objective : plan.objectives) {
    const std::string column = objective.figure.column();
    const Estimate value = *figure_of(best, column);
    std::string text = "  " + column + "  " + shown(value);
    if (result.nominal && result.nominal->error.empty()) {
      const double nominal = figure_of(*result.nominal, column)->value;
      text += ", of the experiment as it stands " + show(nominal);
      if (nominal != 0.0) {
        const double percent = 100.0 * (value.value / nominal - 1.0);
        text += " (" + std::string(percent < 0.0 ? "" : "+") + show(percent) + " %)";
      }
    }
    console.line(text);
  }
  if (result.nominal && !result.nominal->error.empty()) {
    console.line("  the experiment as it stands fails: " + result.nominal->error);
  }
}

std::vector<std::string> sweep_warnings(const SweepPlan& plan, const SweepResult& result) {
  std::vector<std::string> lines;
  const auto has_failed = [](const Design& d) { return !d.error.empty(); };
  const auto failed = std::ranges::count_if(result.designs, has_failed);
  if (failed > 0) {
    const auto first = std::ranges::find_if(result.designs, has_failed);
    lines.push_back(std::to_string(failed) + " of " + std::to_string(result.designs.size()) +
                    " designs failed; the first is design " +
                    std::to_string(first - result.designs.begin() + 1) + ": " + first->error);
  }
  if (!plan.objectives.empty() && !result.best) {
    lines.emplace_back("no design keeps to the constraints");
  }
  return lines;
}

}  // namespace photorque
