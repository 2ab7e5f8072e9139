#include "photovoltaics/fit/conditions.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <ranges>

#include "core/constants.h"
#include "core/errors.h"
#include "core/numerics/median.h"
#include "core/numerics/order.h"
#include "photovoltaics/fit/parts.h"

namespace photorque {
namespace several_conditions {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

// The shared parameters: the gap, the logarithms of I₀, n V_t, R_s and 1/R_sh at temperature and
// light of the first curve, and of R_sh in the dark over that. Each curve has the logarithm of its
// photocurrent in addition.
enum Shared { gap, saturation, scale, series, shunt, dark, shared_count };

struct Task {
  std::vector<CurveAt> curves;
  SweepNoise noise;
  ShuntLaw law = ShuntLaw::constant;
  double first_A = 1.0;         // approximate photocurrent of the first curve
  double brightest_A = 1.0;     // largest photocurrent
  double reference_K = 298.15;  // temperature of the shared values
  bool fits_gap = false;
  bool holds_shared = false;      // fits the photocurrents only
  double misfit = 0.0;            // error of the model, as a fraction of the photocurrent
  double variance = 0.0;          // per degree of freedom, in units of the noise alone
  std::vector<VectorXd> error_A;  // one per reading of each curve

  // c of in_light(): PVsyst's 5.5 at the largest photocurrent.
  double shunt_exponent() const { return 5.5 * first_A / brightest_A; }
};

// The circuit of a curve at its values (photocurrent, then shared), and d ln I₀/d gap.
struct Circuit {
  double photocurrent_A;
  DiodeCircuit diode;
  double saturation_by_gap_1_eV;
  double shunt_by_light, shunt_by_dark;  // d ln R_sh by the logarithms

