#include "tools/sweeps/tolerances.h"

#include <algorithm>
#include <cmath>

#include "scenes/experiment/uncertain.h"
#include "tools/sweeps/values.h"

namespace photorque {

Tolerances::Tolerances(const BuiltCopies& plan, const RunIdentity& identity) : identity_(identity) {
  size_t dimension = 0;
  for (const Tolerance& tolerance : plan.tolerances) {
    const SettingsNode start = identity.value({}, tolerance.key);
    const std::vector<double> values = plain_numbers(start);
    if (values.empty()) {
      throw InputError({}, "sweep.tolerance.key", '"' + tolerance.key + "\": " + describe(start),
                       "a key of a number or of numbers");
    }
    Drawn drawn{tolerance, {}};
    for (size_t i = 0; i < values.size() && tolerance.law != Tolerance::Law::seed; ++i) {
      std::vector<double> column = sobol_column(plan.seed, dimension++, plan.copies);
      for (double& u : column) {
        u = tolerance.law == Tolerance::Law::normal ? normal_quantile(u) : 2.0 * u - 1.0;
      }
      drawn.off.push_back(std::move(column));
    }
    drawn_.push_back(std::move(drawn));
  }
}

Changes Tolerances::built(const Changes& design, size_t copy) const {
  Changes all = design;
  for (const Drawn& drawn : drawn_) {
    const Tolerance& tolerance = drawn.tolerance;
    if (tolerance.law == Tolerance::Law::seed) {
      all.push_back(tolerance.key + "=" + std::to_string(copy + 1));
      continue;
    }
    const SettingsNode start = identity_.value(design, tolerance.key);
    const std::vector<double> values = plain_numbers(start);
    std::string text;
    for (size_t i = 0; i < std::min(values.size(), drawn.off.size()); ++i) {
      const double width = tolerance.width * (tolerance.relative ? values[i] : 1.0);
      text += (i > 0 ? ", " : "") + toml_number(values[i] + width * drawn.off[i][copy]);
    }
    all.push_back(tolerance.key + "=" + (start.is_array() ? "[" + text + "]" : text));
  }
  return all;
}

std::optional<Estimate> reached_by(double fraction, bool maximise, std::vector<double> values) {
  // Sort from the worst value, with larger values better.
  for (double& v : values) {
    if (!maximise) v = -v;
    if (std::isnan(v)) v = -std::numeric_limits<double>::infinity();
  }
  std::ranges::sort(values);
  const double n = static_cast<double>(values.size());
  constexpr double rounding = 1e-9;
  const auto place = static_cast<size_t>(std::floor(n * (1.0 - fraction) + rounding));
  const auto away = static_cast<size_t>(std::ceil(std::sqrt(n * fraction * (1.0 - fraction))));
  const double reached = values[std::min(place, values.size() - 1)];
  const double low = values[place > away ? place - away : 0];
  const double high = values[std::min(place + away, values.size() - 1)];
  if (std::isinf(reached)) return std::nullopt;
  const double error = std::isinf(low) ? high - reached : 0.5 * (high - low);
  return Estimate{maximise ? reached : -reached, error};
}

}  // namespace photorque
