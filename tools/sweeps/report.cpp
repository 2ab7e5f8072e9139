#include "tools/sweeps/report.h"

#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "core/errors.h"
#include "core/settings/settings.h"
#include "core/text/format.h"
#include "core/text/parse.h"
#include "tools/sweeps/evaluator.h"
#include "tools/sweeps/labels.h"

namespace photorque {
namespace {

using Eigen::ArrayXd, Eigen::MatrixXd;

constexpr const char* error_suffix = "_standard_error";
// Figure of `power`: temperature of the cells.
constexpr const char* cell_temperature = "cell_temperature_K";
constexpr const char* above_rated = "cell_temperature_above_rated_K";

// Adds the values of an axis as a column: numbers if all of them are numbers, otherwise texts.
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
    const Estimate none{std::nan(""), std::nan("")};
    const Estimate estimate = figure_of(design, name).value_or(none);
    values.push_back(estimate.value);
    errors.push_back(estimate.standard_error);
  }
  table.add(name, values).add(name + error_suffix, errors);
}

const std::vector<Figure>& first_figures(const SweepResult& result) {
  const auto first =
      std::ranges::find_if(result.designs, [](const Design& d) { return d.error.empty(); });
  if (first == result.designs.end()) {
    const std::string why = result.designs.empty() ? "" : ", the first: " + result.designs[0].error;
    throw InputError({}, "sweep", "no design that succeeds" + why, "one at least");
  }
  return first->figures;
}

// The value with the digits given by its error, or with the default digits if the relative error is
// below 1e-6.
std::string shown(Estimate value) {
  constexpr double finest = 1e-6;
  if (value.standard_error < finest * std::abs(value.value)) return show(value.value);
  std::string text = show(value, "");
  while (text.ends_with(' ')) text.pop_back();
  return text;
}

// Adds the results of the copies of the best and the nominal design: the value that the stated
// fraction reaches, mean and standard deviation, and a table of all copies.
void append_built(Product& product, const SweepPlan& plan, const SweepResult& result) {
  if (result.built_best.empty()) return;
  Table table = Table::of("built", "Built copies of the best and the nominal design", {"copy"});
  for (size_t i = 0; i < plan.built.copies; ++i) {
    table.row().set("copy", static_cast<double>(i + 1));
  }
  for (size_t k = 0; k < plan.objectives.size(); ++k) {
    const Objective& objective = plan.objectives[k];
    const auto add = [&](const std::string& whose, const BuiltFigure& figure) {
      table.add(whose + figure.column, figure.values);
      const auto reached = reached_by(plan.built.fraction, objective.maximise, figure.values);
      if (!reached) return;
      product.quantities.push_back({whose + plan.built_column(objective.figure), *reached});
    };
    add("best_", result.built_best[k]);
    if (k < result.built_nominal.size()) add("nominal_", result.built_nominal[k]);
  }
  product.tables.push_back(std::move(table));
}

std::vector<double> flags(const std::vector<size_t>& chosen, size_t count) {
  std::vector<double> all(count, 0.0);
  for (const size_t d : chosen) all[d] = 1.0;
  return all;
}

ArrayXd centred(const std::vector<double>& values) {
  const ArrayXd all = Eigen::Map<const ArrayXd>(values.data(), std::ssize(values));
  return all - all.mean();
}

// Fractions of the variance of `values` due to each of the `inputs`, by linear regression on all of
// them. All lists must be centred. Zero if the values do not vary.
ArrayXd fractions_of_variance(const ArrayXd& values, const MatrixXd& inputs) {
  const double variance = values.square().sum();
  if (!(variance > 0.0)) return ArrayXd::Zero(inputs.cols());
  const ArrayXd slopes = inputs.colPivHouseholderQr().solve(values.matrix()).array();
  return slopes.square() * inputs.colwise().squaredNorm().transpose().array() / variance;
}

std::string column_of(const SweepAxis& axis) {
  return "from " + axis.key;
}

}  // namespace