  std::vector<DiodeCurrent> currents(const IvSweep& sweep) const {
    return currents_of(diode, photocurrent_A, sweep);
  }
};

Circuit circuit_of(const Task& task, Index run, const VectorXd& x) {
  const double T = task.curves[static_cast<size_t>(run)].temperature_K, T0 = task.reference_K;
  const VectorXd s = x.tail(Index{shared_count});
  const double per_K = elementary_charge_C / boltzmann_J_K;
  const double by_gap = per_K * (1.0 / T0 - (1.0 + silicon_gap_slope_1_K * (T - T0)) / T);
  Circuit c{};
  c.photocurrent_A = std::exp(x[0]);
  c.diode = {std::exp(s[saturation] + 3.0 * std::log(T / T0) + s[gap] * by_gap),
             std::exp(s[scale]) * T / T0, std::exp(s[series]), std::exp(s[shunt])};
  const double light = c.photocurrent_A / task.first_A;
  if (task.law == ShuntLaw::inverse) {
    c.diode.shunt_S *= light;
    c.shunt_by_light = -1.0;
  } else if (task.law == ShuntLaw::exponential) {
    // R_sh relative to that of the first curve, by the law of in_light().
    const double exponent = task.shunt_exponent(), full = std::exp(-exponent);
    const double in_dark = std::exp(s[dark]), base = (1.0 - in_dark * full) / (1.0 - full);
    const double fallen = std::exp(-exponent * light);
    const double times = base + (in_dark - base) * fallen;
    c.diode.shunt_S /= times;
    c.shunt_by_light = -exponent * light * (in_dark - base) * fallen / times;
    c.shunt_by_dark = in_dark * (fallen - full) / (1.0 - full) / times;
  }
  c.saturation_by_gap_1_eV = by_gap;
  return c;
}

// The derivatives of a current by the values of its curve.
Eigen::Matrix<double, 1, 1 + shared_count> derivatives_A(const Circuit& c,
                                                         const DiodeCurrent& current) {
  const auto& by = current.derivatives_A;
  constexpr int by_light = 0, by_saturation = 1, by_scale = 2, by_series = 3, by_shunt = 4;
  return {by[by_light] * c.photocurrent_A - by[by_shunt] * c.shunt_by_light,
          by[by_saturation] * c.saturation_by_gap_1_eV,
          by[by_saturation],
          by[by_scale],
          by[by_series],
          by[by_shunt],
          -by[by_shunt] * c.shunt_by_dark};
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
    const IvSweep& sweep = task.curves[k].sweep;
    const std::vector<DiodeCurrent> currents = c.currents(sweep);
    VectorXd error(static_cast<Index>(currents.size()));
    for (size_t i = 0; i < currents.size(); ++i) {
      error[static_cast<Index>(i)] =
          std::hypot(task.noise.current_fraction * currents[i].current_A,
                     task.noise.voltage_fraction * sweep.voltage_V[i] * currents[i].slope_S,
                     std::max(1e-6 * task.noise.current_fraction, task.misfit) * c.photocurrent_A);
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
    if (!(c.diode.saturation_A > 0.0) || !std::isfinite(c.diode.saturation_A)) return;
    const std::vector<DiodeCurrent> currents = c.currents(sweep);
    if (slopes != nullptr) slopes->resize(points, x.size());
    const VectorXd& error = task.error_A[static_cast<size_t>(run)];
    for (Index i = 0; i < points; ++i) {
      const auto k = static_cast<size_t>(i);
      residuals[i] = (sweep.current_A[k] - currents[k].current_A) / error[i];
      if (slopes != nullptr) slopes->row(i) = derivatives_A(c, currents[k]) / error[i];
    }
  };
}

inference::Parameters parameters_from(const Task& task, const VectorXd& at) {
  const VectorXd s = at.tail(Index{shared_count});
  inference::Parameters all;
  const SweepEnds ends = sweep_ends(task.curves[0].sweep);
  all.shared = diode_parameters(s, saturation, ends.open_circuit_V / ends.short_circuit_A);
  all.shared.insert(all.shared.begin(), {"gap", "eV", s[gap], silicon_gap_eV,
                                         task.fits_gap ? inference::infinity : 1e-9, 0.1, 5.0});
  all.shared.push_back(
      {"dark", "", s[dark], s[dark], inference::infinity, 0.0, task.shunt_exponent()});
  constexpr double held = 1e-9;
  if (task.law != ShuntLaw::exponential) all.shared[dark].sigma = held;
  for (inference::Parameter& p : all.shared) {
    if (!task.holds_shared) break;
    p.mean = p.value;
    p.sigma = held;
  }
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
      -std::log(first.shunt_ohm.value), 0.5 * task.shunt_exponent();
  return at;
}

// Sum of the squared residuals of a curve, each relative to its photocurrent.
double relative_squares(const Task& task, Index run, const VectorXd& at) {
  const Circuit c = circuit_of(task, run, values_of(at, run));
  const IvSweep& sweep = task.curves[static_cast<size_t>(run)].sweep;
  return squares_A2(sweep, c.currents(sweep)) / (c.photocurrent_A * c.photocurrent_A);
}

inference::Fit best_fit(Task& task, const VectorXd& start, std::vector<OutlierReading>& outliers) {
  std::vector<IvSweep*> sweeps;
  for (CurveAt& curve : task.curves) sweeps.push_back(&curve.sweep);
  const auto refit = [&](const VectorXd& at) { return fit_rounds(task, at, 4); };
  const auto off_curve = [&](size_t k, const VectorXd& at) {
    const auto run = static_cast<Index>(k);
    const Circuit c = circuit_of(task, run, values_of(at, run));
    return deviations(*sweeps[k], c.currents(*sweeps[k]), task.noise, c.photocurrent_A);
  };
  const inference::Fit fit =
      refit_without_outliers(refit(start), sweeps, off_curve, refit, outliers);
  // Residuals far beyond the noise are errors of the model, which have one size at all voltages.
  constexpr double far = 3.0;
  task.variance = fit.variance();
  if (!std::isfinite(fit.chi2) || task.variance < far * far) return fit;
  double squares = 0.0, readings = 0.0;
  for (size_t k = 0; k < task.curves.size(); ++k) {
    squares += relative_squares(task, static_cast<Index>(k), fit.at);
    readings += static_cast<double>(task.curves[k].sweep.voltage_V.size());
  }
  task.misfit = std::sqrt(squares / readings);
  return fit_rounds(task, fit.at, 4);
}

// The mean square residual of each curve under a fit to the other curves (five-fold
// cross-validation, or leave-one-out for fewer than five curves). Only the photocurrent is fitted
// to the curve itself. Infinite if the fit fails.
std::vector<double> predicted_squares(const Task& task, const VectorXd& start) {
  const size_t count = task.curves.size(), folds = std::min<size_t>(5, count);
  const std::vector<size_t> by_light = sorted_indices(count, [&](size_t a, size_t b) {
    return start[static_cast<Index>(a)] < start[static_cast<Index>(b)];
  });
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
  result.diode = diode_at(exponential(at[0], error[0]), s, e, saturation);
  result.diode.shunt_ohm = {1.0 / first.diode.shunt_S, e[shunt] / first.diode.shunt_S};
  result.model.reference = result.diode.parameters(task.reference_K);
  if (task.law != ShuntLaw::constant) {
    result.model.reference.shunt_light_A = first.photocurrent_A;
  }
  if (task.law == ShuntLaw::exponential) {
    // Refers to the fitted photocurrent of the first curve, which differs from the initial one.
    const double times = std::exp(s[dark]) / std::exp(s[shunt]);
    result.model.reference.shunt_dark_ohm = times;
    result.model.reference.shunt_exponent =
        task.shunt_exponent() * first.photocurrent_A / task.first_A;
  }
  result.model.gap_eV = s[gap];
  result.model.gap_slope_1_K = silicon_gap_slope_1_K;
  result.gap_error_eV = task.fits_gap ? e[gap] : 0.0;
  result.variance = task.variance;
  result.points = static_cast<size_t>(fit.samples);
  double squares = 0.0;
  for (Index run = 0; run < curves; ++run) {
    const double sum = relative_squares(task, run, at);
    const double light_A = std::exp(at[run]);
    const auto readings =
        static_cast<double>(task.curves[static_cast<size_t>(run)].sweep.voltage_V.size());
    squares += sum;
    const auto k = static_cast<size_t>(run);
    result.curves.push_back({k, exponential(at[run], error[run]),
                             light_A * std::sqrt(sum / readings),
                             !task.curves[k].sweep.light.empty()});
  }
  result.rms = std::sqrt(squares / static_cast<double>(result.points));
  std::vector<NamedBound> named = resistance_bounds(series, shunt);
  result.bounds = bounds_reached(fit, named, Index{curves});
  describe_light(task, result);
  return result;
}

// The curves that one diode may describe; `omitted` receives the others. The irradiance of single
// readings is kept unless it doubles the scatter of its curve.
std::vector<CurveAt> described_curves(std::span<const CurveAt> curves, const SweepNoise& noise,
                                      std::vector<size_t>& kept,
                                      std::vector<ConditionsFit::Omitted>& omitted) {
  std::vector<CurveAt> all(curves.begin(), curves.end());
  kept.resize(all.size());
  std::iota(kept.begin(), kept.end(), size_t{0});
  constexpr size_t fewest = 4;
  const bool may_omit = all.size() >= fewest;
  std::vector<double> rms, scatter, ideality;
  for (CurveAt& curve : all) {
    if (!may_omit && curve.sweep.light.empty()) continue;
    const SweepFit own = fit_sweeps(std::span(&curve.sweep, 1), noise);
    if (!own.uses_light) curve.sweep.light.clear();
    rms.push_back(own.rms_A / own.diode.photocurrent_A.value);
    scatter.push_back(std::sqrt(own.variance));
    ideality.push_back(own.diode.scale_V.value / curve.temperature_K);
  }
  // Puts the reference first: the brightest curve, if it is more than twice as bright as the first
  // one.
  const auto by_light = [&] {
    constexpr double far_brighter = 2.0;
    const auto light = [&](size_t k) { return sweep_ends(all[k].sweep).short_circuit_A; };
    const auto brightest = std::ranges::max_element(kept, {}, light);
    if (light(*brightest) > far_brighter * light(kept[0])) {
      std::rotate(kept.begin(), brightest, brightest + 1);
    }
    std::vector<CurveAt> some;
    for (const size_t k : kept) some.push_back(all[k]);
    return some;
  };
  if (!may_omit) return by_light();
  constexpr double least = 0.005, far = 2.5;
  const double rms_limit = std::max(2.0 * least, far * upper_median(rms));
  const double scatter_limit = far * upper_median(scatter), usual_ideality = upper_median(ideality);
  const auto out = [&](size_t k) {
    return rms[k] > rms_limit || (rms[k] > least && scatter[k] > scatter_limit) ||
           ideality[k] < usual_ideality / far || ideality[k] > usual_ideality * far;
  };
  const auto count = static_cast<size_t>(std::ranges::count_if(kept, out));
  if (3 * count > all.size()) return by_light();
  for (const size_t k : kept) {
    if (out(k)) omitted.push_back({k, rms[k]});
  }
  std::erase_if(kept, out);
  return by_light();
}

}  // namespace
}  // namespace several_conditions

