#include "photovoltaics/fit/conditions.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/constants.h"
#include "core/errors.h"
#include "photovoltaics/fit/parts.h"

namespace photorque {
namespace several_conditions {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

// The shared parameters: the gap and the logarithms of I₀, n V_t, R_s and 1/R_sh at temperature and
// light of the first curve. Each curve has the logarithm of its photocurrent in addition.
enum Shared { gap, saturation, scale, series, shunt, shared_count };

constexpr double silicon_gap_eV = 1.121, silicon_gap_slope_1_K = -0.0002677;  // De Soto (2006)

struct Task {
  std::vector<CurveAt> curves;
  SweepNoise noise;
  ShuntLaw law = ShuntLaw::constant;
  double first_A = 1.0;         // approximate photocurrent of the first curve
  double reference_K = 298.15;  // of the shared values
  bool fits_gap = false;
  bool holds_shared = false;      // fits the photocurrents only
  std::vector<VectorXd> error_A;  // of each reading of each curve
};

// The circuit of a curve at its values (photocurrent, then shared), and d ln I₀/d gap.
struct Circuit {
  double photocurrent_A, saturation_A, scale_V, series_ohm, shunt_S;
  double saturation_by_gap_1_eV;

  CellCurve cell() const {
    return CellCurve(single_diode(saturation_A, scale_V, series_ohm, 1.0 / shunt_S));
  }
};

Circuit circuit_of(const Task& task, Index run, const VectorXd& x) {
  const double T = task.curves[static_cast<size_t>(run)].temperature_K, T0 = task.reference_K;
  const VectorXd s = x.tail(Index{shared_count});
  const double per_K = elementary_charge_C / boltzmann_J_K;
  const double by_gap = per_K * (1.0 / T0 - (1.0 + silicon_gap_slope_1_K * (T - T0)) / T);
  Circuit c{};
  c.photocurrent_A = std::exp(x[0]);
  c.saturation_A = std::exp(s[saturation] + 3.0 * std::log(T / T0) + s[gap] * by_gap);
  c.scale_V = std::exp(s[scale]) * T / T0;
  c.series_ohm = std::exp(s[series]);
  c.shunt_S = std::exp(s[shunt]);
  if (task.law == ShuntLaw::inverse) c.shunt_S *= c.photocurrent_A / task.first_A;
  c.saturation_by_gap_1_eV = by_gap;
  return c;
}

struct Reading {
  double current_A, slope_S;
  Eigen::Matrix<double, 1, 1 + shared_count> by;
};

// As point_of_curve() of fit.cpp: 0 = I_L − I₀ (e^{V_d/a} − 1) − G V_d − I with V_d = V + I R_s.
Reading reading_of(const Task& task, const Circuit& c, const CellCurve& cell, double voltage_V) {
  const double current = cell.current_A(c.photocurrent_A, voltage_V);
  const double diode_V = voltage_V + current * c.series_ohm;
  const double growth = std::expm1(diode_V / c.scale_V);
  const double junction_S = c.saturation_A * (growth + 1.0) / c.scale_V;
  const double conductance = junction_S + c.shunt_S;
  const double divisor = 1.0 + conductance * c.series_ohm;
  const double leak_A = c.shunt_S * diode_V;
  const double by_light = c.photocurrent_A - (task.law == ShuntLaw::inverse ? leak_A : 0.0);
  Reading r{current, conductance / divisor, {}};
  r.by << by_light, -c.saturation_A * growth * c.saturation_by_gap_1_eV, -c.saturation_A * growth,
      junction_S * diode_V, -conductance * current * c.series_ohm, -leak_A;
  r.by /= divisor;
  return r;
}

// The values of one curve: its photocurrent and the shared values.
VectorXd values_of(const VectorXd& at, Index run) {
  VectorXd x(1 + Index{shared_count});
  x << at[run], at.tail(Index{shared_count});
  return x;
}

void find_errors(Task& task, const VectorXd& at) {
  task.error_A.clear();
  for (size_t k = 0; k < task.curves.size(); ++k) {
    const auto run = static_cast<Index>(k);
    const Circuit c = circuit_of(task, run, values_of(at, run));
    const CellCurve cell = c.cell();
    const IvSweep& sweep = task.curves[k].sweep;
    VectorXd error(static_cast<Index>(sweep.voltage_V.size()));
    for (size_t i = 0; i < sweep.voltage_V.size(); ++i) {
      const Reading r = reading_of(task, c, cell, sweep.voltage_V[i]);
      error[static_cast<Index>(i)] =
          std::hypot(task.noise.current_fraction * r.current_A,
                     task.noise.voltage_fraction * sweep.voltage_V[i] * r.slope_S,
                     1e-6 * task.noise.current_fraction * c.photocurrent_A);
    }
    task.error_A.push_back(std::move(error));
  }
}

inference::ResidualFunction residuals_of(const Task& task) {
  return [&task](const VectorXd& x, Index run, VectorXd& residuals, MatrixXd* slopes) {
    const IvSweep& sweep = task.curves[static_cast<size_t>(run)].sweep;
    const auto points = static_cast<Index>(sweep.voltage_V.size());
    residuals = VectorXd::Constant(points, std::numeric_limits<double>::infinity());
    if (!reasonable(x)) return;
    const Circuit c = circuit_of(task, run, x);
    if (!(c.saturation_A > 0.0) || !std::isfinite(c.saturation_A)) return;
    const CellCurve cell = c.cell();
    if (slopes != nullptr) slopes->resize(points, x.size());
    const VectorXd& error = task.error_A[static_cast<size_t>(run)];
    for (Index i = 0; i < points; ++i) {
      const auto k = static_cast<size_t>(i);
      const Reading r = reading_of(task, c, cell, sweep.voltage_V[k]);
      residuals[i] = (sweep.current_A[k] - r.current_A) / error[i];
      if (slopes != nullptr) slopes->row(i) = r.by / error[i];
    }
  };
}

inference::Parameters parameters_from(const Task& task, const VectorXd& at) {
  const VectorXd s = at.tail(Index{shared_count});
  inference::Parameters all;
  all.shared = {
      {"gap", "eV", s[gap], silicon_gap_eV, task.fits_gap ? inference::infinity : 1e-9, 0.1, 5.0},
      {"saturation", "ln A", s[saturation]},
      {"n V_t", "ln V", s[scale]},
      {"series", "ln ohm", s[series]},
      {"shunt", "ln S", s[shunt]}};
  constexpr double held = 1e-9;
  for (inference::Parameter& p : all.shared) {
    if (!task.holds_shared) break;
    p.mean = p.value;
    p.sigma = held;
  }
  const SweepEnds ends = sweep_ends(task.curves[0].sweep);
  bound_resistances(ends.open_circuit_V / ends.short_circuit_A, all.shared[series],
                    all.shared[shunt]);
  for (size_t k = 0; k < task.curves.size(); ++k) {
    all.of_run.push_back({{"photocurrent", "ln A", at[static_cast<Index>(k)]}});
  }
  return all;
}

inference::Fit fit_rounds(Task& task, VectorXd at, int rounds) {
  inference::Fit fit;
  for (int round = 0; round < rounds; ++round) {
    find_errors(task, at);
    const inference::ResidualModel model(parameters_from(task, at), residuals_of(task));
    fit = inference::fit(model, at, inference::Options::to_rounding());
    if (!std::isfinite(fit.chi2)) return fit;
    at = fit.at;
  }
  return fit;
}

// Initial values: photocurrents from the short-circuit currents, the others from the first curve.
VectorXd start_of(const Task& task) {
  const SingleDiode first = fit_sweeps(std::span(&task.curves[0].sweep, 1), task.noise).diode;
  VectorXd at(static_cast<Index>(task.curves.size()) + Index{shared_count});
  for (size_t k = 0; k < task.curves.size(); ++k) {
    at[static_cast<Index>(k)] = std::log(sweep_ends(task.curves[k].sweep).short_circuit_A);
  }
  at.tail(Index{shared_count}) << silicon_gap_eV, std::log(first.saturation_A.value),
      std::log(first.scale_V.value), std::log(first.series_ohm.value),
      -std::log(first.shunt_ohm.value);
  return at;
}

inference::Fit best_fit(Task& task, const VectorXd& start, std::vector<OutlierReading>& outliers) {
  inference::Fit fit = fit_rounds(task, start, 4);
  for (int round = 0; round < 4 && std::isfinite(fit.chi2); ++round) {
    std::vector<std::vector<double>> off;
    for (size_t k = 0; k < task.curves.size(); ++k) {
      const auto run = static_cast<Index>(k);
      const Circuit c = circuit_of(task, run, values_of(fit.at, run));
      const CellCurve cell = c.cell();
      const IvSweep& sweep = task.curves[k].sweep;
      off.emplace_back();
      for (size_t i = 0; i < sweep.voltage_V.size(); ++i) {
        const Reading r = reading_of(task, c, cell, sweep.voltage_V[i]);
        const double error_A =
            std::hypot(task.noise.current_fraction * c.photocurrent_A,
                       task.noise.voltage_fraction * sweep.voltage_V[i] * r.slope_S);
        off.back().push_back(std::abs(sweep.current_A[i] - r.current_A) / error_A);
      }
    }
    std::vector<IvSweep*> sweeps;
    for (CurveAt& curve : task.curves) sweeps.push_back(&curve.sweep);
    if (!take_outliers(sweeps, off, outliers)) break;
    for (const CurveAt& curve : task.curves) check_sweep(curve.sweep);
    fit = fit_rounds(task, fit.at, 4);
  }
  return fit;
}

// Sum of squares of the residuals of a curve's current, divided by the square of its photocurrent.
double relative_squares(const Task& task, Index run, const VectorXd& at) {
  const Circuit c = circuit_of(task, run, values_of(at, run));
  const CellCurve cell = c.cell();
  const IvSweep& sweep = task.curves[static_cast<size_t>(run)].sweep;
  double sum = 0.0;
  for (size_t i = 0; i < sweep.voltage_V.size(); ++i) {
    const double off = sweep.current_A[i] - cell.current_A(c.photocurrent_A, sweep.voltage_V[i]);
    sum += off * off;
  }
  return sum / (c.photocurrent_A * c.photocurrent_A);
}

// The mean square residual of each curve under a fit to the other curves (five-fold
// cross-validation, or leave-one-out for fewer than five curves). Only the photocurrent is fitted
// to the curve itself. Infinite if the fit fails.
std::vector<double> predicted_squares(const Task& task, const VectorXd& start) {
  const size_t count = task.curves.size(), folds = std::min<size_t>(5, count);
  std::vector<size_t> by_light(count);
  std::iota(by_light.begin(), by_light.end(), size_t{0});
  std::ranges::stable_sort(by_light, {}, [&](size_t k) { return start[static_cast<Index>(k)]; });
  // The curves of one fold, or all others, with their lights and the shared values.
  const auto part = [&](size_t fold, bool others, const VectorXd& shared) {
    std::pair<Task, VectorXd> result{task, VectorXd(static_cast<Index>(count) + shared_count)};
    auto& [some, at] = result;
    some.curves.clear();
    for (size_t rank = 0; rank < count; ++rank) {
      if ((rank % folds == fold) == others) continue;
      at[static_cast<Index>(some.curves.size())] = start[static_cast<Index>(by_light[rank])];
      some.curves.push_back(task.curves[by_light[rank]]);
    }
    at.conservativeResize(static_cast<Index>(some.curves.size()) + shared_count);
    at.tail(Index{shared_count}) = shared;
    return result;
  };
  std::vector<double> squares(count, inference::infinity);
  for (size_t fold = 0; fold < folds; ++fold) {
    std::vector<OutlierReading> outliers;
    auto [others, at] = part(fold, true, start.tail(Index{shared_count}));
    const inference::Fit fit = best_fit(others, at, outliers);
    if (!std::isfinite(fit.chi2)) continue;
    auto [left_out, guess] = part(fold, false, fit.at.tail(Index{shared_count}));
    left_out.holds_shared = true;
    const inference::Fit lit = best_fit(left_out, guess, outliers);
    if (!std::isfinite(lit.chi2)) continue;
    for (size_t k = 0; k < left_out.curves.size(); ++k) {
      squares[by_light[fold + k * folds]] =
          relative_squares(left_out, static_cast<Index>(k), lit.at) /
          static_cast<double>(left_out.curves[k].sweep.voltage_V.size());
    }
  }
  return squares;
}

// Whether the other law predicts left-out curves better than the simple one: the mean logarithm of
// the ratio of their squares exceeds two standard errors.
bool predicts_better(const std::vector<double>& simple, const std::vector<double>& other) {
  double sum = 0.0, squares = 0.0;
  for (size_t k = 0; k < simple.size(); ++k) {
    if (!std::isfinite(other[k])) return false;
    if (!std::isfinite(simple[k])) return true;
    constexpr double rounding = 1e-24;
    const double gain = std::log((simple[k] + rounding) / (other[k] + rounding));
    sum += gain;
    squares += gain * gain;
  }
  const auto n = static_cast<double>(simple.size());
  const double variance = std::max(0.0, squares / n - sum / n * sum / n) / (n - 1.0);
  return sum / n > 2.0 * std::sqrt(variance);
}

void describe_light(const Task& task, ConditionsFit& result) {
  // ln(I_L/G) = c + α (T − T₀) by least squares.
  const double T0 = task.reference_K;
  double n = 0.0, sum_t = 0.0, sum_tt = 0.0, sum_y = 0.0, sum_ty = 0.0, sum_yy = 0.0;
  for (size_t k = 0; k < task.curves.size(); ++k) {
    const CurveAt& curve = task.curves[k];
    if (!(curve.irradiance_W_m2 > 0.0)) return;
    const double y = std::log(result.curves[k].photocurrent_A.value / curve.irradiance_W_m2);
    const double t = curve.temperature_K - T0;
    n += 1.0;
    sum_t += t;
    sum_tt += t * t;
    sum_y += y;
    sum_ty += t * y;
    sum_yy += y * y;
  }
  const double spread = n * sum_tt - sum_t * sum_t;
  const double slope = task.fits_gap ? (n * sum_ty - sum_t * sum_y) / spread : 0.0;
  result.model.photocurrent_slope_1_K = slope;
  if (task.fits_gap && n > 2.0) {
    const double left = sum_yy - sum_y * sum_y / n - slope * slope * spread / n;
    result.photocurrent_slope_error_1_K = std::sqrt(std::max(0.0, left) / (n - 2.0) * n / spread);
  }
  result.photocurrent_A_m2_W = std::exp((sum_y - slope * sum_t) / n);
}

ConditionsFit described(const Task& task, const inference::Fit& fit,
                        std::vector<OutlierReading> outliers) {
  const VectorXd& at = fit.at;
  const VectorXd error = fit.scatter_errors();
  const auto curves = static_cast<Index>(task.curves.size());
  const VectorXd s = at.tail(Index{shared_count}), e = error.tail(Index{shared_count});
  ConditionsFit result;
  result.outliers = std::move(outliers);
  result.shunt_law = task.law;
  const Circuit first = circuit_of(task, 0, values_of(at, 0));
  result.diode.photocurrent_A = exponential(at[0], error[0]);
  result.diode.saturation_A = exponential(s[saturation], e[saturation]);
  result.diode.scale_V = exponential(s[scale], e[scale]);
  result.diode.series_ohm = exponential(s[series], e[series]);
  result.diode.shunt_ohm = {1.0 / first.shunt_S, e[shunt] / first.shunt_S};
  result.model.reference = result.diode.parameters(task.reference_K);
  if (task.law == ShuntLaw::inverse) {
    result.model.reference.shunt_light_A = first.photocurrent_A;
  }
  result.model.gap_eV = s[gap];
  result.model.gap_slope_1_K = silicon_gap_slope_1_K;
  result.gap_error_eV = task.fits_gap ? e[gap] : 0.0;
  result.variance = fit.variance();
  result.points = static_cast<size_t>(fit.samples);
  double squares = 0.0;
  for (Index run = 0; run < curves; ++run) {
    const double sum = relative_squares(task, run, at);
    const double light_A = std::exp(at[run]);
    const auto readings =
        static_cast<double>(task.curves[static_cast<size_t>(run)].sweep.voltage_V.size());
    squares += sum;
    result.curves.push_back(
        {exponential(at[run], error[run]), light_A * std::sqrt(sum / readings)});
  }
  result.rms = std::sqrt(squares / static_cast<double>(result.points));
  std::vector<NamedBound> named = resistance_bounds(series, shunt);
  result.bounds = bounds_reached(fit, named, Index{curves});
  describe_light(task, result);
  return result;
}

}  // namespace
}  // namespace several_conditions

