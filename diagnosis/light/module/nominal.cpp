#include "diagnosis/light/module/nominal.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/errors.h"
#include "core/numerics/median.h"
#include "core/numerics/order.h"
#include "inference/estimator/fit.h"
#include "inference/estimator/forward_model.h"

namespace photorque {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

// Expected sizes of the powers of Translation. A healthy module of 36 cells (pvlib, 12 curves from
// 580 to 1080 W/m² and 31 to 61 °C) is translated from its brightest curve. It gives R_s ∝
// (T/T₀)^1.9 and n ∝ (T/T₀)^0.95 without powers of light, or S^0.27 and S^0.14 without powers of
// temperature. 25 curves of a module of 60 cells (NIST) from 14 to 960 W/m² give less.
constexpr double translation_sigma[] = {0.25, 2.5, 0.1, 1.0, 0.5};

// The numbers of a cell in the order of ModuleNominal::numbers: those with logarithms, and powers.
constexpr double ModuleCell::*cell_numbers[] = {&ModuleCell::photocurrent_A,
                                                &ModuleCell::saturation_A, &ModuleCell::ideality,
                                                &ModuleCell::series_ohm, &ModuleCell::shunt_ohm};
constexpr double Translation::*translation_powers[] = {
    &Translation::series_by_light, &Translation::series_by_temperature,
    &Translation::ideality_by_light, &Translation::ideality_by_temperature,
    &Translation::shunt_by_light};

// The cell from logarithms and from powers in units of their expected sizes.
ModuleCell cell_of(const VectorXd& x, double temperature_K) {
  ModuleCell cell;
  cell.temperature_K = temperature_K;
  for (Index k = 0; k < 5; ++k) cell.*cell_numbers[k] = std::exp(x[k]);
  if (x.size() < ModuleNominal::numbers) return cell;
  for (Index k = 0; k < 5; ++k)
    cell.translation.*translation_powers[k] = translation_sigma[k] * x[5 + k];
  return cell;
}

// Noise from second differences, which are nearly zero for a smooth curve.
double noise_of(const std::vector<double>& current_A) {
  std::vector<double> second;
  for (size_t i = 2; i < current_A.size(); ++i) {
    second.push_back(std::abs(current_A[i] - 2.0 * current_A[i - 1] + current_A[i - 2]));
  }
  return upper_median(std::move(second)) / normal_median / std::sqrt(6.0);
}

// Logarithms of the parameters of one cell from the fit of a whole device.
VectorXd logs_of(const SingleDiode& d, int cells, double temperature_K) {
  const double thermal_V = boltzmann_J_K * temperature_K / elementary_charge_C;
  VectorXd logs(5);
  logs << std::log(d.photocurrent_A.value), std::log(d.saturation_A.value),
      std::log(d.scale_V.value / (cells * thermal_V)),
      std::log(std::max(d.series_ohm.value, 1e-6) / cells), std::log(d.shunt_ohm.value / cells);
  return logs;
}

struct ReferenceFit {
  inference::Fit fit;
  std::vector<ModuleSweep> sweeps;
  std::vector<VectorXd> residuals_A;
};

constexpr Index own = 2;  // per curve: log light, deviation from the stated temperature

inference::Parameters reference_parameters(const ModuleDesign& design,
                                           const std::vector<ModuleSweep>& sweeps) {
  const ModuleSweep& first = sweeps.front();
  const double scale_A = first.current_A.front();
  const SweepFit start = fit_sweeps(std::vector<IvSweep>{{first.voltage_V, first.current_A}}, {});
  const VectorXd logs = logs_of(start.diode, design.cells, design.reference_temperature_K);
  inference::Parameters parameters;
  const char* const names[] = {"photocurrent", "saturation", "ideality", "series", "shunt"};
  // Bounds of real silicon and its contacts: a fit that ends there has a large misfit.
  const double low[] = {logs[0] - 1.0, logs[1] - 30.0, std::log(0.5), std::log(1e-6),
                        std::log(1e-2)};
  const double high[] = {logs[0] + 1.0, logs[1] + 30.0, std::log(4.0), std::log(1e2),
                         std::log(1e7)};
  for (size_t k = 0; k < 5; ++k) {
    const double at = std::clamp(logs[static_cast<Index>(k)], low[k] + 1e-6, high[k] - 1e-6);
    parameters.shared.push_back({names[k], "ln", at, at, inference::infinity, low[k], high[k]});
  }
  for (int k = 0; k < 5; ++k) {
    parameters.shared.push_back({"translation", "", 0.0, 0.0, 1.0, -10.0, 10.0});
  }
  for (const ModuleSweep& sweep : sweeps) {
    const bool is_first = &sweep == &first;
    const double light = std::log(sweep.current_A.front() / scale_A);
    parameters.of_run.push_back({{"light", "ln", light, light, is_first ? 1e-9 : 1.0, -20.0, 20.0},
                                 {"temperature", "K", 0.0, 0.0,
                                  is_first ? 1e-6 : design.temperature_sigma_K, -150.0, 150.0}});
  }
  return parameters;
}

// `noise`: standard deviation of a point, relative to the current of the first curve. `near`: start
// of the fit, or nullptr.
ReferenceFit fit_references(const ModuleDesign& design, double noise, const ReferenceFit* near) {
  constexpr size_t most_points = 200;
  ReferenceFit result;
  for (const LightRecording& r : design.references) {
    result.sweeps.push_back(module_sweep(r, design, most_points, nullptr));
    const size_t i = result.sweeps.size() - 1;
    result.sweeps.back().temperature_K = i < design.reference_temperatures_K.size()
                                             ? design.reference_temperatures_K[i]
                                             : design.reference_temperature_K;
  }
  const double scale_A = result.sweeps.front().current_A.front();
  const inference::Parameters parameters = reference_parameters(design, result.sweeps);
  const auto residuals = [&](const VectorXd& x, Index run) -> VectorXd {
    const ModuleSweep& sweep = result.sweeps[static_cast<size_t>(run)];
    ModuleState state;
    state.light = std::exp(x[0]);
    state.temperature_K = sweep.temperature_K + x[1];
    const ModuleCell cell = cell_of(x.tail(ModuleNominal::numbers), design.reference_temperature_K);
    const auto curve = module_curve(design, cell, state).at_voltages(sweep.voltage_V);
    VectorXd r(static_cast<Index>(curve.size()));
    for (size_t i = 0; i < curve.size(); ++i) {
      r[static_cast<Index>(i)] = (sweep.current_A[i] - curve[i].current_A) / (noise * scale_A);
    }
    return r;
  };
  const inference::ResidualModel model(parameters, inference::with_differences(residuals));
  inference::Options options;
  options.max_iterations = 60;
  result.fit = inference::fit(model, near != nullptr ? near->fit.at : model.start(), options);
  if (!std::isfinite(result.fit.chi2)) {
    throw InputError({design.references.front().name}, "module.reference_curve",
                     "a curve that no diode fits", "a current-voltage curve of a lit module");
  }
  for (size_t run = 0; run < result.sweeps.size(); ++run) {
    VectorXd x(own + ModuleNominal::numbers);
    x << result.fit.at.segment(own * static_cast<Index>(run), own),
        result.fit.at.tail(ModuleNominal::numbers);
    result.residuals_A.push_back(noise * scale_A * residuals(x, static_cast<Index>(run)));
  }
  return result;
}

// Correlation length of the residuals in points, at least one.
double correlation_points(const VectorXd& r) {
  double sum = 1.0;
  const double all = r.squaredNorm();
  for (Index lag = 1; lag < r.size() / 3; ++lag) {
    const double rho = r.head(r.size() - lag).dot(r.tail(r.size() - lag)) / all;
    constexpr double none = 0.05;
    if (rho < none) break;
    sum += 2.0 * rho;
  }
  return sum;
}

// Root of a covariance, limited to a factor of e for parameters that the curves do not determine.
MatrixXd root_of(MatrixXd C) {
  MatrixXd root = MatrixXd::Zero(C.rows(), C.cols());
  for (Index k = 0; k < C.rows(); ++k) {
    const double most = 1.0;
    if (!(C(k, k) < most)) {
      const double shrink = std::sqrt(most / C(k, k));
      C.row(k) *= shrink;
      C.col(k) *= shrink;
    }
  }
  C.diagonal().array() += 1e-10;
  const Eigen::LLT<MatrixXd> llt(C);
  if (llt.info() == Eigen::Success) {
    root = llt.matrixL();
  } else {
    root.diagonal() = C.diagonal().cwiseMax(0.0).cwiseSqrt();
  }
  return root;
}

double voltage_noise_of(const ModuleDesign& design, double open_V) {
  constexpr double of_open_circuit = 1e-4;
  return design.voltage_noise_V > 0.0 ? design.voltage_noise_V : of_open_circuit * open_V;
}

ModuleNominal nominal_of_datasheet(const ModuleDesign& design) {
  ModuleNominal nominal;
  const double guess_V =
      1.2 * design.cells * boltzmann_J_K * design.reference_temperature_K / elementary_charge_C;
  const RatedTolerance steps = written_steps(design.datasheet);
  const RatedFit fit = fit_rated_points(design.datasheet, design.slopes, guess_V, steps);
  nominal.cell = cell_of(logs_of(fit.diode, design.cells, design.reference_temperature_K),
                         design.reference_temperature_K);
  const SingleDiode& d = fit.diode;
  const Estimate* of[] = {&d.photocurrent_A, &d.saturation_A, &d.scale_V, &d.series_ohm,
                          &d.shunt_ohm};
  // Modules of one kind differ from the datasheet and from each other by some per cent.
  constexpr double alike = 0.02, most = 1.0;
  for (Index k = 0; k < 5; ++k) {
    const Estimate& e = *of[k];
    nominal.root(k, k) = std::clamp(e.standard_error / e.value, alike, most);
  }
  for (Index k = 0; k < 5; ++k) nominal.root(5 + k, 5 + k) = translation_sigma[k];
  const double open_V = design.datasheet.front().open_circuit_V;
  constexpr double one_diode = 3e-3;
  nominal.misfit = one_diode;
  nominal.correlation_V = 0.1 * open_V;
  nominal.voltage_noise_V = voltage_noise_of(design, open_V);
  return nominal;
}

ModuleNominal nominal_of_references(const ModuleDesign& design) {
  ModuleNominal nominal;
  constexpr double first_noise = 1e-3;
  const ReferenceFit first = fit_references(design, first_noise, nullptr);
  // The second fit uses the scatter as its noise, counted once per correlation length.
  double length = 0.0;
  for (const VectorXd& r : first.residuals_A) {
    length += correlation_points(r) / static_cast<double>(first.residuals_A.size());
  }
  const double scatter = std::sqrt(std::max(first.fit.variance() * length, 1e-6));
  const ReferenceFit reference = fit_references(design, first_noise * scatter, &first);
  nominal.cell =
      cell_of(reference.fit.at.tail(ModuleNominal::numbers), design.reference_temperature_K);
  double squares = 0.0, points = 0.0, noise2 = 0.0, length_V = 0.0;
  for (size_t run = 0; run < reference.sweeps.size(); ++run) {
    const ModuleSweep& sweep = reference.sweeps[run];
    const VectorXd& r = reference.residuals_A[run];
    squares += r.squaredNorm() / std::pow(sweep.current_A.front(), 2);
    points += static_cast<double>(r.size());
    noise2 += std::pow(sweep.noise_A / sweep.current_A.front(), 2) * static_cast<double>(r.size());
    const double step_V =
        (sweep.voltage_V.back() - sweep.voltage_V.front()) / static_cast<double>(r.size() - 1);
    length_V += correlation_points(r) * step_V / static_cast<double>(reference.sweeps.size());
  }
  const double freedom =
      std::max(1.0, points - 5.0 - own * (static_cast<double>(reference.sweeps.size()) - 1.0));
  nominal.misfit = std::sqrt(std::max(0.0, squares / freedom - noise2 / points));
  nominal.correlation_V = length_V;
  const double open_V = reference.sweeps.front().voltage_V.back();
  nominal.voltage_noise_V = voltage_noise_of(design, open_V);
  nominal.root = root_of(reference.fit.shared_posterior());
  for (Index k = 0; k < 5; ++k) nominal.root.row(5 + k) *= translation_sigma[k];
  return nominal;
}

// Residual of one diode and its translation.
double misfit_A(const ModuleNominal& nominal, const ModuleSweep& sweep) {
  // Residual of the translation per unit of distance, relative to the short-circuit current, for
  // the two modules from which the sizes of its powers come.
  constexpr double translation_misfit = 1.5e-3;
  // Correction for one or two references: with few correlation lengths they determine their misfit
  // only to a third.
  constexpr double of_curves = 1.33;
  const double distance = distance_of(nominal, sweep.light, sweep.temperature_K);
  return std::hypot(of_curves * nominal.misfit, translation_misfit * distance) *
         nominal.cell.photocurrent_A * sweep.light;
}

}  // namespace

