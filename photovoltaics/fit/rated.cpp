// Fits of datasheet values.
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/errors.h"
#include "photovoltaics/fit/parts.h"

namespace photorque {
namespace rated_points {
namespace {

using Eigen::Index, Eigen::VectorXd;

enum Parameter { saturation, scale, series, shunt, count };

// The points, and the law of the shunt, whose reference is the short-circuit current of the first
// point.
struct Figures {
  std::span<const RatedPoint> points;
  ShuntLaw law = ShuntLaw::constant;
  double first_A = points[0].short_circuit_A;
};

// A point's circuit, and the photocurrent that gives its short circuit.
struct Circuit {
  CellCurve cell;
  double light_A;
};

// The circuit of a point. With the inverse law, the shunt conductance is multiplied by the factor
// f = I_L/I_L1, which follows from 0 = I_L − D(I_sc R_s) − f G I_sc R_s − I_sc.
Circuit circuit_of(const VectorXd& x, const Figures& figures, const RatedPoint& point) {
  const double series_ohm = std::exp(x[series]), shunt_S = std::exp(x[shunt]);
  const auto with_shunt = [&](double conductance_S) {
    return CellCurve(
        single_diode(std::exp(x[saturation]), std::exp(x[scale]), series_ohm, 1.0 / conductance_S));
  };
  CellCurve cell = with_shunt(shunt_S);
  if (figures.law == ShuntLaw::constant) return {cell, cell.photocurrent_A(point.short_circuit_A)};
  const double first_A = cell.photocurrent_A(figures.first_A);
  const double leak_A = shunt_S * series_ohm * point.short_circuit_A;
  double factor = (cell.photocurrent_A(point.short_circuit_A) - leak_A) / (first_A - leak_A);
  // The factor is positive for all resistances near a fit.
  if (!(factor > 0.0) || !std::isfinite(factor)) {
    factor = point.short_circuit_A / figures.first_A;
  }
  return {with_shunt(factor * shunt_S), factor * first_A};
}

void check(std::span<const RatedPoint> points) {
  if (points.empty()) throw InputError({}, "datasheet", "no points", "at least one");
  for (const RatedPoint& p : points) {
    const bool good = p.irradiance_W_m2 > 0 && p.temperature_K > 0 &&
                      p.short_circuit_A > p.maximum_A && p.maximum_A > 0 &&
                      p.open_circuit_V > p.maximum_V && p.maximum_V > 0;
    const double fill = p.maximum_A * p.maximum_V / (p.short_circuit_A * p.open_circuit_V);
    if (!good || fill < 0.25) {
      throw InputError({}, "datasheet", "figures that no cell can have",
                       "0.25 I_sc V_oc < I_mp V_mp with I_mp < I_sc and V_mp < V_oc");
    }
  }
}

// The points translated to the temperature of the first one: currents by the change of the
// short-circuit current, voltages by that of the open-circuit voltage of the first point
// (IEC 60891, procedure 1, without curve correction).
std::vector<RatedPoint> at_first_temperature(std::span<const RatedPoint> points,
                                             const TemperatureSlopes& slopes) {
  std::vector<RatedPoint> moved(points.begin(), points.end());
  for (RatedPoint& p : moved) {
    const double warmer_K = p.temperature_K - points[0].temperature_K;
    const double current_A =
        p.short_circuit_A * (1.0 - 1.0 / (1.0 + slopes.short_circuit_1_K * warmer_K));
    const double voltage_V = slopes.open_circuit_1_K * points[0].open_circuit_V * warmer_K;
    p.short_circuit_A -= current_A;
    p.maximum_A -= current_A;
    p.open_circuit_V -= voltage_V;
    p.maximum_V -= voltage_V;
    p.temperature_K = points[0].temperature_K;
  }
  return moved;
}

VectorXd relative_errors(const Figures& figures, const VectorXd& x) {
  VectorXd errors = VectorXd::Constant(3 * static_cast<Index>(figures.points.size()),
                                       std::numeric_limits<double>::infinity());
  if (!reasonable(x)) return errors;
  Index row = 0;
  for (const RatedPoint& p : figures.points) {
    const auto [cell, light_A] = circuit_of(x, figures, p);
    const CellOperatingPoint best = cell.maximum_power(light_A);
    errors[row++] = 1.0 - cell.open_circuit_V(light_A) / p.open_circuit_V;
    errors[row++] = 1.0 - best.current_A / p.maximum_A;
    errors[row++] = 1.0 - best.voltage_V / p.maximum_V;
  }
  return errors;
}

std::vector<inference::Parameter> parameters_from(const VectorXd& start,
                                                  std::span<const RatedPoint> points) {
  return diode_parameters(start, saturation, points[0].open_circuit_V / points[0].short_circuit_A);
}

inference::Fit fit_from(const VectorXd& start, const Figures& figures, double guess_V) {
  std::vector<inference::Parameter> parameters = parameters_from(start, figures.points);
  if (figures.points.size() == 1) {
    // A single point does not determine n V_t: a weak prior keeps it near the guess.
    parameters[scale].mean = std::log(guess_V);
    parameters[scale].sigma = 1.0;
  }
  const inference::ResidualModel model(
      parameters, inference::with_differences(
                      [&](const VectorXd& x, Index) { return relative_errors(figures, x); }));
  return inference::fit(model, start, inference::Options::to_rounding());
}

inference::Fit best_fit(const Figures& figures, double guess_V) {
  const std::span<const RatedPoint> points = figures.points;
  const RatedPoint& first = points[0];
  inference::Fit best;
  for (const double blunter : {1.0, 1.5}) {
    for (const double resistive : {0.3, 3.0}) {
      const double a = guess_V * (points.size() == 1 ? 1.0 : blunter);
      VectorXd start(Index{count});
      start << std::log(first.short_circuit_A) - first.open_circuit_V / a, std::log(a),
          std::log(0.02 * resistive * first.open_circuit_V / first.short_circuit_A),
          std::log(0.01 * first.short_circuit_A / first.open_circuit_V);
      const inference::Fit trial = fit_from(start, figures, guess_V);
      if (trial.chi2 < best.chi2) best = trial;
    }
  }
  return best;
}

// Mean square error of the prediction of each point by a fit to the others. For two points it is
// that of the fit to both, `fitted`, because a single point does not determine the ideality factor.
double predictive_error(const Figures& figures, double guess_V, const inference::Fit& fitted) {
  const auto count = static_cast<double>(3 * figures.points.size());
  if (figures.points.size() < 3) return fitted.chi2 / count;
  double squares = 0.0;
  for (size_t left_out = 0; left_out < figures.points.size(); ++left_out) {
    std::vector<RatedPoint> others(figures.points.begin(), figures.points.end());
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(left_out));
    const inference::Fit fit = best_fit({others, figures.law, figures.first_A}, guess_V);
    if (fit.at.size() == 0) return inference::infinity;
    squares +=
        relative_errors({figures.points.subspan(left_out, 1), figures.law, figures.first_A}, fit.at)
            .squaredNorm();
  }
  return squares / count;
}

// Exponent of the photocurrent as a power of the irradiance: least squares of the logarithms, with
// the first point fixed; 1 if all points have the same irradiance.
double light_exponent(const VectorXd& x, const Figures& figures) {
  const RatedPoint& first = figures.points[0];
  const double first_A = circuit_of(x, figures, first).light_A;
  double squares = 0.0, products = 0.0;
  for (const RatedPoint& p : figures.points) {
    const double light = std::log(p.irradiance_W_m2 / first.irradiance_W_m2);
    squares += light * light;
    products += light * std::log(circuit_of(x, figures, p).light_A / first_A);
  }
  return squares > 0.0 ? products / squares : 1.0;
}

// The result of a fit, without standard errors.
RatedFit described(const VectorXd& x, const Figures& figures, const TemperatureSlopes& slopes) {
  const RatedPoint& first = figures.points[0];
  RatedFit result;
  result.shunt_law = figures.law;
  result.diode = diode_at({}, x, VectorXd::Zero(Index{count}), saturation);
  result.model.reference = result.diode.parameters(first.temperature_K);
  const double light_A = CellCurve(result.model.reference).photocurrent_A(first.short_circuit_A);
  result.diode.photocurrent_A = {light_A, 0.0};
  result.model.gap_eV = gap_of_voltage_slope_eV(result.model, light_A, slopes.short_circuit_1_K,
                                                slopes.open_circuit_1_K * first.open_circuit_V);
  result.model.photocurrent_slope_1_K = slopes.short_circuit_1_K;
  if (figures.law == ShuntLaw::inverse) result.model.reference.shunt_light_A = light_A;
  result.first_W_m2 = first.irradiance_W_m2;
  result.light_exponent = light_exponent(x, figures);
  result.rms = std::sqrt(relative_errors(figures, x).squaredNorm() /
                         (3.0 * static_cast<double>(figures.points.size())));
  return result;
}

// The figures with a standard error, as a vector.
constexpr Index with_errors = 6;
using FigureErrors = Eigen::Vector<double, with_errors>;
FigureErrors figures_of(const RatedFit& fit) {
  const SingleDiode& d = fit.diode;
  return {d.photocurrent_A.value, d.saturation_A.value, d.scale_V.value,
          d.series_ohm.value,     d.shunt_ohm.value,    fit.model.gap_eV};
}

// Errors from the covariance of the parameters, by central differences. Figures that depend on an
// undetermined parameter are undetermined too.
FigureErrors scatter_errors(const inference::Fit& fitted, const Figures& figures,
                            const TemperatureSlopes& slopes) {
  constexpr double step = 1e-4;  // step of the logarithms
  Eigen::Matrix<double, with_errors, Eigen::Dynamic> jacobian(with_errors, Index{count});
  for (Index k = 0; k < Index{count}; ++k) {
    const auto moved = [&](double by) {
      VectorXd x = fitted.at;
      x[k] += by;
      return figures_of(described(x, figures, slopes));
    };
    jacobian.col(k) = (moved(step) - moved(-step)) / (2.0 * step);
  }
  inference::Covariance known = fitted.covariance();
  for (const Index k : known.undetermined) known.matrix(k, k) = 0.0;
  FigureErrors errors = (jacobian * known.matrix * jacobian.transpose() * fitted.variance())
                            .diagonal()
                            .cwiseMax(0.0)
                            .cwiseSqrt();
  for (const Index k : known.undetermined) {
    for (Index figure = 0; figure < with_errors; ++figure) {
      if (jacobian(figure, k) != 0.0) errors[figure] = inference::infinity;
    }
  }
  return errors;
}

double rounded_sigma(double figure, double step, double fraction) {
  return std::hypot(step / std::sqrt(12.0), fraction * figure);
}

// Errors due to rounding: half the difference of the fits with one figure changed by plus and minus
// its standard deviation, added in quadrature over all figures.
FigureErrors rounding_errors(const VectorXd& start, const Figures& figures,
                             const TemperatureSlopes& slopes, double guess_V,
                             const RatedTolerance& tolerance) {
  const std::span<const RatedPoint> points = figures.points;
  struct Figure {
    double RatedPoint::*member;
    double step;
  };
  const std::array<Figure, 4> all = {{{&RatedPoint::short_circuit_A, tolerance.step_A},
                                      {&RatedPoint::open_circuit_V, tolerance.step_V},
                                      {&RatedPoint::maximum_A, tolerance.step_A},
                                      {&RatedPoint::maximum_V, tolerance.step_V}}};
  FigureErrors squares = FigureErrors::Zero();
  for (size_t p = 0; p < points.size(); ++p) {
    for (const Figure& figure : all) {
      const double sigma = rounded_sigma(points[p].*figure.member, figure.step, tolerance.fraction);
      if (sigma == 0.0) continue;
      const auto moved = [&](double by) {
        std::vector<RatedPoint> trial(points.begin(), points.end());
        trial[p].*figure.member += by;
        const Figures of_trial{trial, figures.law};
        return figures_of(described(fit_from(start, of_trial, guess_V).at, of_trial, slopes));
      };
      squares += (0.5 * (moved(sigma) - moved(-sigma))).cwiseAbs2();
    }
  }
  return squares.cwiseSqrt();
}

// Standard deviation of each of relative_errors(), from rounding, tolerance and `scatter`. That of
// a current includes the short-circuit current, which determines the photocurrent.
VectorXd known_to(std::span<const RatedPoint> points, const RatedTolerance& tolerance,
                  double scatter) {
  constexpr double exact = 1e-12;  // figures without rounding
  VectorXd sigma(3 * static_cast<Index>(points.size()));
  Index row = 0;
  for (const RatedPoint& p : points) {
    const auto relative = [&](double figure, double step) {
      return rounded_sigma(figure, step, tolerance.fraction) / figure;
    };
    const auto known = [&](double stated) { return std::hypot(stated, scatter, exact); };
    sigma[row++] = known(relative(p.open_circuit_V, tolerance.step_V));
    sigma[row++] = known(std::hypot(relative(p.maximum_A, tolerance.step_A),
                                    relative(p.short_circuit_A, tolerance.step_A)));
    sigma[row++] = known(relative(p.maximum_V, tolerance.step_V));
  }
  return sigma;
}

// The limits of the resistances, from the profile of χ² of the figures.
void limit_by_figures(const inference::Fit& best, const Figures& figures,
                      const RatedTolerance& tolerance, SingleDiode& diode) {
  const std::span<const RatedPoint> points = figures.points;
  const VectorXd sigma = known_to(points, tolerance, std::sqrt(best.variance()));
  const inference::ResidualFunction residuals =
      inference::with_differences([&](const VectorXd& x, Index) -> VectorXd {
        return relative_errors(figures, x).cwiseQuotient(sigma);
      });
  std::vector<inference::Parameter> parameters = parameters_from(best.at, points);
  if (points.size() == 1) {
    constexpr double assumed = 0.1;  // error of the ideality, which one point does not determine
    parameters[scale].mean = best.at[scale];
    parameters[scale].sigma = assumed;
  }
  const inference::Fit fit = inference::fit(inference::ResidualModel(parameters, residuals),
                                            best.at, inference::Options::to_rounding());
  limit_resistances(fit, residuals, series, shunt, 1.0, diode);
}

// The unit of the last decimal of a number that is printed with nine digits.
double last_decimal(double number) {
  std::array<char, 32> text;
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), number, std::chars_format::general, 9);
  const std::string shown(text.data(), end.ptr);
  const size_t exponent_at = std::min(shown.find('e'), shown.size());
  const size_t point = std::min(shown.find('.'), exponent_at);
  const size_t decimals = exponent_at - std::min(point + 1, exponent_at);
  int exponent = 0;
  if (exponent_at < shown.size()) exponent = std::stoi(shown.substr(exponent_at + 1));
  return std::pow(10.0, exponent - static_cast<int>(decimals));
}

}  // namespace
}  // namespace rated_points

