#include "diagnosis/light/module/fit.h"

#include <algorithm>
#include <cmath>

#include "inference/estimator/evidence.h"
#include "inference/estimator/forward_model.h"

namespace photorque {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

constexpr Index of_curve = 2, of_module = ModuleNominal::numbers, of_cell = 5;

// Every third point of each curve that has many points.
std::vector<ModuleRun> thinned(std::vector<ModuleRun> runs) {
  constexpr size_t every = 3, fewest = 20;
  for (ModuleRun& run : runs) {
    if (run.sweep.voltage_V.size() < every * fewest) continue;
    run.sweep = run.sweep.selected([](size_t i) { return i % every == 0; });
  }
  return runs;
}

}  // namespace

double ModuleTrial::runs() const {
  return static_cast<double>((fit.at.size() - shared.size()) / of_curve);
}

double ModuleTrial::prior_chi2() const {
  double chi2 = shared.head<of_module>().squaredNorm();
  for (Index run = 0; run < static_cast<Index>(runs()); ++run) {
    chi2 += std::pow(fit.at[of_curve * run + 1], 2);
  }
  return chi2;
}

double ModuleTrial::prior_excess_sigma() const {
  const double numbers = static_cast<double>(of_module) + runs();
  return (prior_chi2() - numbers) / std::sqrt(2.0 * numbers);
}

std::vector<ArrayCurve::SlopedPoint> ModuleFitter::curve(const ModuleHypothesis& h,
                                                         const VectorXd& x,
                                                         const ModuleRun& at) const {
  const ModuleActing stated = acting_on(design_, at.sweep.name);
  ModuleState state = stated.state;
  ModuleCell cell = moved(nominal_, x.segment<of_module>(of_curve));
  state.light = std::exp(x[0]);
  state.temperature_K =
      at.sweep.temperature_K + stated.warmer_K + design_.temperature_sigma_K * x[1];
  const Index first = of_curve + of_module;
  h.act({x.data() + first, static_cast<size_t>(x.size() - first)}, state, cell);
  return module_points(design_, cell, state, at.sweep.voltage_V);
}

VectorXd ModuleFitter::residuals(const ModuleHypothesis& h, const VectorXd& x,
                                 const ModuleRun& run) const {
  const auto points = curve(h, x, run);
  VectorXd r(static_cast<Index>(points.size()));
  for (size_t i = 0; i < points.size(); ++i) {
    const double sigma_A = std::hypot(run.sigma_A, points[i].slope_S * nominal_.voltage_noise_V);
    r[static_cast<Index>(i)] = (run.sweep.current_A[i] - points[i].current_A) / sigma_A;
  }
  return r;
}

double ModuleFitter::first_light(const ModuleHypothesis& h, const ModuleRun& run,
                                 const inference::Parameters& parameters) const {
  const double seen = std::log(run.sweep.light);
  if (!h.limits_current) return seen;
  VectorXd x(of_curve + static_cast<Index>(parameters.shared.size()));
  for (size_t k = 0; k < parameters.shared.size(); ++k) {
    x[of_curve + static_cast<Index>(k)] = parameters.shared[k].value;
  }
  x[1] = 0.0;
  const auto chi2 = [&](double light) {
    x[0] = light;
    return residuals(h, x, run).squaredNorm();
  };
  constexpr double darkest = 0.02;
  const double behind = seen - std::log(std::max(darkest, x[of_curve + of_module]));
  return chi2(behind) < chi2(seen) ? behind : seen;
}