ConditionsFit fit_conditions(std::span<const CurveAt> curves, const SweepNoise& noise,
                             std::optional<ShuntLaw> shunt_law) {
  using namespace several_conditions;
  if (curves.empty()) throw InputError({}, "curves", "none", "at least one");
  for (const CurveAt& curve : curves) check_sweep(curve.sweep);
  Task task;
  task.curves.assign(curves.begin(), curves.end());
  task.noise = noise;
  task.reference_K = curves[0].temperature_K;
  const auto [coldest, warmest] = std::ranges::minmax(curves, {}, &CurveAt::temperature_K);
  constexpr double least_K = 5.0;
  task.fits_gap = warmest.temperature_K - coldest.temperature_K >= least_K;
  const Eigen::VectorXd start = start_of(task);
  task.first_A = std::exp(start[0]);
  task.law = shunt_law.value_or(ShuntLaw::constant);
  std::vector<OutlierReading> outliers;
  Task fitted = task;
  inference::Fit best = best_fit(fitted, start, outliers);
  const auto lights = start.head(static_cast<Eigen::Index>(curves.size()));
  constexpr double apart = 0.2;
  if (!shunt_law && lights.maxCoeff() - lights.minCoeff() > apart) {
    Task other = task;
    other.law = ShuntLaw::inverse;
    std::vector<OutlierReading> other_outliers;
    inference::Fit trial = best_fit(other, start, other_outliers);
    if (std::isfinite(trial.chi2) &&
        (!std::isfinite(best.chi2) ||
         predicts_better(predicted_squares(task, start), predicted_squares(other, start)))) {
      best = std::move(trial);
      outliers = std::move(other_outliers);
      fitted = std::move(other);
    }
  }
  if (!std::isfinite(best.chi2)) {
    throw InputError({}, "curves", "curves and noise that no diode fits together",
                     "curves of one lit device, their temperatures and their noise");
  }
  return described(fitted, best, std::move(outliers));
}

}  // namespace photorque
