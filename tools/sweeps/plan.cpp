#include "tools/sweeps/plan.h"

#include <algorithm>

#include "tools/sweeps/keys.h"
#include "tools/sweeps/values.h"

namespace photorque {
namespace {

std::string outside_sweep(const Settings& axis) {
  std::string key = axis.get(axis_key::key);
  if (key.starts_with("sweep")) throw axis.error(axis_key::key, key, "a key outside [sweep]");
  return key;
}

SweepFigure read_figure(const Settings& table, std::string_view key, const std::string& text) {
  const bool absolute = text.starts_with('|') && text.ends_with('|') && text.size() > 2;
  SweepFigure figure{absolute ? text.substr(1, text.size() - 2) : text, absolute};
  if (figure.name.empty() || figure.name.find('|') != std::string::npos) {
    throw table.error(key, '"' + text + '"', "the name of a figure, or |NAME|");
  }
  return figure;
}

// A text or an array of texts.
std::vector<std::string> texts_or_text(const Settings& table, std::string_view key) {
  if (!table.has(key)) return {};
  if (table.raw(key).is_array()) return table.texts(key);
  return {table.text(key)};
}

std::vector<Objective> read_objectives(const Settings& sweep) {
  std::vector<Objective> all;
  for (const bool maximise : {true, false}) {
    const OtherKey& key = maximise ? sweep_key::maximise : sweep_key::minimise;
    for (const std::string& text : texts_or_text(sweep, key)) {
      all.push_back({read_figure(sweep, key, text), maximise});
    }
  }
  for (size_t i = 0; i < all.size(); ++i) {
    for (size_t k = 0; k < i; ++k) {
      if (all[i].figure.column() != all[k].figure.column()) continue;
      throw sweep.error(sweep_key::minimise, '"' + all[i].figure.name + "\" twice",
                        "every figure once");
    }
  }
  return all;
}

std::vector<Constraint> read_constraints(const Settings& sweep) {
  std::vector<Constraint> all;
  for (const Settings& table : sweep.get(sweep_key::constraint)) {
    Constraint one{read_figure(table, constraint_key::figure, table.get(constraint_key::figure))};
    // The limits are not converted, because the unit of a figure is in its name.
    if (!table.has(constraint_key::at_least) && !table.has(constraint_key::at_most)) {
      throw table.error(constraint_key::at_least, "neither at_least nor at_most",
                        "one of them, or both");
    }
    one.at_least = table.get_or(constraint_key::at_least, one.at_least);
    one.at_most = table.get_or(constraint_key::at_most, one.at_most);
    if (one.at_least > one.at_most) {
      throw table.error(constraint_key::at_most, toml_number(one.at_most),
                        "at least at_least, " + toml_number(one.at_least));
    }
    all.push_back(std::move(one));
  }
  return all;
}

SweepAxis read_axis(const Settings& table, const SweepPlan& plan, uint64_t seed, size_t designs) {
  SweepAxis axis{table.get(axis_key::key)};
  const bool range_alone = plan.grid && !table.has(axis_key::values) &&
                           !table.has(axis_key::count) && table.has(axis_key::from);
  if (!range_alone) {
    axis.values =
        plan.grid ? grid_values(table) : random_values(table, seed, plan.axes.size(), designs);
  }
  axis.name = table.get(axis_key::name);
  if (table.has(axis_key::from) && table.has(axis_key::to)) {
    axis.low = std::min(table.get(axis_key::from), table.get(axis_key::to));
    axis.high = std::max(table.get(axis_key::from), table.get(axis_key::to));
  }
  outside_sweep(table);
  return axis;
}

// Identifier of a key's quantity, independent of its unit.
std::string quantity_of(const std::string& key) {
  const size_t dot = key.rfind('.');
  const size_t name = dot == std::string::npos ? 0 : dot + 1;
  return key.substr(0, name) + unit_of_key(key.substr(name)).stem;
}

void require_distinct_keys(const Settings& sweep, const SweepPlan& plan) {
  std::vector<std::string> keys;
  for (const SweepAxis& axis : plan.axes) keys.push_back(axis.key);
  for (const MeanOver& mean : plan.mean_over) keys.push_back(mean.key);
  for (const WorstOver& worst : plan.worst_over) keys.push_back(worst.key);
  std::ranges::sort(keys, {}, quantity_of);
  const auto twice = std::ranges::adjacent_find(keys, {}, quantity_of);
  if (twice == keys.end()) return;
  const std::string& other = *(twice + 1);
  throw sweep.error(sweep_key::axis,
                    '"' + *twice + (*twice == other ? "\" twice" : "\" and \"" + other + '"'),
                    "every quantity once");
}

void read_within(const Settings& sweep, SweepPlan& plan) {
  for (const Settings& table : sweep.get(sweep_key::mean_over)) {
    WeightedValues all = mean_values(table);
    plan.mean_over.push_back({outside_sweep(table), std::move(all.values), std::move(all.weights)});
  }
  for (const Settings& table : sweep.get(sweep_key::worst_over)) {
    plan.worst_over.push_back({outside_sweep(table), grid_values(table)});
  }
  if (!plan.worst_over.empty() && plan.objectives.empty() && plan.constraints.empty()) {
    throw sweep.error(sweep_key::worst_over, "no objective and no constraint",
                      "maximise, minimise or a [[sweep.constraint]]");
  }
}

Tolerance read_tolerance(const Settings& table) {
  Tolerance one{outside_sweep(table)};
  const bool normal = table.has(axis_key::sigma), uniform = table.has(axis_key::half_width);
  const bool seed = table.get(axis_key::seed);
  if (normal + uniform + seed != 1) {
    throw table.error(axis_key::sigma,
                      std::to_string(normal + uniform + seed) +
                          " of sigma, half_width, "
                          "seed",
                      "one of them");
  }
  if (seed) {
    one.law = Tolerance::Law::seed;
    return one;
  }
  one.law = normal ? Tolerance::Law::normal : Tolerance::Law::uniform;
  one.width = table.get(normal ? axis_key::sigma : axis_key::half_width);
  one.relative = table.get(axis_key::relative);
  return one;
}

BuiltCopies read_built(const Settings& sweep) {
  BuiltCopies built;
  for (const Settings& table : sweep.get(sweep_key::tolerance)) {
    built.tolerances.push_back(read_tolerance(table));
  }
  if (built.tolerances.empty()) return built;
  built.copies = static_cast<size_t>(sweep.get(sweep_key::built_copies));
  built.fraction = sweep.get_or(sweep_key::built_fraction, built.fraction);
  built.of_every = sweep.get(sweep_key::built_of) == 1;
  built.seed = static_cast<uint64_t>(sweep.get(sweep_key::built_seed));
  return built;
}

SearchPlan read_search(const Settings& sweep) {
  SearchPlan search;
  search.global = static_cast<size_t>(sweep.get(sweep_key::global));
  search.local = static_cast<size_t>(sweep.get(sweep_key::local));
  search.precision = sweep.get_or(sweep_key::precision, search.precision);
  return search;
}

}  // namespace

std::string missing_search_keys(const SweepPlan& plan) {
  if (plan.objectives.empty()) return "maximise or minimise";
  for (const SweepAxis& axis : plan.axes) {
    if (!axis.low || !axis.high || !(*axis.low < *axis.high)) {
      return "from and to of the axis " + axis.key + ", one below the other";
    }
  }
  return "";
}

namespace {

template <class Axis>
size_t combinations(const std::vector<Axis>& axes) {
  size_t count = 1;
  for (const Axis& axis : axes) count *= axis.values.size();
  return count;
}

}  // namespace

size_t SweepPlan::designs() const {
  return grid ? combinations(axes) : axes.front().values.size();
}

size_t SweepPlan::place(size_t design, size_t axis) const {
  if (!grid) return design;
  size_t below = 1;
  for (size_t i = axis + 1; i < axes.size(); ++i) below *= axes[i].values.size();
  return design / below % axes[axis].values.size();
}

const std::string& SweepPlan::value(size_t design, size_t axis) const {
  return axes[axis].values[place(design, axis)];
}

Changes SweepPlan::overrides(size_t design) const {
  Changes all;
  for (size_t i = 0; i < axes.size(); ++i) all.push_back(axes[i].key + "=" + value(design, i));
  return all;
}

size_t SweepPlan::mean_points() const {
  return combinations(mean_over);
}

size_t SweepPlan::worst_points() const {
  return combinations(worst_over);
}

std::vector<double> SweepPlan::mean_weights() const {
  std::vector<double> all{1.0};
  for (const MeanOver& mean : mean_over) {
    std::vector<double> finer;
    for (const double outer : all) {
      for (const double weight : mean.weights) finer.push_back(outer * weight);
    }
    all = std::move(finer);
  }
  return all;
}

std::vector<Changes> SweepPlan::runs_of(const Changes& design) const {
  std::vector<Changes> all{design};
  const auto spread = [&all](const std::string& key, const std::vector<std::string>& values) {
    std::vector<Changes> finer;
    for (const Changes& outer : all) {
      for (const std::string& value : values) {
        finer.push_back(outer);
        finer.back().push_back(key + "=" + value);
      }
    }
    all = std::move(finer);
  };
  for (const WorstOver& worst : worst_over) spread(worst.key, worst.values);
  for (const MeanOver& mean : mean_over) spread(mean.key, mean.values);
  return all;
}

std::string SweepPlan::built_column(const SweepFigure& figure) const {
  const double percent = 100.0 * built.fraction;
  std::string text = toml_number(percent);
  std::ranges::replace(text, '.', '_');
  return "p" + text + "_" + figure.column();
}

std::string SweepPlan::judged_column(const Objective& objective) const {
  return built.of_every ? built_column(objective.figure) : objective.figure.column();
}

SweepPlan read_sweep_plan(const Settings& sweep) {
  SweepPlan plan;
  plan.verb = sweep.get(sweep_key::verb);
  if (sweep.has(sweep_key::figures)) plan.figures = sweep.get(sweep_key::figures);
  plan.grid = !sweep.has(sweep_key::designs);
  const auto random = plan.grid ? 0 : sweep.get(sweep_key::designs);
  const auto seed = plan.grid ? 0 : sweep.get(sweep_key::seed);
  double runs = 1.0;
  for (const Settings& table : sweep.get(sweep_key::axis)) {
    plan.axes.push_back(
        read_axis(table, plan, static_cast<uint64_t>(seed), static_cast<size_t>(random)));
    if (plan.grid) runs *= static_cast<double>(std::max<size_t>(1, plan.axes.back().values.size()));
  }
  if (plan.axes.empty()) throw sweep.error(sweep_key::axis, "none", "at least one [[sweep.axis]]");
  plan.objectives = read_objectives(sweep);
  plan.constraints = read_constraints(sweep);
  read_within(sweep, plan);
  plan.built = read_built(sweep);
  if (!plan.built.tolerances.empty() && plan.objectives.empty()) {
    throw sweep.error("tolerance", "no objective for the built copies", "maximise or minimise");
  }
  plan.search = read_search(sweep);
  require_distinct_keys(sweep, plan);
  if (!plan.grid) runs = static_cast<double>(random);
  runs *= static_cast<double>(plan.mean_points() * plan.worst_points());
  if (plan.built.of_every) runs *= static_cast<double>(plan.built.copies + 1);
  if (runs > static_cast<double>(max_designs)) {
    throw sweep.error(sweep_key::axis, toml_number(runs) + " runs",
                      "at most " + std::to_string(max_designs));
  }
  sweep.finish();
  return plan;
}

Key sweep_table() {
  using namespace axis_key;
  const std::vector<Key> grid = {axis_key::values, from, to, count, spacing};
  const Key axis = sweep_key::axis.of(joined({{key, name}, grid, {mean, sigma}}));
  const Key mean_over =
      sweep_key::mean_over.of({key, axis_key::values.meaning("numbers; *or*"), weights,
                               from.meaning("start of an interval for the Gauss–Legendre rule"),
                               to.meaning("end of the interval"), nodes});
  const Key worst_over = sweep_key::worst_over.of(joined({{key}, grid}));
  const Key tolerance =
      sweep_key::tolerance.of({key, sigma.meaning("normal with this standard deviation; *or*"),
                               half_width, seed, relative});
  const Key constraint = sweep_key::constraint.of(
      {constraint_key::figure, constraint_key::at_least, constraint_key::at_most});
  using namespace sweep_key;
  return sweep.of({verb, figures, maximise, minimise, designs, sweep_key::seed, axis, mean_over,
                   worst_over, constraint, tolerance, built_copies,
                   built_fraction.with_default(BuiltCopies{}.fraction), built_of, built_seed,
                   global, local, precision.with_default(SearchPlan{}.precision)});
}

}  // namespace photorque