std::vector<std::string> figure_columns(const SweepPlan& plan, const std::vector<Figure>& figures) {
  std::vector<std::string> names;
  for (const Figure& figure : figures) names.push_back(figure.name.text());
  const auto require = [&names](const std::string& key, const std::string& name) {
    if (std::ranges::find(names, name) != names.end()) return;
    throw InputError(
        {}, key, '"' + name + '"',
        "a figure of the summary: " + listed_names({names.begin(), names.end()}, name));
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
  Table table = Table::of("sweep", "Results of " + plan.verb + " for each design", {"design"});
  for (size_t d = 0; d < designs.size(); ++d) table.row().set("design", static_cast<double>(d + 1));
  for (size_t axis = 0; axis < plan.axes.size(); ++axis) add_axis(table, plan, axis);
  std::vector<std::string> columns = figure_columns(plan, first_figures(result));
  for (const Objective& objective : plan.objectives) {
    const std::string judged = plan.judged_column(objective);
    if (std::ranges::find(columns, judged) == columns.end()) columns.push_back(judged);
  }
  for (const std::string& name : columns) add_figure(table, designs, name);
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

std::optional<Table> spread_table(const SweepPlan& plan, const SweepResult& result,
                                  const std::vector<std::string>& columns) {
  if (plan.grid || !plan.objectives.empty()) return std::nullopt;
  std::vector<size_t> good;
  for (size_t d = 0; d < result.designs.size(); ++d) {
    if (result.designs[d].error.empty()) good.push_back(d);
  }
  if (good.size() < plan.axes.size() + 2) return std::nullopt;
  std::vector<std::string> inputs;
  MatrixXd off_of_inputs(std::ssize(good), 0);
  for (size_t axis = 0; axis < plan.axes.size(); ++axis) {
    std::vector<double> values;
    for (const size_t d : good) {
      if (const auto number = number_in(plan.value(d, axis))) values.push_back(*number);
    }
    if (values.size() != good.size()) continue;
    inputs.push_back(column_of(plan.axes[axis]));
    off_of_inputs.conservativeResize(Eigen::NoChange, off_of_inputs.cols() + 1);
    off_of_inputs.rightCols(1) = centred(values).matrix();
  }
  Table table = Table::of("spread", "Spread of the figures over the uncertain inputs",
                          {"figure", "mean", "standard_deviation"});
  for (const std::string& column : inputs) table.columns.push_back({column});
  for (const std::string& name : columns) {
    std::vector<double> values;
    for (const size_t d : good) {
      if (const auto value = figure_of(result.designs[d], name)) values.push_back(value->value);
    }
    if (values.size() != good.size()) continue;
    const ArrayXd off = centred(values);
    const double mean = values.front() - off[0];
    const auto n = static_cast<double>(values.size());
    auto row = table.row();
    row.set("figure", name).set("mean", mean);
    row.set("standard_deviation", std::sqrt(off.square().sum() / (n - 1.0)));
    const ArrayXd fractions = fractions_of_variance(off, off_of_inputs);
    for (size_t i = 0; i < inputs.size(); ++i) {
      row.set(inputs[i], fractions[static_cast<Eigen::Index>(i)]);
    }
  }
  return table;
}

void print_spread(const Console& console, const SweepPlan& plan, const Table& spread) {
  console.heading("Mean and standard deviation over " + std::to_string(plan.designs()) +
                  " designs, and the fraction of the variance that each input causes");
  constexpr double noticeable = 0.005;
  constexpr size_t most_figures = 8;
  for (size_t row = 0; row < std::min(most_figures, spread.columns.front().size()); ++row) {
    const auto at = [&](const std::string& name) { return spread.column(name).values[row]; };
    console.line("  " + spread.column("figure").texts[row] + "  " +
                 show({at("mean"), at("standard_deviation")}, ""));
    for (const SweepAxis& axis : plan.axes) {
      const auto is_its = [&](const Table::Column& c) { return c.name == column_of(axis); };
      if (std::ranges::none_of(spread.columns, is_its)) continue;
      const double fraction = at(column_of(axis));
      if (fraction < noticeable) continue;
      console.line("    " + show_percent(fraction) + "  " + label_of(axis).name);
    }
  }
}

Product sweep_product(const SweepPlan& plan, const SweepResult& result) {
  Product product;
  product.tables.push_back(sweep_table(plan, result));
  std::vector<std::string> drawn = plan.figures;
  for (const Objective& objective : plan.objectives) {
    const std::string column = plan.judged_column(objective);
    if (std::ranges::find(drawn, column) == drawn.end()) drawn.push_back(column);
  }
  add_pictures(product, plan, result, drawn);
  const auto count = [&product](const std::string& name, size_t value) {
    product.quantities.push_back({name, {static_cast<double>(value), 0.0}});
  };
  const auto failed = static_cast<size_t>(
      std::ranges::count_if(result.designs, [](const Design& d) { return !d.error.empty(); }));
  count("designs", result.designs.size());
  if (failed > 0) count("failed_designs", failed);
  const auto spread = spread_table(plan, result, figure_columns(plan, first_figures(result)));
  if (spread) product.tables.push_back(*spread);
  if (!result.best) return product;
  count("best_design", *result.best + 1);
  const auto add = [&](const std::string& name, const Design& design, const std::string& column) {
    const auto value = figure_of(design, column);
    if (value && std::isfinite(value->value)) product.quantities.push_back({name, *value});
  };
  for (const Objective& objective : plan.objectives) {
    std::vector<std::string> columns{objective.figure.column()};
    if (plan.built.of_every) columns.push_back(plan.judged_column(objective));
    for (const std::string& column : columns) {
      add("best_" + column, result.designs[*result.best], column);
      if (result.nominal) add("nominal_" + column, *result.nominal, column);
    }
  }
  add(std::string("best_") + cell_temperature, result.designs[*result.best], cell_temperature);
  append_built(product, plan, result);
  return product;
}

void print_best(const Console& console, const SweepPlan& plan, const SweepResult& result,
                const Changes& changes) {
  if (!result.best) return;
  console.heading("Best: design " + std::to_string(*result.best + 1) + " of " +
                  std::to_string(result.designs.size()));
  for (const std::string& change : changes) console.line("  " + change);
  const auto row = [&](const std::string& what, const std::optional<Estimate>& best,
                       const std::optional<Estimate>& nominal) {
    if (!best) return;
    std::string text = "  " + what + "  " + shown(*best);
    if (nominal) {
      text += "; nominal experiment " + shown(*nominal);
      const double percent = 100.0 * (best->value / nominal->value - 1.0);
      if (std::isfinite(percent)) {
        text += " (" + std::string(percent < 0.0 ? "" : "+") + readable_number(percent, 3) + " %)";
      }
    }
    console.line(text);
  };
  for (size_t k = 0; k < plan.objectives.size(); ++k) {
    const Objective& objective = plan.objectives[k];
    const auto of = [&](const std::string& column) {
      const std::optional<Estimate> none;
      row(column, figure_of(result.designs[*result.best], column),
          result.nominal ? figure_of(*result.nominal, column) : none);
    };
    of(objective.figure.column());
    if (plan.built.of_every) of(plan.judged_column(objective));
    if (k >= result.built_best.size()) continue;
    const auto reached = [&](const std::vector<BuiltFigure>& built) {
      return k < built.size() ? reached_by(plan.built.fraction, objective.maximise, built[k].values)
                              : std::nullopt;
    };
    row("  " + show_percent(plan.built.fraction) + " of " + std::to_string(plan.built.copies) +
            " built copies reach",
        reached(result.built_best), reached(result.built_nominal));
  }
  row(cell_temperature, figure_of(result.designs[*result.best], cell_temperature),
      result.nominal ? figure_of(*result.nominal, cell_temperature) : std::nullopt);
  if (result.nominal && !result.nominal->error.empty()) {
    console.line("  the nominal experiment fails: " + result.nominal->error);
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
    lines.emplace_back("no design satisfies the constraints");
  }
  const auto hot_K = result.best ? figure_of(result.designs[*result.best], above_rated)
                                 : std::optional<Estimate>{};
  if (hot_K && hot_K->value > 0.0) {
    lines.push_back("the cells of the best design are " + show(hot_K->value) +
                    " K above array.rated_temperature_K; a [[sweep.constraint]] with figure = \"" +
                    above_rated + "\" and at_most = 0 keeps designs below it");
  }
  return lines;
}

}  // namespace photorque