ModuleTrial ModuleFitter::fit_from(const ModuleHypothesis& h, const std::vector<ModuleRun>& runs,
                                   const std::vector<double>& own, const VectorXd* from,
                                   const VectorXd* at, bool translates) const {
  inference::Parameters parameters;
  for (Index k = 0; k < of_module; ++k) {
    parameters.shared.push_back({"module", "", from ? (*from)[k] : 0.0, 0.0, 1.0, -10.0, 10.0});
  }
  for (size_t k = 0; k < h.parameters.size(); ++k) {
    inference::Parameter p = h.parameters[k];
    p.value =
        std::clamp(from ? (*from)[of_module + static_cast<Index>(k)] : own[k], p.lowest, p.highest);
    parameters.shared.push_back(std::move(p));
  }
  for (const ModuleRun& run : runs) {
    const double light = std::log(run.sweep.light), first = first_light(h, run, parameters);
    parameters.of_run.push_back({{"light", "ln", first, light, 1.0, light - 5.0, light + 5.0},
                                 {"temperature", "", 0.0, 0.0, 1.0, -20.0, 20.0}});
  }
  const inference::ResidualModel model(parameters, [&](const VectorXd& x, Index run, VectorXd& r,
                                                       MatrixXd* slopes) {
    const ModuleRun& of = runs[static_cast<size_t>(run)];
    r = residuals(h, x, of);
    if (slopes == nullptr) return;
    slopes->resize(r.size(), x.size());
    for (Index k = 0; k < x.size(); ++k) {
      const Index shared = k - of_curve;
      if (!translates && shared >= of_cell && shared < of_module) {
        slopes->col(k).setZero();
        continue;
      }
      // At an upper bound the finite difference has a negative step.
      const double highest =
          shared < 0 ? inference::infinity : parameters.shared[static_cast<size_t>(shared)].highest;
      const double step = x[k] + 1e-5 < highest ? 1e-5 : -1e-5;
      VectorXd by = x;
      by[k] += step;
      slopes->col(k) = (r - residuals(h, by, of)) / step;
    }
  });
  inference::Options options;
  options.max_iterations = 30;
  ModuleTrial trial;
  trial.fit = inference::fit(model, at != nullptr ? *at : model.start(), options);
  trial.shared = trial.fit.at.tail(of_module + static_cast<Index>(h.parameters.size()));
  return trial;
}

ModuleTrial ModuleFitter::fit(const ModuleHypothesis& h, const std::vector<ModuleRun>& runs,
                              const VectorXd* from) const {
  std::vector<double> plain;
  for (const inference::Parameter& p : h.parameters) plain.push_back(p.value);
  std::vector<std::vector<double>> starts = h.starts;
  if (starts.empty()) starts = {plain};
  ModuleTrial best;
  if (from != nullptr) {
    best = fit_from(h, runs, plain, from, nullptr, true);
  } else {
    // The starts are compared on a subset of the points. Near the condition of the reference the
    // powers of the translation hardly act and mislead a fit far from its minimum: they are free
    // in the last fit.
    constexpr double near = 0.02;
    const bool translates = std::ranges::any_of(runs, [&](const ModuleRun& run) {
      return distance_of(nominal_, run.sweep.light, run.sweep.temperature_K) > near;
    });
    const std::vector<ModuleRun> some = starts.size() > 1 ? thinned(runs) : runs;
    for (const std::vector<double>& start : starts) {
      ModuleTrial trial = fit_from(h, some, start, nullptr, nullptr, translates);
      if (!(trial.fit.chi2 < best.fit.chi2) && best.fit.at.size() > 0) continue;
      best = std::move(trial);
    }
    if (starts.size() > 1 || !translates) {
      const VectorXd at = best.fit.at, shared = best.shared;
      best = fit_from(h, runs, plain, &shared, &at, true);
    }
  }
  double evidence = inference::log_evidence(best.fit);
  if (!std::isfinite(evidence)) evidence = -1e300;
  if (h.is_empirical || !h.kind.empty()) {
    evidence += h.is_empirical
                    ? limits_.evidence.log_prior_empirical
                    : h.effects * limits_.evidence.log_prior_effect - std::log(h.alternatives);
    // A parameter that cannot be negative has a half-Gaussian prior.
    for (const inference::Parameter& p : h.parameters) {
      if (p.mean == 0.0 && p.lowest == 0.0) evidence += std::log(2.0);
    }
  }
  best.log_evidence = evidence;
  if (!std::isfinite(best.fit.chi2)) best.objection = "cannot be evaluated";
  return best;
}

VectorXd ModuleFitter::numbers_of(const ModuleTrial& trial, size_t run) {
  VectorXd x(of_curve + trial.shared.size());
  x << trial.fit.at.segment(of_curve * static_cast<Index>(run), of_curve), trial.shared;
  return x;
}

}  // namespace photorque