ModuleSweep ModuleSweep::selected(const std::function<bool(size_t point)>& keeps) const {
  ModuleSweep some = *this;
  some.voltage_V.clear();
  some.current_A.clear();
  for (size_t i = 0; i < voltage_V.size(); ++i) {
    if (!keeps(i)) continue;
    some.voltage_V.push_back(voltage_V[i]);
    some.current_A.push_back(current_A[i]);
  }
  return some;
}

ModuleSweep module_sweep(const LightRecording& recording, const ModuleDesign& design,
                         size_t max_rows, std::map<std::string, int64_t>* rejected) {
  const auto reject = [&](const char* reason) {
    if (rejected != nullptr) ++(*rejected)[reason];
  };
  const std::vector<size_t> order = sorted_indices(recording.rows(), [&](size_t a, size_t b) {
    return recording.voltage_V[a] < recording.voltage_V[b];
  });
  ModuleSweep all;
  all.name = recording.name;
  for (const size_t i : order) {
    all.voltage_V.push_back(recording.voltage_V[i]);
    all.current_A.push_back(recording.current_A[i]);
  }
  const double largest_A = all.current_A.empty() ? 0.0 : std::ranges::max(all.current_A);
  // Beyond open circuit a millivolt changes the current by more than all errors of a current.
  constexpr double reverse = 0.05;
  all = all.selected([&](size_t i) {
    const bool is_kept = all.voltage_V[i] <= 0.0 || all.current_A[i] > -reverse * largest_A;
    if (!is_kept) reject("beyond_open_circuit");
    return is_kept;
  });
  constexpr size_t fewest = 12;
  if (all.current_A.size() < fewest || !(largest_A > 0.0) || !(all.voltage_V.back() > 0.0)) {
    throw InputError({recording.name}, "rows",
                     std::to_string(all.current_A.size()) + " usable points in " +
                         std::to_string(recording.rows_read) + " rows",
                     "a curve of at least 12 points with positive currents and voltages");
  }
  all.noise_A =
      design.current_noise_A.value_or(std::max(noise_of(all.current_A), 1e-5 * largest_A));
  // Outliers: points outside the range of their two neighbours by more than a curve can bend.
  const double limit_A = std::max(20.0 * all.noise_A, 0.05 * largest_A);
  const ModuleSweep good = all.selected([&](size_t i) {
    if (i == 0 || i + 1 == all.current_A.size()) return true;
    const auto [low, high] = std::minmax(all.current_A[i - 1], all.current_A[i + 1]);
    const bool is_outlier = all.current_A[i] < low - limit_A || all.current_A[i] > high + limit_A;
    if (is_outlier) reject("outlier");
    return !is_outlier;
  });
  const size_t every = (good.current_A.size() + max_rows - 1) / max_rows;
  return good.selected([every](size_t i) { return i % every == 0; });
}

