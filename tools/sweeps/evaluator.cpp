#include "tools/sweeps/evaluator.h"

#include <algorithm>
#include <iterator>

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
