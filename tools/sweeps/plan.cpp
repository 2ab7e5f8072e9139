#include "tools/sweeps/plan.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/numerics/quadrature.h"
#include "core/numerics/random.h"
#include "core/numerics/root.h"
#include "core/text/format.h"
#include "scenes/experiment/document.h"

namespace photorque {
namespace {

// ---- Keys of [sweep]

constexpr size_t max_designs = 1000000;

// Keys of [[sweep.axis]], `mean_over`, `worst_over` and `tolerance`.
namespace axis_key {
constexpr auto most_designs = static_cast<int64_t>(max_designs);

constexpr TextKey key(
    "key",
    "any key outside `[sweep]`, as in `--set`: `source[0].power_W`, `source[0].position_m[2]`");
constexpr TextKey name("name", "", "name of the axis in pictures, such as `\"standoff\"`");
constexpr OtherKey values("values", Key::an_array,
                          "list of the values (numbers, strings or arrays); *or*",
                          {.optional = true});
constexpr NumbersKey weights("weights", Range::not_negative(), "weight of each value",
                             {.usually = "equal"});
constexpr NumberKey from(
    "from", {},
    "first value, in the unit of `key`; a random plan draws uniformly between `from` and `to`",
    {.optional = true});
constexpr NumberKey to("to", {}, "last value", {.optional = true});
constexpr IntegerKey count(
    "count", 2, most_designs,
    "number of values including both ends; not used in a random plan or by `optimise`",
    {.optional = true});
constexpr IntegerKey nodes(
    "count", 1, static_cast<int64_t>(max_gauss_nodes),
    "number of Gauss–Legendre points; exact for polynomials of degree 2 `count` − 1",
    {.optional = true});
constexpr ChoiceKey spacing("spacing",
                            {{"linear", "equal steps"},
                             {"logarithmic", "equal factors, ends above 0"}},
                            0, "spacing of the values");
constexpr NumberKey mean("mean", {}, "mean of a normal distribution in a random plan, with `sigma`",
                         {.optional = true});
constexpr NumberKey sigma("sigma", Range::positive(), "standard deviation", {.optional = true});
constexpr NumberKey half_width("half_width", Range::positive(), "uniform within ± this; *or*",
                               {.optional = true});
constexpr FlagKey seed(
    "seed", false,
    "true: the key is set to the number of the copy (1, 2, …), such as `source[0].spread_seed` for "
    "LEDs with `power_spread` and `aim_spread_deg`");
constexpr FlagKey relative("relative", false,
                           "true: `sigma` and `half_width` are fractions of the value");
}  // namespace axis_key

namespace constraint_key {
constexpr TextKey figure("figure", "a name in `summary.json`, or `\"\\|NAME\\|\"`");
constexpr NumberKey at_least("at_least", {}, "lower limit, in the unit of the figure",
                             {.usually = "none"});
constexpr NumberKey at_most("at_most", {}, "upper limit, in the unit of the figure",
                            {.usually = "none"});
}  // namespace constraint_key

namespace sweep_key {
constexpr TextKey verb("verb", "power",
                       "command of every design: `trace`, `power`, `torque-map`, `budget`, "
                       "`balance`, `propagate`, `fit-cell`");
constexpr TextsKey figures(
    "figures",
    "names of figures in `summary.json`, which become columns of `sweep.csv` and are plotted",
    {.usually = "all"});
constexpr OtherKey maximise(
    "maximise", Key::a_text | Key::an_array,
    "one or several figures to maximise; `\"\\|NAME\\|\"` is the absolute value of a figure. The "
    "first objective ranks the designs, several give the Pareto front",
    {.optional = true});
constexpr OtherKey minimise("minimise", Key::a_text | Key::an_array,
                            "figures to minimise, as in `maximise`", {.optional = true});
constexpr IntegerKey designs("designs", 2, axis_key::most_designs,
                             "number of points of a random plan (Owen-scrambled Sobol sequence)",
                             {.usually = "a grid"});
constexpr IntegerKey seed("seed", 1, 0, INT64_MAX,
                          "seed of a random plan (`--seed` is that of the rays)");
constexpr TablesKey axis("axis", "axes of the plan, at least one; the last varies fastest");
constexpr TablesKey mean_over(
    "mean_over",
    "key that takes several values within each design; the figures are means over these");
constexpr TablesKey worst_over(
    "worst_over",
    "key that takes the values of a grid axis within each design. Objectives and constrained "
    "figures are taken at their worst value, other figures where the first objective (else the "
    "first constrained figure) is worst");
constexpr TablesKey constraint("constraint",
                               "limit of a figure, required at every value of `worst_over`");
constexpr TablesKey tolerance(
    "tolerance", "a manufacturing tolerance: every number of the key has a separate random error");
constexpr IntegerKey built_copies("built_copies", 100, 2, 100000,
                                  "copies of a design, each with its own draws; the n-th "
                                  "copy has the same draws in every design");
constexpr NumberKey built_fraction("built_fraction", {0.5, 1.0, false, true},
                                   "fraction of the copies that reach the stated value",
                                   {.optional = true});
constexpr ChoiceKey built_of("built_of",
                             {{"best", "copies of the best and the nominal design"},
                              {"every",
                               "copies of every design; designs are then ranked by the "
                               "value that the fraction reaches (column `p95_FIGURE`)"}},
                             0, "designs of which copies are computed");
constexpr IntegerKey built_seed("built_seed", 1, 0, INT64_MAX, "seed of the random copies");
constexpr IntegerKey global("global", 100, 0, 100000,
                            "`optimise`: number of evaluations of the global search");
constexpr IntegerKey local("local", 100, 0, 100000,
                           "number of evaluations of the local search from the best of these");
constexpr NumberKey precision(
    "precision", {1e-8, 0.1},
    "`optimise`: step at which the search ends, relative to the range of each axis",
    {.optional = true});
constexpr TableKey sweep("sweep", "one command over many designs");
}  // namespace sweep_key

// ---- Values of a key, as TOML text

bool is_finite(const SettingsNode& node) {
  const auto* real = std::get_if<double>(&node.value);
  const auto* items = std::get_if<SettingsNode::Array>(&node.value);
  return (real == nullptr || std::isfinite(*real)) &&
         (items == nullptr || std::ranges::all_of(*items, is_finite));
}

std::vector<std::string> listed_values(const Settings& axis) {
  const auto* items = std::get_if<SettingsNode::Array>(&axis.raw(axis_key::values).value);
  if (items == nullptr || items->empty()) {
    throw axis.error(axis_key::values, describe(axis.raw(axis_key::values)),
                     "an array of at least one value");
  }
  std::vector<std::string> values;
  for (const SettingsNode& item : *items) {
    if (item.is_table())
      throw axis.error(axis_key::values, describe(item), "a number, a text, an array");
    if (!is_finite(item)) throw axis.error(axis_key::values, toml_text(item), "finite numbers");
    values.push_back(toml_text(item));
  }
  return values;
}

std::vector<std::string> stepped_values(const Settings& axis) {
  const double from = axis.get(axis_key::from), to = axis.get(axis_key::to);
  const auto count = axis.get(axis_key::count);
  const bool logarithmic = axis.get(axis_key::spacing) == 1;
  if (logarithmic && !(from > 0.0 && to > 0.0)) {
    throw axis.error(axis_key::spacing,
                     "\"logarithmic\" from " + toml_number(from) + " to " + toml_number(to),
                     "ends above zero");
  }
  std::vector<std::string> values;
  for (int64_t i = 0; i < count; ++i) {
    const double fraction = static_cast<double>(i) / static_cast<double>(count - 1);
    values.push_back(toml_number(logarithmic ? from * std::pow(to / from, fraction)
                                             : from + fraction * (to - from)));
  }
  return values;
}

MeanOver weighted_list(const Settings& axis) {
  MeanOver all{"", listed_values(axis), {}};
  if (axis.has(axis_key::weights)) {
    all.weights = axis.get(axis_key::weights);
  } else {
    all.weights.assign(all.values.size(), 1.0);
  }
  const double sum = std::accumulate(all.weights.begin(), all.weights.end(), 0.0);
  if (all.weights.size() != all.values.size() || !(sum > 0.0)) {
    throw axis.error(
        axis_key::weights,
        std::to_string(all.weights.size()) + " numbers of sum " + toml_number(sum),
        "a number for each of " + std::to_string(all.values.size()) + " values, not all zero");
  }
  for (double& weight : all.weights) weight /= sum;
  return all;
}

// Values of a grid axis: `values = […]`, or `from`, `to`, `count` (and `spacing`), including both
// ends.
std::vector<std::string> grid_values(const Settings& axis) {
  return axis.has(axis_key::values) ? listed_values(axis) : stepped_values(axis);
}

// Values of an axis (`from` and `to`, or `mean` and `sigma`) in a random plan. Owen-scrambled Sobol
// points; every `axis` has a separate dimension.
std::vector<std::string> random_values(const Settings& axis, uint64_t seed, size_t number,
                                       size_t designs) {
  if (axis.has(axis_key::values)) {
    throw axis.error(axis_key::values, "a list, in a plan with random designs",
                     "from and to, or mean and sigma; or a grid, without designs");
  }
  const std::vector<double> fractions = sobol_column(seed, number, designs);
  std::vector<std::string> values;
  if (axis.has(axis_key::mean)) {
    const double mean = axis.get(axis_key::mean), sigma = axis.get(axis_key::sigma);
    for (const double u : fractions) {
      values.push_back(toml_number(mean + sigma * normal_quantile(u)));
    }
  } else {
    const double from = axis.get(axis_key::from), to = axis.get(axis_key::to);
    for (const double u : fractions) values.push_back(toml_number(from + u * (to - from)));
  }
  return values;
}

// Values with weights that sum to one: `values` with `weights` (equal by default), or the nodes of
// the Gauss–Legendre rule with `count` nodes between `from` and `to`.
MeanOver mean_values(const Settings& axis) {
  if (axis.has(axis_key::values)) return weighted_list(axis);
  const double from = axis.get(axis_key::from), to = axis.get(axis_key::to);
  const auto count = axis.get(axis_key::nodes);
  MeanOver all;
  for (const QuadratureNode& node : gauss_legendre(static_cast<size_t>(count))) {
    all.values.push_back(toml_number(0.5 * (from + to) + 0.5 * (to - from) * node.x));
    all.weights.push_back(0.5 * node.weight);
  }
  return all;
}

// ---- The plan

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
    plan.mean_over.push_back(mean_values(table));
    plan.mean_over.back().key = outside_sweep(table);
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

std::string toml_number(double value) {
  return printed("%.15g", value);
}

std::string toml_text(const SettingsNode& node) {
  if (const auto* real = std::get_if<double>(&node.value)) return toml_number(*real);
  const auto* array = std::get_if<SettingsNode::Array>(&node.value);
  if (array == nullptr) return toml_value(node);
  return "[" + joined_text(*array, ", ", toml_text) + "]";
}

// By bisection to rounding errors.
double normal_quantile(double fraction) {
  const auto too_low = [&](double x) {
    return 0.5 * std::erfc(-x / std::numbers::sqrt2) < fraction;
  };
  return bisect(-10.0, 10.0, too_low, {60}).middle();
}

std::vector<double> sobol_column(uint64_t seed, size_t dimension, size_t count) {
  const SobolSequence sequence({seed, 0, static_cast<uint32_t>(dimension / sobol_dimensions)});
  std::vector<double> column;
  for (size_t i = 0; i < count; ++i) {
    column.push_back(sequence.point(static_cast<uint32_t>(i))[dimension % sobol_dimensions]);
  }
  return column;
}

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