ModuleCell moved(const ModuleNominal& nominal, const ModuleNominal::Numbers& z) {
  const ModuleNominal::Numbers by = nominal.root * z;
  ModuleCell cell = nominal.cell;
  for (Index k = 0; k < 5; ++k) {
    cell.*cell_numbers[k] *= std::exp(by[k]);
    cell.translation.*translation_powers[k] += by[5 + k];
  }
  return cell;
}

double distance_of(const ModuleNominal& nominal, double light, double temperature_K) {
  constexpr double step_K = 25.0;
  return std::hypot(std::log(light), (temperature_K - nominal.cell.temperature_K) / step_K);
}

ModuleNominal nominal_module(const ModuleDesign& design) {
  return design.datasheet.empty() ? nominal_of_references(design) : nominal_of_datasheet(design);
}

double point_sigma_A(const ModuleNominal& nominal, const ModuleSweep& sweep) {
  const double step_V = (sweep.voltage_V.back() - sweep.voltage_V.front()) /
                        static_cast<double>(sweep.voltage_V.size() - 1);
  const double repeated = std::max(1.0, nominal.correlation_V / step_V);
  return std::hypot(sweep.noise_A, misfit_A(nominal, sweep) * std::sqrt(repeated));
}

double point_rms_A(const ModuleNominal& nominal, const ModuleSweep& sweep) {
  return std::hypot(sweep.noise_A, misfit_A(nominal, sweep));
}

}  // namespace photorque
