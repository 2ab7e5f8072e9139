#include "tools/tasks/sweep_design.h"

#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

#include "core/numerics/root.h"
#include "core/numerics/sobol.h"

namespace photorque {
namespace {

constexpr size_t max_designs = 1000000;

std::string toml_number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.15g", value);
  return text;
}

std::vector<std::string> listed_values(const Settings& axis) {
  const auto* items = std::get_if<SettingsNode::Array>(&axis.raw("values").value);
  if (items == nullptr || items->empty()) {
    throw axis.error("values", describe(axis.raw("values")), "an array of at least one value");
  }
  std::vector<std::string> values;
  for (const SettingsNode& item : *items) {
    if (item.is_table()) throw axis.error("values", describe(item), "a number, a text, an array");
    values.push_back(toml_text(item));
  }
  return values;
}

std::vector<std::string> stepped_values(const Settings& axis) {
  const double from = axis.number("from"), to = axis.number("to");
  const auto count = axis.integer("count", 2, static_cast<int64_t>(max_designs));
  const bool logarithmic = axis.choice_or("spacing", {"linear", "logarithmic"}, 0) == 1;
  if (logarithmic && !(from > 0.0 && to > 0.0)) {
    throw axis.error("spacing",
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

// Where the standard normal distribution reaches `fraction`; by bisection, to rounding.
double normal_quantile(double fraction) {
  const auto too_low = [&](double x) {
    return 0.5 * std::erfc(-x / std::numbers::sqrt2) < fraction;
  };
  return bisect(-10.0, 10.0, too_low, {60}).middle();
}

// `fractions` are uniform in (0, 1).
std::vector<std::string> random_values(const Settings& axis, const std::vector<double>& fractions) {
  std::vector<std::string> values;
  if (axis.has("mean")) {
    const double mean = axis.number("mean"), sigma = axis.number("sigma", Range::positive());
    for (const double u : fractions)
      values.push_back(toml_number(mean + sigma * normal_quantile(u)));
  } else {
    const double from = axis.number("from"), to = axis.number("to");
    for (const double u : fractions) values.push_back(toml_number(from + u * (to - from)));
  }
  return values;
}

std::vector<double> sobol_column(uint64_t seed, size_t axis, size_t designs) {
  const SobolSequence sequence({seed, 0, static_cast<uint32_t>(axis / sobol_dimensions)});
  std::vector<double> column;
  for (size_t i = 0; i < designs; ++i) {
    column.push_back(sequence.point(static_cast<uint32_t>(i))[axis % sobol_dimensions]);
  }
  return column;
}

}  // namespace

std::string toml_text(const SettingsNode& node) {
  if (const auto* flag = std::get_if<bool>(&node.value)) return *flag ? "true" : "false";
  if (const auto* whole = std::get_if<int64_t>(&node.value)) return std::to_string(*whole);
  if (const auto* real = std::get_if<double>(&node.value)) return toml_number(*real);
  if (const auto* text = std::get_if<std::string>(&node.value)) {
    std::string quoted = "\"";
    for (const char c : *text) {
      if (c == '"' || c == '\\') quoted += '\\';
      quoted += c;
    }
    return quoted + '"';
  }
  std::string items;
  if (const auto* array = std::get_if<SettingsNode::Array>(&node.value)) {
    for (const SettingsNode& item : *array) items += (items.empty() ? "" : ", ") + toml_text(item);
  }
  return "[" + items + "]";
}

size_t SweepPlan::designs() const {
  if (!grid) return axes.front().values.size();
  size_t count = 1;
  for (const SweepAxis& axis : axes) count *= axis.values.size();
  return count;
}

const std::string& SweepPlan::value(size_t design, size_t axis) const {
  if (!grid) return axes[axis].values[design];
  size_t below = 1;
  for (size_t i = axis + 1; i < axes.size(); ++i) below *= axes[i].values.size();
  return axes[axis].values[design / below % axes[axis].values.size()];
}

std::vector<std::string> SweepPlan::overrides(size_t design) const {
  std::vector<std::string> all;
  for (size_t i = 0; i < axes.size(); ++i) all.push_back(axes[i].key + "=" + value(design, i));
  return all;
}

SweepPlan read_sweep_plan(const Settings& sweep) {
  SweepPlan plan;
  plan.verb = sweep.text_or("verb", "power");
  if (sweep.has("figures")) plan.figures = sweep.texts("figures");
  plan.grid = !sweep.has("designs");
  const auto random =
      plan.grid ? 0 : sweep.integer("designs", 2, static_cast<int64_t>(max_designs));
  const auto seed =
      plan.grid ? 0 : sweep.integer_or("seed", 1, 0, std::numeric_limits<int64_t>::max());
  double designs = 1.0;
  for (const Settings& axis : sweep.tables("axis")) {
    SweepAxis read{axis.text("key"), {}};
    if (!plan.grid) {
      const auto column =
          sobol_column(static_cast<uint64_t>(seed), plan.axes.size(), static_cast<size_t>(random));
      read.values = random_values(axis, column);
    } else {
      read.values = axis.has("values") ? listed_values(axis) : stepped_values(axis);
      designs *= static_cast<double>(read.values.size());
    }
    if (read.key.starts_with("sweep")) throw axis.error("key", read.key, "a key outside [sweep]");
    plan.axes.push_back(std::move(read));
  }
  if (plan.axes.empty()) throw sweep.error("axis", "none", "at least one [[sweep.axis]]");
  if (designs > static_cast<double>(max_designs)) {
    throw sweep.error("axis", toml_number(designs) + " designs",
                      "at most " + std::to_string(max_designs));
  }
  sweep.finish();
  return plan;
}

}  // namespace photorque
