#include "photovoltaics/fit/parts.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <string>

#include "core/constants.h"
#include "core/errors.h"
#include "core/numerics/median.h"
#include "core/numerics/root.h"
#include "core/text/format.h"

namespace photorque {

CellParameters single_diode(double saturation_A, double scale_V, double series_ohm,
                            double shunt_ohm, double temperature_K) {
  CellParameters p;
  p.saturation_1_A = saturation_A;
  p.ideality_1 = scale_V / (boltzmann_J_K * temperature_K / elementary_charge_C);
  p.series_ohm = series_ohm;
  p.shunt_ohm = shunt_ohm;
  p.temperature_K = temperature_K;
  return p;
}

CellParameters SingleDiode::parameters(double temperature_K) const {
  return single_diode(saturation_A.value, scale_V.value, series_ohm.value, shunt_ohm.value,
                      temperature_K);
}

std::vector<DiodeCurrent> currents_of(const DiodeCircuit& circuit, double light_A,
                                      const IvSweep& sweep, std::optional<double> storage) {
  const auto [i0, a, rs, g] = circuit;
  const CellCurve cell(single_diode(i0, a, rs, 1.0 / g));
  std::vector<DiodeCurrent> currents;
  for (size_t i = 0; i < sweep.voltage_V.size(); ++i) {
    const double voltage_V = sweep.voltage_V[i];
    const double factor = sweep.light.empty() ? 1.0 : sweep.light[i];
    double current = cell.current_A(light_A * factor, voltage_V);
    double stored_A = 0.0, stored_A_s = 0.0;
    constexpr int most = 50;
    for (int round = 0; storage && round < most; ++round) {
      const double junction_S = i0 * std::exp((voltage_V + current * rs) / a) / a;
      stored_A_s = junction_S * sweep.rate_V_s[i] / (1.0 + (junction_S + g) * rs);
      stored_A = *storage * stored_A_s;
      const double before = current;
      current = cell.current_A(light_A * factor - stored_A, voltage_V);
      if (std::abs(current - before) < 1e-13 * light_A * factor) break;
    }
    const double diode_V = voltage_V + current * rs;
    const double growth = std::expm1(diode_V / a);
    const double junction_S = (i0 * (growth + 1.0) + stored_A) / a;
    const double conductance = junction_S + g, divisor = 1.0 + conductance * rs;
    DiodeCurrent& at = currents.emplace_back(DiodeCurrent{current, conductance / divisor, {}});
    at.derivatives_A << factor, -i0 * growth - stored_A, junction_S * diode_V + stored_A,
        -conductance * current * rs, -g * diode_V, -stored_A_s;
    at.derivatives_A /= divisor;
  }
  return currents;
}

double squares_A2(const IvSweep& sweep, const std::vector<DiodeCurrent>& currents) {
  double sum = 0.0;
  for (size_t i = 0; i < currents.size(); ++i) {
    const double off_A = sweep.current_A[i] - currents[i].current_A;
    sum += off_A * off_A;
  }
  return sum;
}

std::vector<double> deviations(const IvSweep& sweep, const std::vector<DiodeCurrent>& currents,
                               const SweepNoise& noise, double light_A) {
  std::vector<double> off;
  for (size_t i = 0; i < currents.size(); ++i) {
    const double error_A =
        std::hypot(noise.current_fraction * light_A,
                   noise.voltage_fraction * sweep.voltage_V[i] * currents[i].slope_S);
    off.push_back(std::abs(sweep.current_A[i] - currents[i].current_A) / error_A);
  }
  return off;
}

double gap_of_slope_eV(const CellModel& model, double light_A, double growth_1_K,
                       const CellFigure& figure, double slope_1_K) {
  constexpr double step_K = 10.0;
  const double temperature_K = model.reference.temperature_K;
  const double wanted = figure(CellCurve(model.reference), light_A) + step_K * slope_1_K;
  const auto is_below = [&](double gap_eV) {
    CellModel trial = model;
    trial.gap_eV = gap_eV;
    const CellCurve warm(parameters_at(trial, model.reference_area_m2, temperature_K + step_K));
    return figure(warm, light_A * (1.0 + step_K * growth_1_K)) > wanted;
  };
  return bisect(0.01, 20.0, is_below, {60}).middle();
}

double gap_of_voltage_slope_eV(const CellModel& model, double light_A, double growth_1_K,
                               double slope_V_K) {
  return gap_of_slope_eV(
      model, light_A, growth_1_K,
      [](const CellCurve& cell, double in_A) { return cell.open_circuit_V(in_A); }, slope_V_K);
}

void check_sweep(const IvSweep& sweep) {
  constexpr size_t fewest = 6;  // one more than parameters
  const size_t points = sweep.voltage_V.size();
  if (points < fewest || sweep.current_A.size() != points) {
    throw InputError({}, "curves", std::to_string(points) + " points",
                     "at least 6 pairs of voltage and current");
  }
  for (size_t i = 0; i < points; ++i) {
    if (!std::isfinite(sweep.voltage_V[i]) || !std::isfinite(sweep.current_A[i])) {
      throw InputError({}, "curves", "point " + std::to_string(i + 1) + " without a number",
                       "finite numbers");
    }
  }
  const std::set<double> voltages_V(sweep.voltage_V.begin(), sweep.voltage_V.end());
  if (voltages_V.size() < fewest) {
    throw InputError({}, "curves", std::to_string(voltages_V.size()) + " different voltages",
                     "at least 6");
  }
}

SweepEnds sweep_ends(const IvSweep& sweep) {
  SweepEnds ends;
  double nearest_V = 1e300, at_V = 0.0;
  for (size_t i = 0; i < sweep.voltage_V.size(); ++i) {
    if (std::abs(sweep.voltage_V[i]) < nearest_V) {
      nearest_V = std::abs(sweep.voltage_V[i]);
      ends.short_circuit_A = sweep.current_A[i];
      at_V = sweep.voltage_V[i];
    }
    if (sweep.current_A[i] >= 0.0) {
      ends.open_circuit_V = std::max(ends.open_circuit_V, sweep.voltage_V[i]);
    }
  }
  if (!(ends.short_circuit_A > 0.0) || !(ends.open_circuit_V > 0.0)) {
    throw InputError(
        {}, "curves",
        printed("%.4g A at %.4g V, the reading nearest to 0 V, and %.4g V as the highest "
                "voltage with a current",
                ends.short_circuit_A, at_V, ends.open_circuit_V),
        "a sweep of a lit cell, both positive");
  }
  return ends;
}

EvenSweeps with_even_steps(std::span<const IvSweep> sweeps, const SweepNoise& noise) {
  EvenSweeps even{{sweeps.begin(), sweeps.end()}, noise};
  double step_V = 0.0, count = 0.0;
  for (const IvSweep& sweep : sweeps) {
    check_sweep(sweep);
    if (sweep.voltage_V.size() != sweeps[0].voltage_V.size()) {
      throw InputError({}, "even_voltage_steps", "sweeps of different lengths", "equal lengths");
    }
    for (size_t k = 1; k < sweep.voltage_V.size(); ++k, ++count) {
      step_V += sweep.voltage_V[k] / static_cast<double>(k);
    }
  }
  step_V /= count;
  for (IvSweep& sweep : even.sweeps) {
    for (size_t k = 0; k < sweep.voltage_V.size(); ++k) {
      const double set_V = step_V * static_cast<double>(k);
      const double allowed_V = 20.0 * noise.voltage_fraction * std::max(set_V, step_V);
      if (std::abs(sweep.voltage_V[k] - set_V) > allowed_V) {
        throw InputError({}, "even_voltage_steps", std::to_string(sweep.voltage_V[k]) + " V",
                         "about " + std::to_string(set_V) + " V at point " + std::to_string(k + 1));
      }
      sweep.voltage_V[k] = set_V;
    }
  }
  even.noise.voltage_fraction /= std::sqrt(count);
  return even;
}

namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

constexpr double one_sided_95 = 2.706;  // 1.645²

// χ² with parameter k held at `value` and all others fitted from `rest`, which receives their
// values.
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
  // With the parameter at its lower bound, χ² may be lower than in the free fit.
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
  constexpr double close = 0.005;  // in a logarithm: half a percent of the limit
  while (outside - inside > close) {
    const double middle = std::midpoint(inside, outside);
    VectorXd trial = rest;
    const bool is_inside = held_chi2(all, residuals, k, middle, trial) <= allowed;
    if (is_inside) rest = trial;
    (is_inside ? inside : outside) = middle;
  }
  return inside;
}

