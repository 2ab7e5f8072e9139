#include "tools/sweeps/evaluator.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "scenes/experiment/uncertain.h"

namespace photorque {
namespace {

std::vector<double> values_of(std::span<const Design> copies, const std::string& column) {
  std::vector<double> values;
  for (const Design& copy : copies) {
    const auto value = figure_of(copy, column);
    values.push_back(value ? value->value : std::numeric_limits<double>::quiet_NaN());
  }
  return values;
}

}  // namespace

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

DesignEvaluator::DesignEvaluator(const SweepPlan& plan, RunEngine& engine)
    : plan_(plan), engine_(engine) {
  if (!plan.built.tolerances.empty()) {
    tolerances_ = std::make_unique<Tolerances>(plan.built, engine.identity());
  }
}

std::vector<Changes> DesignEvaluator::copies_of(const Changes& design) const {
  std::vector<Changes> all;
  for (size_t copy = 0; copy < plan_.built.copies; ++copy) {
    all.push_back(tolerances_->built(design, copy));
  }
  return all;
}

size_t DesignEvaluator::runs_each() const {
  return plan_.mean_points() * plan_.worst_points();
}

std::vector<Changes> DesignEvaluator::runs_of(std::span<const Changes> designs) const {
  std::vector<Changes> all;
  for (const Changes& design : designs) {
    std::ranges::move(plan_.runs_of(design), std::back_inserter(all));
    if (!plan_.built.of_every || !tolerances_) continue;
    for (const Changes& copy : copies_of(design)) {
      std::ranges::move(plan_.runs_of(copy), std::back_inserter(all));
    }
  }
  return all;
}

Design DesignEvaluator::with_built(Design design, std::span<const Design> copies) const {
  if (!design.error.empty()) return design;
  for (const Objective& objective : plan_.objectives) {
    const auto reached = reached_by(plan_.built.fraction, objective.maximise,
                                    values_of(copies, objective.figure.column()));
    if (!reached) return {{}, "too many built copies fail: " + copies.front().error, false};
    design.figures.push_back({FigureName(plan_.built_column(objective.figure)), *reached});
  }
  return design;
}

std::vector<Design> DesignEvaluator::designs_of(std::span<const RunOutcome> outcomes) const {
  const bool with_copies = plan_.built.of_every && tolerances_;
  const size_t copies = with_copies ? plan_.built.copies : 0;
  std::vector<Design> all;
  for (size_t at = 0; at < outcomes.size();) {
    std::vector<Design> group;
    for (size_t k = 0; k <= copies; ++k, at += runs_each()) {
      group.push_back(combine(plan_, outcomes.subspan(at, runs_each())));
    }
    all.push_back(with_copies ? with_built(group.front(), std::span(group).subspan(1))
                              : std::move(group.front()));
  }
  return all;
}

std::vector<Design> DesignEvaluator::evaluate(std::span<const Changes> designs,
                                              const std::function<void(double)>& progress) {
  return designs_of(engine_.outcomes(runs_of(designs), progress));
}

std::vector<BuiltFigure> DesignEvaluator::build(const Changes& design,
                                                const std::function<void(double)>& progress) {
  std::vector<Changes> runs;
  for (const Changes& copy : copies_of(design)) {
    std::ranges::move(plan_.runs_of(copy), std::back_inserter(runs));
  }
  const std::vector<RunOutcome> outcomes = engine_.outcomes(runs, progress);
  std::vector<Design> copies;
  for (size_t at = 0; at < outcomes.size(); at += runs_each()) {
    copies.push_back(combine(plan_, std::span(outcomes).subspan(at, runs_each())));
  }
  std::vector<BuiltFigure> figures;
  for (const Objective& objective : plan_.objectives) {
    const std::string column = objective.figure.column();
    figures.push_back({column, values_of(copies, column)});
  }
  return figures;
}

}  // namespace photorque
