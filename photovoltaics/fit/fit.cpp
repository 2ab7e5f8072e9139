// Fits of whole sweeps in uniform light.
#include "photovoltaics/fit/fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/errors.h"
#include "photovoltaics/fit/parts.h"

namespace photorque {
namespace even_light {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

// The fitted parameters are I_L, the logarithms of I₀, n V_t, R_s and 1/R_sh, and, for sweeps in
// both directions, τ of the charge storage.
enum Parameter { light, saturation, scale, series, shunt, count, storage = count };

std::vector<DiodeCurrent> currents(const IvSweep& sweep, const VectorXd& x) {
  return currents_of(
      {std::exp(x[saturation]), std::exp(x[scale]), std::exp(x[series]), std::exp(x[shunt])},
      x[light], sweep, x.size() > count ? std::optional(x[storage]) : std::nullopt);
}

// The covariance of the currents of one sweep, at a fitted curve, as its Cholesky factor.
MatrixXd covariance_root(const IvSweep& sweep, const SweepNoise& noise, const VectorXd& x) {
  const std::vector<DiodeCurrent> fitted = currents(sweep, x);
  const auto points = static_cast<Index>(fitted.size());
  VectorXd from_light(points);
  MatrixXd covariance = MatrixXd::Zero(points, points);
  for (Index i = 0; i < points; ++i) {
    const double v = sweep.voltage_V[static_cast<size_t>(i)];
    const DiodeCurrent& p = fitted[static_cast<size_t>(i)];
    from_light[i] = noise.current_fraction * p.current_A;
    const double from_voltage_A = noise.voltage_fraction * v * p.slope_S;
    const double rounding_A = 1e-6 * noise.current_fraction * x[light];
    covariance(i, i) = from_voltage_A * from_voltage_A + rounding_A * rounding_A;
  }
  for (Index i = 0; i < points; ++i) {
    for (Index j = 0; j < points; ++j) {
      const double apart = static_cast<double>(std::abs(i - j));
      const double correlation = i == j ? 1.0
                                 : noise.correlation_points > 0
                                     ? std::exp(-apart / noise.correlation_points)
                                     : 0.0;
      covariance(i, j) += correlation * from_light[i] * from_light[j];
    }
  }
  return covariance.llt().matrixL();
}

std::vector<inference::Parameter> parameters_from(const VectorXd& x, const SweepEnds& ends) {
  std::vector<inference::Parameter> all =
      diode_parameters(x, saturation, ends.open_circuit_V / ends.short_circuit_A);
  all.insert(all.begin(), {"photocurrent", "A", x[light]});
  if (x.size() > count) all.push_back({"storage", "s", x[storage]});
  return all;
}

// The residuals of some sweeps, whitened by the roots of their covariances. All arguments must
// outlive the result.
inference::ResidualFunction whitened(std::span<const IvSweep> sweeps,
                                     const std::vector<MatrixXd>& roots) {
  Index points = 0;
  for (const IvSweep& sweep : sweeps) points += static_cast<Index>(sweep.voltage_V.size());
  return [sweeps, &roots, points](const VectorXd& x, Index, VectorXd& residuals, MatrixXd* slopes) {
    residuals = VectorXd::Constant(points, std::numeric_limits<double>::infinity());
    if (!reasonable(x)) return;
    if (slopes != nullptr) slopes->resize(points, x.size());
    Index row = 0;
    for (size_t s = 0; s < sweeps.size(); ++s) {
      const Index first = row;
      const double* measured_A = sweeps[s].current_A.data();
      for (const DiodeCurrent& p : currents(sweeps[s], x)) {
        residuals[row] = *measured_A++ - p.current_A;
        if (slopes != nullptr) slopes->row(row) = p.derivatives_A.head(x.size());
        ++row;
      }
      const auto root = roots[s].triangularView<Eigen::Lower>();
      root.solveInPlace(residuals.segment(first, row - first));
      if (slopes != nullptr) root.solveInPlace(slopes->middleRows(first, row - first));
    }
  };
}

std::vector<MatrixXd> covariance_roots(std::span<const IvSweep> sweeps, const SweepNoise& noise,
                                       const VectorXd& x) {
  std::vector<MatrixXd> roots;
  for (const IvSweep& sweep : sweeps) roots.push_back(covariance_root(sweep, noise, x));
  return roots;
}

inference::Fit fit_round(std::span<const IvSweep> sweeps, const std::vector<MatrixXd>& roots,
                         const VectorXd& start) {
  const inference::ResidualModel model(parameters_from(start, sweep_ends(sweeps[0])),
                                       whitened(sweeps, roots));
  return inference::fit(model, start, inference::Options::to_rounding());
}

// Repeats the fit. The weights of each round are computed from the curve of the previous round.
inference::Fit fit_rounds(std::span<const IvSweep> sweeps, const SweepNoise& noise, VectorXd x,
                          int rounds) {
  inference::Fit fit;
  for (int round = 0; round < rounds; ++round) {
    fit = fit_round(sweeps, covariance_roots(sweeps, noise, x), x);
    x = fit.at;
  }
  return fit;
}

// χ² may have several minima: the best fit of one sweep from sharp and blunt knees.
VectorXd start_from(const IvSweep& sweep, const SweepNoise& noise) {
  const SweepEnds ends = sweep_ends(sweep);
  inference::Fit best;
  for (const double knee : {16.0, 22.0, 30.0}) {
    VectorXd start(Index{count});
    start << ends.short_circuit_A, std::log(ends.short_circuit_A) - knee,
        std::log(ends.open_circuit_V / knee),
        std::log(0.02 * ends.open_circuit_V / ends.short_circuit_A),
        std::log(0.01 * ends.short_circuit_A / ends.open_circuit_V);
    const inference::Fit fit = fit_rounds(std::span(&sweep, 1), noise, start, 2);
    if (fit.chi2 < best.chi2) best = fit;
  }
  if (best.at.size() == 0) {
    throw InputError({}, "curves", "a sweep that no diode fits with this noise",
                     "a current-voltage curve of a lit cell and its noise");
  }
  return best.at;
}

double rms_A(std::span<const IvSweep> sweeps, const VectorXd& x) {
  double squares = 0.0, points = 0.0;
  for (const IvSweep& sweep : sweeps) {
    squares += squares_A2(sweep, currents(sweep, x));
    points += static_cast<double>(sweep.voltage_V.size());
  }
  return std::sqrt(squares / points);
}

// Whether the voltage rises over a part of the readings and falls over another one.
bool has_both_directions(std::span<const IvSweep> sweeps) {
  double up_V = 0.0, down_V = 0.0;
  for (const IvSweep& sweep : sweeps) {
    if (sweep.rate_V_s.size() != sweep.voltage_V.size()) return false;
    if (sweep.is_timed != sweeps[0].is_timed) return false;
    for (const double rate : sweep.rate_V_s) (rate > 0.0 ? up_V : down_V) += std::abs(rate);
  }
  constexpr double least = 0.1;
  return std::min(up_V, down_V) > least * std::max(up_V, down_V);
}

// The charge storage of a fit; nothing if it is not determined.
std::optional<ChargeStorage> storage_of(std::span<const IvSweep> sweeps,
                                        const inference::Fit& fit) {
  ChargeStorage found;
  found.time = {fit.at[storage], fit.scatter_errors()[storage]};
  found.is_timed = sweeps[0].is_timed;
  constexpr double certain = 3.0;
  if (!(std::abs(found.time.value) > certain * found.time.standard_error)) return std::nullopt;
  for (const IvSweep& sweep : sweeps) {
    const auto fitted = currents(sweep, fit.at),
               steady = currents(sweep, fit.at.head(Index{count}));
    for (size_t i = 0; i < fitted.size(); ++i) {
      const double off_A = fitted[i].current_A - steady[i].current_A;
      found.largest_A = std::max(found.largest_A, 2.0 * std::abs(off_A));
    }
  }
  return found;
}

// The best fit without outliers, which are moved from `sweeps` to `outliers`. It includes the
// charge storage if that is determined.
inference::Fit best_fit(std::vector<IvSweep>& sweeps, const SweepNoise& noise,
                        std::vector<OutlierReading>& outliers) {
  const bool may_store = has_both_directions(sweeps);
  const auto fitted = [&] {
    inference::Fit fit = fit_rounds(sweeps, noise, start_from(sweeps[0], noise), 4);
    if (!may_store || !std::isfinite(fit.chi2)) return fit;
    VectorXd start(fit.at.size() + 1);
    start << fit.at, 0.0;
    const inference::Fit stored = fit_rounds(sweeps, noise, start, 6);
    return std::isfinite(stored.chi2) && storage_of(sweeps, stored) ? stored : fit;
  };
  std::vector<IvSweep*> changed;
  for (IvSweep& sweep : sweeps) changed.push_back(&sweep);
  const auto off_curve = [&](size_t sweep, const VectorXd& x) {
    return deviations(sweeps[sweep], currents(sweeps[sweep], x), noise, x[light]);
  };
  return refit_without_outliers(
      fitted(), changed, off_curve, [&](const VectorXd&) { return fitted(); }, outliers);
}

}  // namespace
}  // namespace even_light