std::vector<inference::Parameter> diode_parameters(const VectorXd& x, Index first, double ohm) {
  std::vector<inference::Parameter> all = {{"saturation", "ln A", x[first]},
                                           {"n V_t", "ln V", x[first + 1]},
                                           {"series", "ln ohm", x[first + 2]},
                                           {"shunt", "ln S", x[first + 3]}};
  inference::Parameter &series = all[2], &shunt = all[3];
  series.lowest = std::log(least_resistance_part * ohm);
  series.highest = std::log(most_resistance_part * ohm);
  shunt.lowest = -std::log(most_resistance_part * ohm);
  shunt.highest = -std::log(least_resistance_part * ohm);
  return all;
}

SingleDiode diode_at(const Estimate& photocurrent_A, const VectorXd& x, const VectorXd& error,
                     Index first) {
  return {photocurrent_A, exponential(x[first], error[first]),
          exponential(x[first + 1], error[first + 1]), exponential(x[first + 2], error[first + 2]),
          exponential(-x[first + 3], error[first + 3])};
}

RatedPoint rated_point_of(const CellModel& model, double light_A, double irradiance_W_m2,
                          double temperature_K) {
  const CellCurve cell(
      in_light(parameters_at(model, model.reference_area_m2, temperature_K), light_A));
  const CellOperatingPoint best = cell.maximum_power(light_A);
  return {
      irradiance_W_m2, temperature_K, cell.short_circuit_A(light_A), cell.open_circuit_V(light_A),
      best.current_A,  best.voltage_V};
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
                                         std::span<const NamedBound> named, Index first) {
  constexpr double near = 1e-6;  // in a logarithm
  std::vector<BoundReached> reached;
  for (const NamedBound& bound : named) {
    const inference::Parameter& p = best.parameters.shared[static_cast<size_t>(bound.parameter)];
    const double x = best.at[first + bound.parameter];
    const bool is_low = x<p.lowest + near, is_high = x> p.highest - near;
    if (!is_low && !is_high) continue;
    reached.push_back({bound.key, std::exp(bound.sign * (is_low ? p.lowest : p.highest)),
                       is_low ? bound.at_least : bound.at_most});
  }
  return reached;
}

