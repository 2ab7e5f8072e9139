#include "tools/sweeps/report.h"

#include <algorithm>
#include <cmath>

#include "core/text/parse.h"
#include "tools/sweeps/labels.h"

namespace photorque {
namespace {

double value_or_nothing(const Design& design, const std::string& column) {
  const auto value = figure_of(design, column);
  return value ? value->value : std::nan("");
}

// Values of an axis as numbers; empty if one of them is not a number.
std::vector<double> axis_numbers(const SweepAxis& axis) {
  std::vector<double> all;
  for (const std::string& text : axis.values) {
    const auto number = number_in(text);
    if (!number) return {};
    all.push_back(*number);
  }
  return all;
}

// Whether there are at least three values in equal steps, as a map requires.
bool is_even(const std::vector<double>& values) {
  if (values.size() < 3) return false;
  const double step = (values.back() - values.front()) / static_cast<double>(values.size() - 1);
  for (size_t i = 0; i < values.size(); ++i) {
    const double even = values.front() + step * static_cast<double>(i);
    if (std::abs(values[i] - even) > 1e-6 * std::abs(step)) return false;
  }
  return step > 0.0;
}

// The objective that uses a figure; null if there is none.
const Objective* objective_of(const SweepPlan& plan, const std::string& column) {
  const auto at = std::ranges::find_if(plan.objectives, [&](const Objective& o) {
    return o.figure.column() == column || plan.judged_column(o) == column;
  });
  return at == plan.objectives.end() ? nullptr : &*at;
}

// Map over two axes of a grid. With more axes, each point is the best design over the others.
Map pair_map(const SweepPlan& plan, const SweepResult& result, const std::string& column, size_t i,
             size_t j) {
  const std::vector<double> x = axis_numbers(plan.axes[i]), y = axis_numbers(plan.axes[j]);
  const AxisLabel figure = label_of_figure(column);
  const AxisLabel x_label = label_of(plan.axes[i]), y_label = label_of(plan.axes[j]);
  const bool others = plan.axes.size() > 2;
  Map map;
  map.name = "sweep_" + column + "_" +
             (others ? std::to_string(i + 1) + "_" + std::to_string(j + 1) : "map");
  map.title = title_of_figure(plan, column) + " over " + x_label.name + " and " + y_label.name +
              (others ? ": the best that the other axes allow" : "");
  map.unit = figure.unit;
  map.width = static_cast<int>(x.size());
  map.height = static_cast<int>(y.size());
  const auto edges = [](const std::vector<double>& v, double& low, double& high) {
    const double half = 0.5 * (v[1] - v[0]);
    low = v.front() - half;
    high = v.back() + half;
  };
  edges(x, map.x_low, map.x_high);
  edges(y, map.y_low, map.y_high);
  map.x_label = x_label.text();
  map.y_label = y_label.text();
  map.equal_scale = false;
  map.value.assign(x.size() * y.size(), std::nan(""));
  map.standard_error.assign(map.value.size(), 0.0);
  const Objective* objective = objective_of(plan, column);
  for (size_t d = 0; d < result.designs.size(); ++d) {
    const Design& design = result.designs[d];
    const auto value = figure_of(design, column);
    if (!value || (others && !design.feasible)) continue;
    const size_t cell = plan.place(d, j) * x.size() + plan.place(d, i);
    const double before = map.value[cell];
    const bool better =
        std::isnan(before) || (objective != nullptr && objective->maximise ? value->value > before
                                                                           : value->value < before);
    if (!better) continue;
    map.value[cell] = value->value;
    map.standard_error[cell] = value->standard_error;
  }
  map.smooth = std::ranges::none_of(map.value, [](double v) { return std::isnan(v); });
  map.signed_values = *std::ranges::min_element(map.value) < 0.0;
  return map;
}

// Curves over the last axis, one for every combination of the others.
Plot curves_over_last(const SweepPlan& plan, const SweepResult& result, const std::string& column) {
  const AxisLabel x = label_of(plan.axes.back()), y = label_of_figure(column);
  Plot plot{"sweep_" + column, title_of_figure(plan, column) + " over " + x.name, x.text(),
            y.text()};
  const std::vector<double> along = axis_numbers(plan.axes.back());
  for (size_t begin = 0; begin < plan.designs(); begin += along.size()) {
    Plot::Curve curve;
    for (size_t axis = 0; axis + 1 < plan.axes.size(); ++axis) {
      curve.label +=
          (axis > 0 ? ", " : "") + label_of(plan.axes[axis]).with(plan.value(begin, axis));
    }
    for (size_t k = 0; k < along.size(); ++k) {
      const auto value = figure_of(result.designs[begin + k], column);
      curve.x.push_back(along[k]);
      curve.y.push_back(value ? value->value : std::nan(""));
      curve.y_error.push_back(value ? value->standard_error : std::nan(""));
    }
    plot.curves.push_back(std::move(curve));
  }
  return plot;
}

struct Cloud {
  std::vector<double> x, y;
  void add(double at_x, double at_y) {
    if (std::isnan(at_x) || std::isnan(at_y)) return;
    x.push_back(at_x);
    y.push_back(at_y);
  }
};

// Adds a curve of points; omits it if it is empty.
void add_points(Plot& plot, const std::string& label, const Cloud& cloud, Plot::Colour colour,
                bool dots) {
  if (cloud.x.empty()) return;
  Plot::Curve curve{label, cloud.x, cloud.y};
  curve.dots = dots;
  curve.markers = !dots;
  curve.colour = colour;
  if (dots) curve.width = 2.2;
  plot.curves.push_back(std::move(curve));
}

// Points of designs, separated by whether the constraints are satisfied.
struct DesignClouds {
  Cloud inside, outside;
  void add(const Design& design, double x, double y) {
    (design.feasible ? inside : outside).add(x, y);
  }
  void draw(Plot& plot, const std::string& label_inside) const {
    add_points(plot, "outside the constraints", outside, Plot::Colour::grey, true);
    add_points(plot, label_inside, inside, Plot::Colour::blue, true);
  }
};

// Adds the values of all designs and the best.
void add_designs(Plot& plot, const SweepPlan& plan, const SweepResult& result,
                 const std::vector<double>& x, const std::vector<double>& y) {
  DesignClouds all;
  Cloud best;
  for (size_t d = 0; d < result.designs.size(); ++d) all.add(result.designs[d], x[d], y[d]);
  if (result.best) best.add(x[*result.best], y[*result.best]);
  const bool named = !all.outside.x.empty() || !best.x.empty();
  all.draw(plot, !named ? "" : plan.constraints.empty() ? "designs" : "within the constraints");
  add_points(plot, "best", best, Plot::Colour::vermilion, false);
}

Plot scatter(const SweepPlan& plan, const SweepResult& result, const std::string& column,
             size_t axis) {
  const AxisLabel x = label_of(plan.axes[axis]), y = label_of_figure(column);
  Plot plot{"sweep_" + column + "_over_" + std::to_string(axis + 1),
            title_of_figure(plan, column) + " over " + x.name, x.text(), y.text()};
  std::vector<double> values;
  for (const Design& design : result.designs) values.push_back(value_or_nothing(design, column));
  add_designs(plot, plan, result, axis_numbers(plan.axes[axis]), values);
  return plot;
}

Plot pareto_plot(const SweepPlan& plan, const SweepResult& result, size_t second) {
  const std::string first_column = plan.judged_column(plan.objectives.front());
  const std::string second_column = plan.judged_column(plan.objectives[second]);
  const AxisLabel x = label_of_figure(first_column), y = label_of_figure(second_column);
  Plot plot{"pareto_" + second_column, title_of_figure(plan, second_column) + " against " + x.name,
            x.text(), y.text()};
  const auto first_of = [&](const Design& d) { return value_or_nothing(d, first_column); };
  const auto second_of = [&](const Design& d) { return value_or_nothing(d, second_column); };
  DesignClouds all;
  Cloud front, nominal;
  for (const Design& d : result.designs) all.add(d, first_of(d), second_of(d));
  std::vector<size_t> best = pareto_designs(plan, result.designs);
  std::ranges::sort(best, {}, [&](size_t d) { return first_of(result.designs[d]); });
  for (const size_t d : best) front.add(first_of(result.designs[d]), second_of(result.designs[d]));
  if (result.nominal) nominal.add(first_of(*result.nominal), second_of(*result.nominal));
  all.draw(plot, "designs");
  add_points(plot, "Pareto front", front, Plot::Colour::vermilion, false);
  add_points(plot, "the nominal experiment", nominal, Plot::Colour::green, false);
  return plot;
}

// Fraction of the copies that are at least as good, over the value.
Plot::Curve reached_curve(const std::string& label, const BuiltFigure& figure, bool maximise,
                          Plot::Colour colour) {
  std::vector<double> values;
  for (const double v : figure.values) {
    if (!std::isnan(v)) values.push_back(v);
  }
  std::ranges::sort(values);
  if (!maximise) std::ranges::reverse(values);
  Plot::Curve curve;
  curve.label = label;
  const double n = static_cast<double>(figure.values.size());
  const double failed = n - static_cast<double>(values.size());
  for (size_t i = 0; i < values.size(); ++i) {
    curve.x.push_back(values[i]);
    curve.y.push_back(100.0 * (n - failed - static_cast<double>(i)) / n);
  }
  curve.colour = colour;
  return curve;
}

void add_built(Product& product, const SweepPlan& plan, const SweepResult& result) {
  for (size_t k = 0; k < result.built_best.size(); ++k) {
    const Objective& objective = plan.objectives[k];
    const AxisLabel x = label_of_figure(result.built_best[k].column);
    Plot plot{"built_" + result.built_best[k].column, "Fraction of built copies that reach a value",
              x.text(), "copies that reach the value [%]"};
    if (k < result.built_nominal.size()) {
      plot.curves.push_back(reached_curve("the nominal experiment", result.built_nominal[k],
                                          objective.maximise, Plot::Colour::green));
    }
    plot.curves.push_back(reached_curve("the best design", result.built_best[k], objective.maximise,
                                        Plot::Colour::vermilion));
    plot.levels = {100.0 * plan.built.fraction};
    product.plots.push_back(std::move(plot));
  }
}

}  // namespace

void add_pictures(Product& product, const SweepPlan& plan, const SweepResult& result,
                  const std::vector<std::string>& figures) {
  const size_t axes = plan.axes.size();
  const bool numbers = std::ranges::none_of(
      plan.axes, [](const SweepAxis& axis) { return axis_numbers(axis).empty(); });
  const bool even = plan.grid && axes >= 2 && std::ranges::all_of(plan.axes, [](const auto& axis) {
                      return is_even(axis_numbers(axis));
                    });
  constexpr size_t most_curves = 12;
  const bool over_last = plan.grid && !axis_numbers(plan.axes.back()).empty() &&
                         plan.designs() / plan.axes.back().values.size() <= most_curves;
  for (const std::string& column : figures) {
    for (size_t axis = 0; !plan.grid && numbers && axis < axes; ++axis) {
      product.plots.push_back(scatter(plan, result, column, axis));
    }
    const bool maps = even && (axes == 2 || objective_of(plan, column) != nullptr);
    for (size_t i = 0; maps && i < axes; ++i) {
      for (size_t j = i + 1; j < axes; ++j) {
        product.maps.push_back(pair_map(plan, result, column, i, j));
      }
    }
    if (over_last) product.plots.push_back(curves_over_last(plan, result, column));
  }
  for (size_t k = 1; k < plan.objectives.size(); ++k) {
    product.plots.push_back(pareto_plot(plan, result, k));
  }
  add_built(product, plan, result);
}

Plot search_plot(const SweepPlan& plan, const SweepResult& result) {
  const Objective& objective = plan.objectives.front();
  const std::string column = plan.judged_column(objective);
  const AxisLabel y = label_of_figure(column);
  Plot plot{"search", title_of_figure(plan, column) + ": the search", "evaluation", y.text()};
  DesignClouds all;
  Cloud so_far;
  double best = std::nan("");
  for (size_t d = 0; d < result.designs.size(); ++d) {
    const double value = value_or_nothing(result.designs[d], column);
    const double at = static_cast<double>(d + 1);
    const bool feasible = result.designs[d].feasible;
    all.add(result.designs[d], at, value);
    if (feasible && (std::isnan(best) || (objective.maximise ? value > best : value < best))) {
      best = value;
    }
    so_far.add(at, best);
  }
  all.draw(plot, "evaluations");
  if (!so_far.x.empty()) {
    Plot::Curve line{"best so far", so_far.x, so_far.y};
    line.colour = Plot::Colour::vermilion;
    plot.curves.push_back(std::move(line));
  }
  const double edge = static_cast<double>(plan.search.global) + 1.5;
  if (plan.search.local > 0 && edge < static_cast<double>(result.designs.size())) {
    plot.shaded = {{edge, static_cast<double>(result.designs.size()) + 0.5}};
    plot.shaded_label = "local";
  }
  return plot;
}

}  // namespace photorque
