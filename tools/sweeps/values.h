// Values of a key in a sweep, as TOML text.
#pragma once

#include <string>
#include <vector>

#include "core/settings/settings.h"

namespace photorque {

inline constexpr size_t max_designs = 1000000;

// A number with 15 digits, which removes the rounding residue of its binary form.
std::string toml_number(double value);

// A value as TOML text, with its numbers by toml_number().
std::string toml_text(const SettingsNode& node);

// Values of a grid axis: `values = […]`, or `from`, `to`, `count` (and `spacing`), including both
// ends.
std::vector<std::string> grid_values(const Settings& axis);

// Values of an axis (`from` and `to`, or `mean` and `sigma`) in a random plan. Owen-scrambled Sobol
// points; every `axis` has a separate dimension.
std::vector<std::string> random_values(const Settings& axis, uint64_t seed, size_t number,
                                       size_t designs);

// Sobol points of one dimension in (0, 1), and quantiles of the standard normal distribution.
std::vector<double> sobol_column(uint64_t seed, size_t dimension, size_t count);
double normal_quantile(double fraction);

// Values with weights that sum to one: `values` with `weights` (equal by default), or the nodes of
// the Gauss–Legendre rule with `count` nodes between `from` and `to`.
struct WeightedValues {
  std::vector<std::string> values;
  std::vector<double> weights;
};
WeightedValues mean_values(const Settings& axis);

}  // namespace photorque
