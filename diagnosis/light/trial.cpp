#include "diagnosis/light/trial.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numerics/linear.h"
#include "inference/estimator/evidence.h"
#include "inference/estimator/forward_model.h"

namespace photorque {
namespace {

using Numbers = std::vector<std::vector<double>>;

LightState acted(const LightCandidates& all, const std::vector<size_t>& candidates,
                 const Numbers& x) {
  LightState state = all.nominal.state;
  for (size_t i = 0; i < candidates.size(); ++i) {
    const LightCandidate& c = all[candidates[i]];
    c.kind.act(state, c.index, x[i]);
  }
  return state;
}

// The candidate and the number that belong to a column.
struct Place {
  size_t member, number;
};

std::vector<Place> places_of(const LightCandidates& all, const std::vector<size_t>& candidates) {
  std::vector<Place> places;
  for (size_t i = 0; i < candidates.size(); ++i) {
    const auto& numbers = all[candidates[i]].numbers;
    for (size_t k = 0; k < numbers.size(); ++k) {
      if (numbers[k].is_fitted) places.push_back({i, k});
    }
  }
  return places;
}

// A recording at a state, prepared for derivatives.
struct AtState {
  LightState state;
  LightFields fields;
  std::vector<double> light, signals;
  Eigen::VectorXd residuals;
  SignalSlopes slopes;
};

AtState evaluated(const FittedRun& run, const LightState& state, bool slopes) {
  AtState at{state, run.run->fields(state, run.nominal.get()), {}, {}, {}, {}};
  at.light = run.run->light(state, at.fields);
  at.signals = run.run->signals_of(state, at.light);
  at.residuals = run.run->residuals(state, at.signals, slopes ? &at.slopes : nullptr);
  return at;
}

// The residuals at a state, changed by the shifts of the uncertain nominal values.
Eigen::VectorXd shifted(Eigen::VectorXd residuals, const LightTrial& trial, const FittedRun& run) {
  if (trial.priors.empty()) return residuals;
  return residuals - *run.prior_slopes *
                         Eigen::Map<const Eigen::VectorXd>(
                             trial.priors.data(), static_cast<Eigen::Index>(trial.priors.size()));
}

// Whether a law multiplies the light. The signals are then linear in its strengths, and derivatives
// require no fields.
bool is_factor(const LightCandidate& c) {
  return c.is_empirical && !c.kind.in_circuit;
}

Eigen::VectorXd factor_slope(const LightCandidate& c, std::vector<double> x, size_t number,
                             const FittedRun& run, const AtState& at) {
  LightState now(0, 0, 0, 0), alone(0, 0, 0, 0);
  c.kind.act(now, 0, x);
  for (size_t k = 0; k < x.size(); ++k) {
    if (c.numbers[k].is_strength) x[k] = k == number ? 1.0 : 0.0;
  }
  c.kind.act(alone, 0, x);
  std::vector<double> change(at.signals.size());
  const auto& circumstances = run.run->circumstances();
  for (size_t i = 0; i < change.size(); ++i) {
    if (at.signals[i] == 0.0) continue;
    change[i] = at.signals[i] * (alone.light_laws.front()(circumstances[i]) - 1.0) /
                now.light_laws.front()(circumstances[i]);
  }
  return -run.run->moved(at.slopes, change);
}

// ∂(predicted/noise) for one number of one member by noise-free central differences; one-sided at a
// bound.
Eigen::VectorXd slope_by(const LightCandidates& all, const std::vector<size_t>& candidates,
                         const Numbers& x, const Place& place, const FittedRun& run,
                         const AtState& at) {
  const LightCandidate& c = all[candidates[place.member]];
  const LightCandidate::Number& n = c.numbers[place.number];
  if (is_factor(c) && n.is_strength) {
    return factor_slope(c, x[place.member], place.number, run, at);
  }
  Numbers low = x, high = x;
  double& a = low[place.member][place.number];
  double& b = high[place.member][place.number];
  a = std::max(a - n.step, std::min(n.lowest, a));
  b = std::min(b + n.step, std::max(n.highest, b));
  // Slopes only determine the step of a fit; χ² decides whether the step is accepted. The light
  // from walls is therefore not recomputed.
  const LightRun::KnownLight near{&at.state, &at.fields, &at.light};
  const auto signals = [&](const LightState& state) {
    return run.run->signals_of(
        state,
        run.run->light(state, run.run->fields(state, &at.fields, LightRun::Walls::kept), &near));
  };
  const LightState low_state = acted(all, candidates, low),
                   high_state = acted(all, candidates, high);
  const std::vector<double> low_signals = signals(low_state), high_signals = signals(high_state);
  if (c.kind.in_circuit) {
    const Eigen::VectorXd r_low = run.run->residuals(low_state, low_signals, nullptr),
                          r_high = run.run->residuals(high_state, high_signals, nullptr);
    return (r_low - r_high) / (b - a);
  }
  std::vector<double> change(low_signals.size());
  for (size_t i = 0; i < change.size(); ++i) {
    change[i] = (high_signals[i] - low_signals[i]) / (b - a);
  }
  return -run.run->moved(at.slopes, change);
}

std::vector<inference::Parameter> parameters_of(const LightCandidates& all,
                                                const std::vector<size_t>& candidates,
                                                const Numbers& x,
                                                const std::vector<double>& priors) {
  std::vector<inference::Parameter> parameters;
  for (size_t i = 0; i < priors.size(); ++i) {
    parameters.push_back({all.nominal.uncertain[i].key, "", priors[i], 0.0, 1.0});
  }
  for (const Place& place : places_of(all, candidates)) {
    const LightCandidate& c = all[candidates[place.member]];
    const LightCandidate::Number& n = c.numbers[place.number];
    const double value = x[place.member][place.number];
    inference::Parameter p;
    p.name = c.name + "." + c.kind.parameters[n.parameter].key;
    p.value = std::clamp(value, n.lowest, n.highest);
    p.mean = n.is_strength ? 0.0 : value;
    p.sigma = all.limits.evidence.fit_prior_widths * n.scale;
    p.lowest = n.lowest;
    p.highest = n.highest;
    parameters.push_back(p);
  }
  return parameters;
}

// A failed LED is a single value with a finite prior probability, so there is no penalty for a
// prior width.
bool is_point(const LightCandidate& c, const LightTrial& trial, size_t member,
              Eigen::Index column) {
  return c.kind.name == "led_derated" && leaves_no_light(trial.x[member][0], trial.fit, column);
}

// Laplace's approximation. The prior of the fit, which only keeps numbers from diverging, is
// replaced by that of each number.
double log_evidence_of(const LightTrial& trial, const LightCandidates& all) {
  const Thresholds::Evidence& limits = all.limits.evidence;
  if (!std::isfinite(trial.fit.chi2)) return -1e300;
  inference::ArrowMatrix hessian = trial.fit.hessian;
  double result = -0.5 * trial.fit.chi2;
  inference::Strengths strengths;
  auto at = static_cast<Eigen::Index>(trial.priors.size());
  for (size_t i = 0; i < trial.candidates.size(); ++i) {
    const LightCandidate& c = all[trial.candidates[i]];
    result += c.is_empirical ? limits.log_prior_empirical : limits.log_prior_effect;
    for (size_t k = 0; k < c.numbers.size(); ++k) {
      const LightCandidate::Number& n = c.numbers[k];
      // A number that a scan selects among all rows costs as much as a fitted one.
      if (!n.is_fitted) {
        result -= 0.5 * std::log(static_cast<double>(trial.fit.samples));
        continue;
      }
      if (n.is_strength && is_point(c, trial, i, at)) {
        hessian.hold(at);
      } else if (n.is_strength) {
        strengths.at.push_back(at);
        strengths.owner.push_back(i);
        strengths.value.push_back(trial.x[i][k]);
        strengths.scale.push_back(n.scale);
        if (n.lowest == 0.0 || n.highest == 0.0) result += std::log(2.0);  // half-Gaussian prior
      } else {
        const double wide = n.scale * limits.fit_prior_widths;
        hessian.add_to_diagonal(at, 1.0 / (n.scale * n.scale) - 1.0 / (wide * wide));
        result -= std::log(n.scale);
      }
      ++at;
    }
  }
  result -= 0.5 * hessian.log_determinant();
  result += inference::log_strength_evidence(strengths, trial.fit.shared_posterior(),
                                             trial.candidates.size(), limits);
  return std::isfinite(result) ? result : -1e300;
}

double significance_of(const LightTrial& trial, const LightCandidates& all, size_t which) {
  const LightCandidate& c = all[trial.candidates[which]];
  const std::vector<Eigen::Index> columns = columns_of(trial, all, which);
  std::vector<Eigen::Index> at;
  std::vector<double> value;
  size_t column = 0;
  for (size_t k = 0; k < c.numbers.size(); ++k) {
    if (!c.numbers[k].is_fitted) continue;
    if (c.numbers[k].is_strength) {
      at.push_back(columns[column]);
      value.push_back(trial.x[which][k]);
    }
    ++column;
  }
  if (at.empty()) return std::numeric_limits<double>::quiet_NaN();
  const Eigen::MatrixXd C = Eigen::MatrixXd(trial.fit.shared_posterior())(at, at);
  const Eigen::Map<const Eigen::VectorXd> theta(value.data(),
                                                static_cast<Eigen::Index>(value.size()));
  return std::sqrt(std::max(0.0, squared_distance(theta, C)));
}

void judge(LightTrial& trial, const LightCandidates& all) {
  trial.significance.clear();
  trial.log_evidence = log_evidence_of(trial, all);
  trial.objection = std::isfinite(trial.fit.chi2) ? "" : "cannot be evaluated";
  for (size_t i = 0; i < trial.candidates.size(); ++i) {
    trial.significance.push_back(std::isfinite(trial.fit.chi2) ? significance_of(trial, all, i)
                                                               : 0.0);
  }
}

}  // namespace

bool leaves_no_light(double derating, const inference::Fit& fit, Eigen::Index column) {
  const double sigma = std::sqrt(std::max(0.0, fit.shared_posterior()(column, column)));
  constexpr double known_to = 0.1, within = 3.0;
  return sigma < known_to && 1.0 + derating < std::max(within * sigma, 1e-3);
}

LightState state_of(const LightTrial& trial, const LightCandidates& all) {
  return acted(all, trial.candidates, trial.x);
}

std::vector<Eigen::Index> columns_of(const LightTrial& trial, const LightCandidates& all,
                                     size_t which) {
  std::vector<Eigen::Index> columns;
  auto at = static_cast<Eigen::Index>(trial.priors.size());
  for (const Place& place : places_of(all, trial.candidates)) {
    if (place.member == which) columns.push_back(at);
    ++at;
  }
  return columns;
}

LightTrial with_candidate(LightTrial trial, size_t candidate, const std::vector<double>& x) {
  trial.candidates.push_back(candidate);
  trial.x.push_back(x);
  return trial;
}

LightTrial without_candidate(LightTrial trial, size_t which) {
  trial.candidates.erase(trial.candidates.begin() + static_cast<std::ptrdiff_t>(which));
  trial.x.erase(trial.x.begin() + static_cast<std::ptrdiff_t>(which));
  return trial;
}

double linear_gain(Eigen::MatrixXd H, const Eigen::VectorXd& g) {
  H.diagonal() *= 1.0 + 1e-9;
  return g.dot(solve_symmetric(H, g).col(0));
}

Eigen::Index fitted_numbers(const LightTrial& trial, const LightCandidates& all) {
  return static_cast<Eigen::Index>(trial.priors.size() + places_of(all, trial.candidates).size());
}

LightTrial LightCandidates::fit(const Trial& start, const Runs& runs, int max_iterations) const {
  const std::vector<Place> places = places_of(*this, start.candidates);
  const auto n_priors = static_cast<Eigen::Index>(start.priors.size());
  const auto trial_at = [&](const Eigen::VectorXd& values) {
    Trial at;
    at.candidates = start.candidates;
    at.priors.assign(values.begin(), values.begin() + n_priors);
    at.x = start.x;
    for (size_t k = 0; k < places.size(); ++k) {
      at.x[places[k].member][places[k].number] = values[n_priors + static_cast<Eigen::Index>(k)];
    }
    return at;
  };
  const auto residuals = [&](const Eigen::VectorXd& values, Eigen::Index which, Eigen::VectorXd& r,
                             Eigen::MatrixXd* slopes) {
    const FittedRun& run = runs[static_cast<size_t>(which)];
    if (slopes == nullptr) {
      r = residuals_of(trial_at(values), *this, run);
      return;
    }
    LightSlopes found = slopes_of(trial_at(values), *this, {}, run);
    r = std::move(found.residuals);
    *slopes = std::move(found.slopes);
  };
  inference::Parameters parameters;
  parameters.of_run.resize(runs.size());
  parameters.shared = parameters_of(*this, start.candidates, start.x, start.priors);
  const inference::ResidualModel model(parameters, residuals);
  inference::Fit found = inference::fit(model, model.start(), {.max_iterations = max_iterations});
  Trial trial = trial_at(found.at);
  trial.fit = std::move(found);
  judge(trial, *this);
  return trial;
}

LightTrial nominal_light_trial(const LightCandidates& all, const std::vector<FittedRun>& runs) {
  LightTrial start;
  start.priors.assign(all.nominal.uncertain.size(), 0.0);
  return all.fit(start, runs, 25);
}

Eigen::VectorXd residuals_of(const LightTrial& trial, const LightCandidates& all,
                             const FittedRun& run) {
  return shifted(evaluated(run, state_of(trial, all), false).residuals, trial, run);
}

LightTrial LightCandidates::predict(const Trial& trial, const Runs& runs) const {
  LightTrial result = trial;
  result.fit.run_chi2.clear();
  result.fit.chi2 = 0.0;
  result.fit.samples = 0;
  for (const FittedRun& run : runs) {
    const Eigen::VectorXd r = residuals_of(trial, *this, run);
    result.fit.run_chi2.push_back(r.squaredNorm());
    result.fit.chi2 += r.squaredNorm();
    result.fit.samples += r.size();
  }
  result.fit.data_chi2 = result.fit.chi2;
  return result;
}

LightSlopes slopes_of(const LightTrial& trial, const LightCandidates& all,
                      const LightCandidates::Terms& more, const FittedRun& run) {
  const AtState at = evaluated(run, state_of(trial, all), true);
  LightSlopes result{shifted(at.residuals, trial, run), {}};
  const auto n_priors = static_cast<Eigen::Index>(trial.priors.size());
  std::vector<Eigen::VectorXd> columns;
  for (const Place& place : places_of(all, trial.candidates)) {
    columns.push_back(slope_by(all, trial.candidates, trial.x, place, run, at));
  }
  for (const inference::Term<LightStart>& term : more) {
    const LightCandidate& c = all[term.candidate];
    std::vector<double> start = term.start.x;
    for (size_t k = 0; k < start.size(); ++k) {
      if (c.numbers[k].is_strength) start[k] = 0.0;
    }
    const LightTrial with = with_candidate(trial, term.candidate, start);
    for (size_t k = 0; k < c.numbers.size(); ++k) {
      if (!c.numbers[k].is_strength) continue;
      columns.push_back(
          slope_by(all, with.candidates, with.x, {trial.candidates.size(), k}, run, at));
    }
  }
  result.slopes.resize(result.residuals.size(),
                       n_priors + static_cast<Eigen::Index>(columns.size()));
  if (n_priors > 0) result.slopes.leftCols(n_priors) = *run.prior_slopes;
  for (size_t k = 0; k < columns.size(); ++k) {
    result.slopes.col(n_priors + static_cast<Eigen::Index>(k)) = columns[k];
  }
  return result;
}

}  // namespace photorque