RatedTolerance written_steps(std::span<const RatedPoint> points) {
  using namespace rated_points;
  RatedTolerance steps{1.0, 1.0, 0.0};
  for (const RatedPoint& p : points) {
    for (const double i : {p.short_circuit_A, p.maximum_A}) {
      steps.step_A = std::min(steps.step_A, last_decimal(i));
    }
    for (const double v : {p.open_circuit_V, p.maximum_V}) {
      steps.step_V = std::min(steps.step_V, last_decimal(v));
    }
  }
  return steps;
}

RatedFit fit_rated_points(std::span<const RatedPoint> points, const TemperatureSlopes& slopes,
                          double ideality_guess_V, const RatedTolerance& tolerance,
                          std::optional<ShuntLaw> shunt_law) {
  using namespace rated_points;
  check(points);
  if (shunt_law == ShuntLaw::exponential) {
    throw InputError({}, "shunt", "\"exponential\" with a datasheet", "it with curves");
  }
  const auto differs = [&](double RatedPoint::*figure) {
    return std::ranges::any_of(points,
                               [&](const RatedPoint& p) { return p.*figure != points[0].*figure; });
  };
  if (differs(&RatedPoint::temperature_K)) {
    return fit_rated_points(at_first_temperature(points, slopes), slopes, ideality_guess_V,
                            tolerance, shunt_law);
  }
  if (!(ideality_guess_V > 0)) {
    throw InputError({}, "datasheet", "n V_t = " + std::to_string(ideality_guess_V),
                     "a number > 0");
  }
  Figures figures{points, shunt_law.value_or(ShuntLaw::constant)};
  inference::Fit best = best_fit(figures, ideality_guess_V);
  double other_chi2 = 0.0;
  if (!shunt_law && differs(&RatedPoint::irradiance_W_m2)) {
    const Figures inverse{points, ShuntLaw::inverse};
    inference::Fit trial = best_fit(inverse, ideality_guess_V);
    other_chi2 = trial.chi2;
    constexpr double decisive = 0.25;  // half the rms
    if (std::isfinite(trial.chi2) &&
        predictive_error(inverse, ideality_guess_V, trial) <
            decisive * predictive_error(figures, ideality_guess_V, best)) {
      other_chi2 = best.chi2;
      figures = inverse;
      best = std::move(trial);
    }
  }
  if (best.at.size() == 0) {
    throw InputError({}, "datasheet",
                     std::to_string(points[0].open_circuit_V) +
                         " V at open circuit, that no diode of n V_t = " +
                         std::to_string(ideality_guess_V) + " V gives",
                     "the figures of one cell, or of a module with its cells_in_series");
  }
  RatedFit result = described(best.at, figures, slopes);
  const auto count = 3.0 * static_cast<double>(points.size());
  result.other_rms = std::sqrt(other_chi2 / count);
  result.rms_over_known = std::sqrt(relative_errors(figures, best.at)
                                        .cwiseQuotient(known_to(points, tolerance, 0.0))
                                        .squaredNorm() /
                                    count);
  const FigureErrors errors =
      scatter_errors(best, figures, slopes)
          .cwiseMax(rounding_errors(best.at, figures, slopes, ideality_guess_V, tolerance));
  SingleDiode& d = result.diode;
  Index row = 0;
  for (Estimate* of :
       {&d.photocurrent_A, &d.saturation_A, &d.scale_V, &d.series_ohm, &d.shunt_ohm}) {
    of->standard_error = errors[row++];
  }
  result.gap_error_eV = errors[row];
  limit_by_figures(best, figures, tolerance, d);
  result.bounds = bounds_reached(best, resistance_bounds(series, shunt));
  return result;
}

RatedPoint RatedFit::predict(double irradiance_W_m2, double temperature_K) const {
  const double light_A = diode.photocurrent_A.value *
                         std::pow(irradiance_W_m2 / first_W_m2, light_exponent) *
                         photocurrent_factor(model, temperature_K);
  return rated_point_of(model, light_A, irradiance_W_m2, temperature_K);
}

}  // namespace photorque