SweepFit fit_sweeps(std::span<const IvSweep> sweeps, const SweepNoise& noise) {
  using namespace even_light;
  if (sweeps.empty()) throw InputError({}, "curves", "none", "at least one sweep");
  for (const IvSweep& sweep : sweeps) check_sweep(sweep);
  SweepFit result;
  std::vector<IvSweep> kept(sweeps.begin(), sweeps.end());
  for (IvSweep& sweep : kept) sweep.light.clear();
  inference::Fit best = best_fit(kept, noise, result.outliers);
  if (std::ranges::any_of(sweeps, [](const IvSweep& one) { return !one.light.empty(); })) {
    std::vector<IvSweep> lit(sweeps.begin(), sweeps.end());
    std::vector<OutlierReading> outliers;
    inference::Fit trial = best_fit(lit, noise, outliers);
    // A linear change of the light has the curve of a leak: the scatter then does not decide.
    constexpr double clearly_worse = 4.0;  // twice the scatter
    result.uses_light =
        std::isfinite(trial.chi2) &&
        (!std::isfinite(best.chi2) || trial.variance() < clearly_worse * best.variance());
    if (result.uses_light) {
      best = std::move(trial);
      kept = std::move(lit);
      result.outliers = std::move(outliers);
    }
  }
  sweeps = kept;
  if (!std::isfinite(best.chi2)) {
    throw InputError({}, "curves", "sweeps that no diode fits together with this noise",
                     "sweeps of one lit cell and their noise");
  }
  const VectorXd& x = best.at;
  result.variance = best.variance();
  const VectorXd error = best.scatter_errors();
  result.diode = diode_at({x[light], error[light]}, x, error, saturation);
  const std::vector<MatrixXd> roots = covariance_roots(sweeps, noise, x);
  const inference::Fit settled = fit_round(sweeps, roots, x);
  limit_resistances(settled, whitened(sweeps, roots), series, shunt, settled.variance(),
                    result.diode);
  result.bounds = bounds_reached(best, resistance_bounds(series, shunt));
  result.rms_A = rms_A(sweeps, x);
  result.points = static_cast<size_t>(best.samples);
  if (x.size() > count) result.storage = storage_of(sweeps, best);
  return result;
}

}  // namespace photorque