std::vector<NamedBound> resistance_bounds(Index series, Index shunt) {
  return {{series, "series_ohm", 1.0, "the fit has no series resistance",
           "the series resistance explains all of the curve: this is no lit cell"},
          {shunt, "shunt_ohm", -1.0, "the fit has no leak",
           "the leak explains all of the curve: this is no lit cell"}};
}

namespace {

// One round of refit_without_outliers(): returns whether there were outliers.
bool take_outliers(std::span<IvSweep* const> sweeps, const std::vector<std::vector<double>>& off,
                   std::vector<OutlierReading>& taken) {
  constexpr double far = 8.0, most = 0.1;
  std::vector<double> all;
  for (const std::vector<double>& one : off) all.insert(all.end(), one.begin(), one.end());
  constexpr double of_median = 1.4826;  // a normal variable's standard deviation
  const double limit = far * std::max(1.0, of_median * upper_median(all));
  // More than two in a row are a part of the curve, for example a step due to a shadow.
  constexpr size_t longest = 2;
  std::vector<std::vector<char>> is_out(sweeps.size());
  std::vector<OutlierReading> found;
  for (size_t s = 0; s < sweeps.size(); ++s) {
    is_out[s].assign(off[s].size(), 0);
    for (size_t i = 0, end = 0; i < off[s].size(); i = end + 1) {
      for (end = i; end < off[s].size() && off[s][end] > limit;) ++end;
      if (end - i > longest) continue;
      for (size_t k = i; k < end; ++k) {
        is_out[s][k] = 1;
        found.push_back({s, sweeps[s]->voltage_V[k], sweeps[s]->current_A[k]});
      }
    }
  }
  const auto count = static_cast<double>(found.size() + taken.size());
  if (found.empty() || count > most * static_cast<double>(all.size() + taken.size())) return false;
  for (size_t s = 0; s < sweeps.size(); ++s) {
    *sweeps[s] = sweeps[s]->without(is_out[s]);
  }
  taken.insert(taken.end(), found.begin(), found.end());
  return true;
}

}  // namespace

inference::Fit refit_without_outliers(
    inference::Fit fit, std::span<IvSweep* const> sweeps,
    const std::function<std::vector<double>(size_t, const VectorXd&)>& off,
    const std::function<inference::Fit(const VectorXd&)>& refit,
    std::vector<OutlierReading>& taken) {
  for (int round = 0; round < 4 && std::isfinite(fit.chi2); ++round) {
    std::vector<std::vector<double>> all;
    for (size_t s = 0; s < sweeps.size(); ++s) all.push_back(off(s, fit.at));
    if (!take_outliers(sweeps, all, taken)) break;
    for (const IvSweep* sweep : sweeps) check_sweep(*sweep);
    fit = refit(fit.at);
  }
  return fit;
}

}  // namespace photorque
