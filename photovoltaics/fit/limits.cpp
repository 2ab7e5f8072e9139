#include "photovoltaics/fit/limits.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace photorque {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

constexpr double one_sided_95 = 2.706;  // 1.645²

// χ² with parameter k held, all others fitted from `rest`, which becomes where they end.
double held_chi2(const std::vector<inference::Parameter>& all,
                 const inference::ResidualFunction& residuals, Index k, double value,
                 VectorXd& rest) {
  std::vector<inference::Parameter> others = all;
  others.erase(others.begin() + k);
  const auto with_held = [&](const VectorXd& x) {
    VectorXd full(x.size() + 1);
    full << x.head(k), value, x.tail(x.size() - k);
    return full;
  };
  const inference::ResidualModel model(
      others, [&](const VectorXd& x, Index run, VectorXd& r, MatrixXd* slopes) {
        residuals(with_held(x), run, r, slopes);
        if (slopes == nullptr || slopes->cols() <= x.size()) return;
        const Index after = x.size() - k;
        const MatrixXd right = slopes->rightCols(after);
        slopes->middleCols(k, after) = right;
        slopes->conservativeResize(Eigen::NoChange, x.size());
      });
  const inference::Fit fit = inference::fit(model, rest, inference::Options::to_rounding());
  if (std::isfinite(fit.chi2)) rest = fit.at;
  return fit.chi2;
}

}  // namespace

std::optional<double> upper_limit(const inference::Fit& best,
                                  const inference::ResidualFunction& residuals, Index k,
                                  double variance) {
  const std::vector<inference::Parameter>& all = best.parameters.shared;
  const double lowest = all[static_cast<size_t>(k)].lowest;
  const double highest = all[static_cast<size_t>(k)].highest;
  VectorXd start(best.at.size() - 1);
  start << best.at.head(k), best.at.tail(best.at.size() - k - 1);
  VectorXd rest = start;
  const double at_lowest = held_chi2(all, residuals, k, lowest, rest);
  // What is held there may fit better than what the fit found with all free.
  const double least = std::min(best.chi2, at_lowest);
  const double allowed = least + one_sided_95 * variance;
  if (!(at_lowest <= allowed)) return std::nullopt;
  constexpr double stride = 2.0;
  double inside = std::max(lowest, std::min(best.at[k], highest)), outside = inside;
  rest = start;
  while (outside < highest) {
    outside = std::min(highest, inside + stride);
    VectorXd trial = rest;
    if (!(held_chi2(all, residuals, k, outside, trial) <= allowed)) break;
    inside = outside;
    rest = trial;
  }
  constexpr double close = 0.005;  // of a logarithm: the limit to half a percent
  while (outside - inside > close) {
    const double middle = std::midpoint(inside, outside);
    VectorXd trial = rest;
    const bool is_inside = held_chi2(all, residuals, k, middle, trial) <= allowed;
    if (is_inside) rest = trial;
    (is_inside ? inside : outside) = middle;
  }
  return inside;
}

void bound_resistances(double ohm, inference::Parameter& series, inference::Parameter& shunt) {
  series.lowest = std::log(least_resistance_part * ohm);
  series.highest = std::log(most_resistance_part * ohm);
  shunt.lowest = -std::log(most_resistance_part * ohm);
  shunt.highest = -std::log(least_resistance_part * ohm);
}

void limit_resistances(const inference::Fit& best, const inference::ResidualFunction& residuals,
                       Index series, Index shunt, double variance, SingleDiode& diode) {
  if (const auto most = upper_limit(best, residuals, shunt, variance)) {
    diode.shunt_above_ohm = std::exp(-*most);
  }
  if (const auto most = upper_limit(best, residuals, series, variance)) {
    diode.series_below_ohm = std::exp(*most);
  }
}

std::vector<BoundReached> bounds_reached(const inference::Fit& best,
                                         std::span<const NamedBound> named) {
  constexpr double near = 1e-6;  // of a logarithm
  std::vector<BoundReached> reached;
  for (const NamedBound& bound : named) {
    const inference::Parameter& p = best.parameters.shared[static_cast<size_t>(bound.parameter)];
    const double x = best.at[bound.parameter];
    const bool is_low = x<p.lowest + near, is_high = x> p.highest - near;
    if (!is_low && !is_high) continue;
    reached.push_back({bound.key, std::exp(bound.sign * (is_low ? p.lowest : p.highest)),
                       is_low ? bound.at_least : bound.at_most});
  }
  return reached;
}

std::vector<NamedBound> resistance_bounds(Index series, Index shunt) {
  return {{series, "series_ohm", 1.0, "the fit wants no series resistance at all",
           "the series resistance explains all of the curve: this is no lit cell"},
          {shunt, "shunt_ohm", -1.0, "the fit wants no leak at all",
           "the leak explains all of the curve: this is no lit cell"}};
}

}  // namespace photorque
