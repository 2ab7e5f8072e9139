// Fits of a string in light that differs between its substrings.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/errors.h"
#include "core/numerics/order.h"
#include "photovoltaics/fit/parts.h"

namespace photorque {
namespace shaded_string {
namespace {

using Eigen::Index, Eigen::VectorXd;

// Logarithms of I₀, n V_t, R_s, 1/R_sh and the bypass diodes' drop; then of each photocurrent.
enum Parameter { saturation, scale, series, shunt, drop, first_light };

// Cells in series, each with its own bypass diode.
ArrayCurve string_curve(const CellParameters& cell, double bypass_drop_V,
                        const std::vector<double>& light_A) {
  ArrayWiring wiring{{{}}};
  for (size_t k = 0; k < light_A.size(); ++k) {
    ArrayWiring::Substring& substring = wiring.strings[0].substrings.emplace_back();
    substring.rows = {{static_cast<int>(k)}};
    substring.bypass.kind = Diode::Kind::clamp;
    substring.bypass.drop_V = bypass_drop_V;
  }
  return {wiring, CellTables(light_A.size(), diode_voltage_law(cell)), light_A};
}

// Current and slope of the string at each voltage.
std::vector<ArrayCurve::SlopedPoint> string_points(const VectorXd& x,
                                                   const std::vector<double>& voltage_V) {
  std::vector<double> light_A;
  for (Index k = first_light; k < x.size(); ++k) light_A.push_back(std::exp(x[k]));
  const ArrayCurve curve = string_curve(single_diode(std::exp(x[saturation]), std::exp(x[scale]),
                                                     std::exp(x[series]), std::exp(-x[shunt])),
                                        std::exp(x[drop]), light_A);
  const std::vector<size_t> order = sorted_indices(
      voltage_V.size(), [&](size_t a, size_t b) { return voltage_V[a] < voltage_V[b]; });
  std::vector<double> rising_V;
  for (const size_t i : order) rising_V.push_back(voltage_V[i]);
  const std::vector<ArrayCurve::SlopedPoint> rising = curve.at_voltages(rising_V);
  std::vector<ArrayCurve::SlopedPoint> points(order.size());
  for (size_t i = 0; i < order.size(); ++i) points[order[i]] = rising[i];
  return points;
}

// Initial values. The current in the middle of each substring's part of the voltage is about that
// of the substring.
VectorXd first_guess(const IvSweep& sweep, int substrings, double knee) {
  const SweepEnds ends = sweep_ends(sweep);
  const double substring_V = ends.open_circuit_V / substrings, a = substring_V / knee;
  VectorXd x(Index{first_light} + substrings);
  x << std::log(ends.short_circuit_A) - knee, std::log(a),
      std::log(0.02 * substring_V / ends.short_circuit_A),
      std::log(0.002 * ends.short_circuit_A / substring_V), std::log(0.5),
      VectorXd::Zero(substrings);
  for (int k = 0; k < substrings; ++k) {
    const double middle_V = (k + 0.5) * substring_V;
    size_t nearest = 0;
    for (size_t i = 0; i < sweep.voltage_V.size(); ++i) {
      if (std::abs(sweep.voltage_V[i] - middle_V) < std::abs(sweep.voltage_V[nearest] - middle_V))
        nearest = i;
    }
    x[first_light + k] = std::log(std::max(sweep.current_A[nearest], 1e-3 * ends.short_circuit_A));
  }
  return x;
}

// Bounds: fits of substrings without light, and of diodes with no drop or the whole voltage, end
// there.
constexpr double darkest_part = 1e-6;  // fraction of the short-circuit current
constexpr double least_drop_V = 1e-3, most_drop_V = 5.0;

std::vector<inference::Parameter> parameters_from(const VectorXd& x, const SweepEnds& ends) {
  const auto substrings = static_cast<double>(x.size() - first_light);
  std::vector<inference::Parameter> all =
      diode_parameters(x, saturation, ends.open_circuit_V / substrings / ends.short_circuit_A);
  all.push_back({"bypass drop", "ln V", x[drop]});
  for (Index k = first_light; k < x.size(); ++k) {
    all.push_back({"photocurrent " + std::to_string(k - first_light + 1), "ln A", x[k]});
    all.back().lowest = std::log(darkest_part * ends.short_circuit_A);
  }
  all[drop].lowest = std::log(least_drop_V);
  all[drop].highest = std::log(most_drop_V);
  return all;
}

std::vector<NamedBound> named_bounds(Index substrings) {
  std::vector<NamedBound> all = resistance_bounds(series, shunt);
  all.push_back({drop, "bypass_drop_V", 1.0, "the bypass diodes have no forward voltage",
                 "no substring is bypassed: is the curve of a partly shaded string?"});
  for (Index k = 0; k < substrings; ++k) {
    all.push_back({first_light + k, "a photocurrent", 1.0, "a substring is dark", ""});
  }
  return all;
}

// Slope of the measured curve at each point [S], from its neighbours.
VectorXd measured_slopes_S(const IvSweep& sweep) {
  const size_t points = sweep.voltage_V.size();
  VectorXd slopes(static_cast<Index>(points));
  for (size_t i = 0; i < points; ++i) {
    const size_t from = i > 0 ? i - 1 : 0, to = std::min(i + 1, points - 1);
    const double apart_V = sweep.voltage_V[to] - sweep.voltage_V[from];
    slopes[static_cast<Index>(i)] =
        apart_V != 0.0 ? std::abs((sweep.current_A[to] - sweep.current_A[from]) / apart_V) : 0.0;
  }
  return slopes;
}

VectorXd fitted_slopes_S(const IvSweep& sweep, const VectorXd& x) {
  // Slope of the curve where all substrings are bypassed.
  constexpr double steepest_S = 1e9;
  const auto points = string_points(x, sweep.voltage_V);
  VectorXd slopes(static_cast<Index>(points.size()));
  for (size_t i = 0; i < points.size(); ++i) {
    slopes[static_cast<Index>(i)] = points[i].slope_S < steepest_S ? points[i].slope_S : 0.0;
  }
  return slopes;
}

// Residuals of the current over their standard deviations. The error of the voltage is converted by
// slopes that the fit does not change. Otherwise the fit would find a string so steep that every
// residual counts as an error of the voltage.
VectorXd weighted_errors(const IvSweep& sweep, const SweepNoise& noise, double max_A,
                         const VectorXd& slopes_S, const VectorXd& x) {
  const auto points = static_cast<Index>(sweep.voltage_V.size());
  VectorXd errors = VectorXd::Constant(points, std::numeric_limits<double>::infinity());
  if (!reasonable(x)) return errors;
  const auto curve = string_points(x, sweep.voltage_V);
  for (Index i = 0; i < points; ++i) {
    const double v = sweep.voltage_V[static_cast<size_t>(i)],
                 measured_A = sweep.current_A[static_cast<size_t>(i)];
    const double from_voltage_A = noise.voltage_fraction * std::abs(v) * slopes_S[i];
    errors[i] = (measured_A - curve[static_cast<size_t>(i)].current_A) /
                std::hypot(from_voltage_A, noise.current_fraction * max_A);
  }
  return errors;
}

struct StringFit {
  inference::Fit fit;
  inference::ResidualFunction residuals;
};

StringFit fitted_from(const VectorXd& start, const IvSweep& sweep, const SweepNoise& noise,
                      const VectorXd& slopes_S) {
  const SweepEnds ends = sweep_ends(sweep);
  const inference::ResidualFunction residuals =
      inference::with_differences([&sweep, noise, ends, slopes_S](const VectorXd& x, Index) {
        return weighted_errors(sweep, noise, ends.short_circuit_A, slopes_S, x);
      });
  const inference::ResidualModel model(parameters_from(start, ends), residuals);
  return {inference::fit(model, start, inference::Options::to_rounding()), residuals};
}

// The best fit from several starts with the measured slopes, refitted with the slopes of the fit.
StringFit best_fit(const IvSweep& sweep, int substrings, const SweepNoise& noise) {
  const VectorXd measured_S = measured_slopes_S(sweep);
  const auto from_knee = [&](double knee) {
    return fitted_from(first_guess(sweep, substrings, knee), sweep, noise, measured_S);
  };
  // The open-circuit voltage over n V_t of silicon is 18 to 27.
  StringFit best = from_knee(20.0);
  for (const double knee : {27.0, 14.0}) {
    StringFit one = from_knee(knee);
    const bool better = one.fit.chi2 < best.fit.chi2 || !std::isfinite(best.fit.chi2);
    if (better) best = std::move(one);
  }
  constexpr int rounds = 3;
  for (int round = 0; round < rounds && std::isfinite(best.fit.chi2); ++round) {
    const VectorXd slopes_S = fitted_slopes_S(sweep, best.fit.at);
    best = fitted_from(best.fit.at, sweep, noise, slopes_S);
  }
  return best;
}

}  // namespace
}  // namespace shaded_string

ShadedFit fit_shaded_string(const IvSweep& sweep, int substrings, const SweepNoise& noise) {
  using namespace shaded_string;
  check_sweep(sweep);
  const auto parameters = static_cast<size_t>(first_light + substrings);
  if (substrings < 1 || sweep.voltage_V.size() <= parameters) {
    throw InputError({}, "substrings", std::to_string(substrings),
                     "at least 1, and fewer parameters than points");
  }
  const auto [best, residuals] = best_fit(sweep, substrings, noise);
  if (!std::isfinite(best.chi2)) {
    throw InputError({}, "curves", "a sweep that no string of cells fits with this noise",
                     "a current-voltage curve of a lit string and its noise");
  }
  const VectorXd& x = best.at;
  const VectorXd error = best.scatter_errors();
  ShadedFit fit;
  for (int k = 0; k < substrings; ++k) {
    fit.photocurrents_A.push_back(exponential(x[first_light + k], error[first_light + k]));
  }
  std::ranges::sort(fit.photocurrents_A, std::greater<>(), &Estimate::value);
  fit.substring = diode_at(fit.photocurrents_A[0], x, error, saturation);
  limit_resistances(best, residuals, series, shunt, best.variance(), fit.substring);
  fit.bounds = bounds_reached(best, named_bounds(substrings));
  fit.bypass_drop_V = exponential(x[drop], error[drop]);
  const auto curve = string_points(x, sweep.voltage_V);
  double squares = 0.0;
  for (size_t i = 0; i < sweep.voltage_V.size(); ++i) {
    const double apart = curve[i].current_A - sweep.current_A[i];
    squares += apart * apart;
  }
  fit.rms_A = std::sqrt(squares / static_cast<double>(sweep.voltage_V.size()));
  return fit;
}

ArrayCurve ShadedFit::curve(double temperature_K) const {
  std::vector<double> light_A;
  for (const Estimate& light : photocurrents_A) light_A.push_back(light.value);
  return shaded_string::string_curve(substring.parameters(temperature_K), bypass_drop_V.value,
                                     light_A);
}

}  // namespace photorque
