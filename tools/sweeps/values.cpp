#include "tools/sweeps/values.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/numerics/quadrature.h"
#include "core/numerics/random.h"
#include "core/numerics/root.h"
#include "core/text/format.h"
#include "scenes/experiment/document.h"
#include "tools/sweeps/keys.h"

namespace photorque {
namespace {

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

WeightedValues weighted_list(const Settings& axis) {
  WeightedValues all{listed_values(axis), {}};
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

std::vector<std::string> grid_values(const Settings& axis) {
  return axis.has(axis_key::values) ? listed_values(axis) : stepped_values(axis);
}

// Quantile of the standard normal distribution, by bisection to rounding errors.
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

WeightedValues mean_values(const Settings& axis) {
  if (axis.has(axis_key::values)) return weighted_list(axis);
  const double from = axis.get(axis_key::from), to = axis.get(axis_key::to);
  const auto count = axis.get(axis_key::nodes);
  WeightedValues all;
  for (const QuadratureNode& node : gauss_legendre(static_cast<size_t>(count))) {
    all.values.push_back(toml_number(0.5 * (from + to) + 0.5 * (to - from) * node.x));
    all.weights.push_back(0.5 * node.weight);
  }
  return all;
}

}  // namespace photorque