ConditionsFit fit_conditions(std::span<const CurveAt> curves, const SweepNoise& noise,
                             std::optional<ShuntLaw> shunt_law) {
  using namespace several_conditions;
  if (curves.empty()) throw InputError({}, "curves", "none", "at least one");
  for (const CurveAt& curve : curves) check_sweep(curve.sweep);
  std::vector<size_t> kept;
  std::vector<ConditionsFit::Omitted> omitted;
  Task task;
  task.curves = described_curves(curves, noise, kept, omitted);
  task.noise = noise;
  task.reference_K = task.curves[0].temperature_K;
  const auto [coldest, warmest] = std::ranges::minmax(task.curves, {}, &CurveAt::temperature_K);
  constexpr double least_K = 5.0;
  task.fits_gap = warmest.temperature_K - coldest.temperature_K >= least_K;
  const auto ends = [](const CurveAt& curve) { return sweep_ends(curve.sweep).short_circuit_A; };
  task.first_A = ends(task.curves[0]);
  task.brightest_A = std::ranges::max(task.curves | std::views::transform(ends));
  const double dimmest_A = std::ranges::min(task.curves | std::views::transform(ends));
  const Eigen::VectorXd start = start_of(task);
  task.law = shunt_law.value_or(ShuntLaw::constant);
  std::vector<OutlierReading> outliers;
  Task fitted = task;
  inference::Fit best = best_fit(fitted, start, outliers);
  constexpr double apart = 1.2, far_apart = 4.0;
  constexpr size_t enough = 5;
  const double range = task.brightest_A / dimmest_A;
  std::vector<ShuntLaw> others;
  if (!shunt_law && range > apart) others.push_back(ShuntLaw::inverse);
  if (!shunt_law && range > far_apart && task.curves.size() >= enough) {
    others.push_back(ShuntLaw::exponential);
  }
  std::vector<double> predicted;  // predicted by the best law
  if (!others.empty()) predicted = predicted_squares(task, start);
  for (const ShuntLaw law : others) {
    Task other = task;
    other.law = law;
    std::vector<OutlierReading> other_outliers;
    inference::Fit trial = best_fit(other, start, other_outliers);
    if (!std::isfinite(trial.chi2)) continue;
    std::vector<double> squares = predicted_squares(other, start);
    if (std::isfinite(best.chi2) && !predicts_better(predicted, squares)) continue;
    best = std::move(trial);
    outliers = std::move(other_outliers);
    fitted = std::move(other);
    predicted = std::move(squares);
  }
  if (!std::isfinite(best.chi2)) {
    throw InputError({}, "curves", "curves that no diode fits together with this noise",
                     "curves of one lit device, their temperatures and their noise");
  }
  ConditionsFit result = described(fitted, best, std::move(outliers));
  for (ConditionsFit::Curve& curve : result.curves) curve.index = kept[curve.index];
  result.omitted = std::move(omitted);
  return result;
}

}  // namespace photorque
