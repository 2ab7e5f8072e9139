// photorque optimise: the best design over continuous keys, without derivatives.
#include <algorithm>
#include <cmath>

#include "core/text/parse.h"
#include "tools/sweeps/optimiser.h"
#include "tools/sweeps/report.h"
#include "tools/verbs/studies.h"

namespace photorque::verbs::optimise {
namespace {

// Ranges of the axes of [sweep] as a box.
SearchBox box_of(const SweepPlan& plan) {
  SearchBox box;
  for (const SweepAxis& axis : plan.axes) {
    box.low.push_back(*axis.low);
    box.high.push_back(*axis.high);
  }
  return box;
}

// Start of the search: for each axis the value of the experiment, if it states one; otherwise the
// middle of the range.
std::vector<double> start_of(const SearchBox& box, const SweepPlan& plan,
                             const RunIdentity& identity) {
  std::vector<double> start;
  for (size_t i = 0; i < plan.axes.size(); ++i) {
    double value = 0.5 * (box.low[i] + box.high[i]);
    try {
      value = number_in(toml_text(identity.value({}, plan.axes[i].key))).value_or(value);
    } catch (const InputError&) {
      // Stated in another unit, or not stated.
    }
    start.push_back(std::clamp(value, box.low[i], box.high[i]));
  }
  return start;
}

class Search {
 public:
  Search(const CommandOptions& options, const std::vector<Verb>& verbs)
      : options_(options),
        console_(terminal(options)),
        file_(read_experiment_file(options.experiment, options.all_overrides())),
        plan_(read_study_plan(file_, verbs)),
        engine_(study_task(options, plan_, verbs, SweepFiles{options.out_folder()}.database())),
        evaluator_(plan_, engine_) {
    const std::string lacks = missing_search_keys(plan_);
    if (!lacks.empty()) throw file_.settings.error("sweep", "no plan of a search", lacks);
    // The search adds designs, so the plan is not a grid.
    plan_.grid = false;
    box_ = box_of(plan_);
    for (SweepAxis& axis : plan_.axes) axis.values.clear();
  }

  void run() {
    box_.start = start_of(box_, plan_, engine_.identity());
    const SearchPlan& search = plan_.search;
    const size_t all = search.global + search.local;
    console_.heading("At most " + std::to_string(all) + " designs by `" + plan_.verb + '`');
    progress_ = console_.progress("search");
    search_box(box_, search.global, search.local, search.precision,
               [this](std::span<const double> point) { return value_at(point); });
    const Changes none;
    result_.nominal = evaluator_.evaluate({&none, 1}).front();
    console_.done();
    console_.line("  " + std::to_string(result_.designs.size()) + " designs; " +
                  std::to_string(engine_.made()) + " runs now, " + std::to_string(engine_.kept()) +
                  " kept from before");
    print_broken_at_start();
    print_limits();
    const bool all_failed =
        std::ranges::none_of(result_.designs, [](const Design& d) { return d.error.empty(); });
    if (all_failed) {
      throw_failed_study(options_, {{}, 2, result_.designs.front().error}, 0,
                         result_.designs.size());
    }
    Product more;
    more.plots.push_back(search_plot(plan_, result_));
    finish_study({options_, console_, file_, plan_, engine_, std::move(result_)}, true,
                 std::move(more));
  }

 private:
  PointValue value_at(std::span<const double> point) {
    Changes changes;
    for (size_t i = 0; i < point.size(); ++i) {
      plan_.axes[i].values.push_back(toml_number(point[i]));
      changes.push_back(plan_.axes[i].key + "=" + plan_.axes[i].values.back());
    }
    result_.designs.push_back(evaluator_.evaluate({&changes, 1}).front());
    const Design& design = result_.designs.back();
    const size_t all = std::max<size_t>(1, plan_.search.global + plan_.search.local);
    if (progress_) {
      progress_(
          std::min(1.0, static_cast<double>(result_.designs.size()) / static_cast<double>(all)));
    }
    PointValue value{!design.error.empty()};
    const auto merit = merit_of(plan_, plan_.objectives.front(), design);
    value.failed = value.failed || !merit;
    value.merit = merit.value_or(value.merit);
    for (const Constraint& constraint : plan_.constraints) {
      const auto figure = figure_of(design, constraint.figure.column());
      value.failed = value.failed || !figure;
      value.margins.push_back(figure ? relative_margin(constraint, figure->value) : -1.0);
    }
    return value;
  }

  // Prints the constraints that the experiment as written breaks: the search starts there.
  void print_broken_at_start() const {
    if (!result_.nominal) return;
    for (const Constraint& constraint : plan_.constraints) {
      const auto figure = figure_of(*result_.nominal, constraint.figure.column());
      if (!figure || relative_margin(constraint, figure->value) >= 0.0) continue;
      const bool is_low = figure->value < constraint.at_least;
      console_.line("  note: the experiment as written, where the search starts, has " +
                    constraint.figure.name + " = " + show(figure->value) +
                    ", and the constraint is " + (is_low ? "at least " : "at most ") +
                    show(is_low ? constraint.at_least : constraint.at_most));
    }
  }

  // Prints axes whose best value is at an end of the range: the optimum may be outside it.
  void print_limits() const {
    const Design* best = nullptr;
    const auto merit = [&](const Design& design) {
      return merit_of(plan_, plan_.objectives.front(), design).value_or(-1e300);
    };
    for (const Design& design : result_.designs) {
      if (design.error.empty() && (best == nullptr || merit(design) > merit(*best))) best = &design;
    }
    if (best == nullptr) return;
    const auto index = static_cast<size_t>(best - result_.designs.data());
    for (size_t i = 0; i < plan_.axes.size(); ++i) {
      const double at = std::stod(plan_.axes[i].values[index]);
      const double span = box_.high[i] - box_.low[i];
      if (std::min(at - box_.low[i], box_.high[i] - at) < 1e-3 * span) {
        console_.line("  note: the largest figure is at an end of the range of " +
                      plan_.axes[i].key + " (" + plan_.axes[i].values[index] +
                      "): widen the range if such designs can be built");
      }
    }
  }

  // Margin relative to the limit, so that constraints in different units have comparable weights.
  static double relative_margin(const Constraint& constraint, double value) {
    const auto part = [](double margin, double limit) {
      return std::isinf(limit) || limit == 0.0 ? margin : margin / std::abs(limit);
    };
    const double above = value - constraint.at_least, below = constraint.at_most - value;
    return std::min(part(above, constraint.at_least), part(below, constraint.at_most));
  }

  const CommandOptions& options_;
  Console console_;
  ExperimentFile file_;
  SweepPlan plan_;
  RunEngine engine_;
  DesignEvaluator evaluator_;
  SearchBox box_;
  SweepResult result_;
  std::function<void(double)> progress_;
};

void run(const CommandOptions& options, const Program& program) {
  Search(options, program.verbs).run();
}

}  // namespace

Verb kind() {
  return {"optimise",
          "Search for the best design within the axes of [sweep]",
          command_with(traced_options, run),
          {"sweep"},
          "[sweep]"};
}

}  // namespace photorque::verbs::optimise
