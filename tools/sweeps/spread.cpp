#include "tools/sweeps/spread.h"

#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "core/text/parse.h"
#include "tools/sweeps/labels.h"

namespace photorque {
namespace {

using Eigen::ArrayXd, Eigen::MatrixXd;

ArrayXd centred(const std::vector<double>& values) {
  const ArrayXd all = Eigen::Map<const ArrayXd>(values.data(), std::ssize(values));
  return all - all.mean();
}

// The fractions of the variance of `values` that come from each of the `inputs`, by the straight
// lines that fit best together. All lists are centred; zero where the values do not vary.
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

}  // namespace photorque
