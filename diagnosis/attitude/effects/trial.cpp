#include "diagnosis/attitude/effects/trial.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "attitude/estimation/nominal_model.h"
#include "attitude/propagation/run.h"
#include "inference/estimator/evidence.h"

namespace photorque {
namespace {

// Laplace's approximation of the evidence. The fit's own prior is far wider than the nominal model
// of an effect; here it is replaced.
double log_evidence(const Trial& trial, const Candidates& all) {
  const Fit& fit = trial.fit;
  const Thresholds::Evidence& limits = all.limits.evidence;
  if (!std::isfinite(fit.chi2)) return -1e300;
  inference::ArrowMatrix hessian = fit.hessian;
  double result = -0.5 * fit.chi2;
  // The parameters that are not searched, in units of what is expected of them.
  inference::Strengths strengths;
  for (size_t i = 0; i < trial.candidates.size(); ++i) {
    const Candidate& c = all[trial.candidates[i]];
    result += c.empirical() ? limits.log_prior_empirical : limits.log_prior_effect;
    const std::vector<Eigen::Index> where = shared_indices(trial, i);
    size_t k = 0;
    for (size_t p = 0; p < c.scale.size(); ++p) {
      if (!c.is_fitted(p)) continue;
      const Eigen::Index at = where[k++];
      if (!c.searched[p]) {
        strengths.at.push_back(at);
        strengths.owner.push_back(i);
        strengths.value.push_back(
            fit.best.model.disturbances[trial.disturbances[i]].parameters[p].value);
        strengths.scale.push_back(c.scale[p]);
        if (c.lowest[p] == 0.0) result += std::log(2.0);  // half of a Gaussian
        continue;
      }
      const double sigma = c.scale[p], wide = sigma * limits.fit_prior_widths;
      hessian.add_to_diagonal(fit.first_shared + at, 1.0 / (sigma * sigma) - 1.0 / (wide * wide));
      result -= std::log(sigma);
    }
    for (size_t s = 0; s < c.start.states.size(); ++s) {
      result -= static_cast<double>(fit.best.runs.size()) *
                std::log(limits.own_state_sigma);  // prior of its start
    }
  }
  result -= 0.5 * hessian.log_determinant();
  return result + inference::log_strength_evidence(strengths, fit.shared_posterior(),
                                                   trial.candidates.size(), limits);
}

bool changes_inertia(const Disturbance& d) {
  const DisturbanceKind* kind = find_kind(d.kind);
  return kind != nullptr && kind->screening.inertia_change_kg_m2 != nullptr;
}

// What is stated as uncertain by more may change by more: three of its standard deviations, over
// the moment.
double stated_inertia_change(const Trial& trial) {
  constexpr double sigmas = 3.0;
  const Mat3& nominal_kg_m2 = trial.fit.best.model.platform.inertia_kg_m2;
  double largest = 0.0;
  for (const Free& f : trial.fit.best.free) {
    const auto& found = trial.disturbances;
    const bool is_found = std::find(found.begin(), found.end(), f.disturbance) != found.end();
    const Disturbance& stated = trial.fit.best.model.disturbances[f.disturbance];
    if (is_found || !changes_inertia(stated) || f.parameter > 2) continue;
    largest = std::max(largest, sigmas * f.sigma / nominal_kg_m2(f.parameter, f.parameter));
  }
  return largest;
}

// The largest change of a principal moment by a fitted error of the inertia, as a fraction of the
// nominal one. The torque equation is homogeneous: hardly any inertia at all explains nearly
// everything, but nobody weighs a platform that badly.
double inertia_change(const Trial& trial) {
  const Mat3& nominal_kg_m2 = trial.fit.best.model.platform.inertia_kg_m2;
  const Vec3 nominal = nominal_kg_m2.selfadjointView<Eigen::Lower>().eigenvalues();
  double largest = 0.0;
  // What is believed of it moves within the same limits.
  for (const Disturbance& d : trial.fit.best.model.disturbances) {
    const DisturbanceKind* kind = find_kind(d.kind);
    if (kind == nullptr || kind->screening.inertia_change_kg_m2 == nullptr) continue;
    const Mat3 found = nominal_kg_m2 + kind->screening.inertia_change_kg_m2(d);
    const Vec3 moments = found.selfadjointView<Eigen::Lower>().eigenvalues();
    largest = std::max(largest, (moments - nominal).cwiseQuotient(nominal).cwiseAbs().maxCoeff());
  }
  return largest;
}

// A kind that the nominal model has as well may be corrected downwards, but not below what physics
// allows of the sum.
std::string sum_objection(const AttitudeModel& model) {
  for (const DisturbanceKind& kind : disturbance_kinds()) {
    const std::optional<LeastSum>& least = kind.screening.least_sum;
    if (!least) continue;
    double sum = 0.0;
    for (const Disturbance& d : model.disturbances) {
      if (d.kind != kind.name) continue;
      for (const Parameter& p : d.parameters) sum += p.value;
    }
    if (sum < least->lowest) return least->objection;
  }
  return "";
}

std::string objection_to(const Trial& trial, const Candidates& all) {
  const Thresholds::Objection& limits = all.limits.objection;
  if (!std::isfinite(trial.fit.chi2)) return "cannot be propagated";
  const Eigen::MatrixXd covariance = trial.fit.shared_posterior();
  for (size_t i = 0; i < trial.candidates.size(); ++i) {
    const Candidate& c = all[trial.candidates[i]];
    const std::vector<Eigen::Index> where = shared_indices(trial, i);
    size_t k = 0;
    for (size_t p = 0; p < c.scale.size(); ++p) {
      if (!c.is_fitted(p)) continue;
      const Eigen::Index at = where[k++];
      const double value =
          trial.fit.best.model.disturbances[trial.disturbances[i]].parameters[p].value;
      const double sigma = std::sqrt(std::max(0.0, covariance(at, at)));
      const double beyond = limits.bound_sigma * sigma;
      if (value < c.lowest[p] - beyond || value > c.highest[p] + beyond) {
        return c.label + " would have the wrong sign";
      }
    }
  }
  for (size_t i = 0; i < trial.candidates.size(); ++i) {
    const Candidate& c = all[trial.candidates[i]];
    if (c.effect.how.scan != Scan::frequency) continue;
    const Disturbance& tone = trial.fit.best.model.disturbances[trial.disturbances[i]];
    if (parameter_of(tone, "frequency_Hz").value * all.longest_run_s < limits.min_periods) {
      return "its period is as long as the recording: any slow torque looks like that";
    }
  }
  const double allowed = std::max(limits.max_inertia_change, stated_inertia_change(trial));
  if (const double change = inertia_change(trial); change > allowed) {
    return "a principal moment of inertia would change by " +
           std::to_string(static_cast<int>(std::lround(100.0 * change))) + " %";
  }
  return sum_objection(trial.fit.best.model);
}

double significance(const Trial& trial, const Candidates& all, size_t which) {
  const Candidate& c = all[trial.candidates[which]];
  const std::vector<Eigen::Index> where = shared_indices(trial, which);
  const Eigen::MatrixXd covariance = trial.fit.shared_posterior();
  std::vector<std::pair<Eigen::Index, double>> linear;
  size_t k = 0;
  for (size_t p = 0; p < c.scale.size(); ++p) {
    if (!c.is_fitted(p)) continue;
    const Eigen::Index at = where[k++];
    if (c.searched[p]) continue;
    linear.emplace_back(
        at, trial.fit.best.model.disturbances[trial.disturbances[which]].parameters[p].value);
  }
  const auto n = static_cast<Eigen::Index>(linear.size());
  if (n == 0) return 0.0;
  Eigen::MatrixXd C(n, n);
  Eigen::VectorXd theta(n);
  for (Eigen::Index a = 0; a < n; ++a) {
    theta[a] = linear[static_cast<size_t>(a)].second;
    for (Eigen::Index b = 0; b < n; ++b) {
      C(a, b) =
          covariance(linear[static_cast<size_t>(a)].first, linear[static_cast<size_t>(b)].first);
    }
  }
  const Eigen::VectorXd scale = C.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlation = scale.asDiagonal() * C * scale.asDiagonal();
  const Eigen::VectorXd scaled = scale.cwiseProduct(theta);
  return std::sqrt(std::max(0.0, scaled.dot(correlation.ldlt().solve(scaled))));
}

void judge(Trial& trial, const Candidates& all) {
  trial.significance.clear();
  for (size_t i = 0; i < trial.candidates.size(); ++i) {
    trial.significance.push_back(significance(trial, all, i));
  }
  trial.log_evidence = log_evidence(trial, all);
  if (!std::isfinite(trial.log_evidence)) trial.log_evidence = -1e300;
  trial.objection = objection_to(trial, all);
}

// Where a fit diverged, its parameters are no start: back to the nominal model and to what was
// seen at the beginning of each run.
void start_again(Hypothesis& h, const Trial& parent, const std::vector<Observation>& runs) {
  const auto& found = parent.disturbances;
  for (const Free& f : h.free) {
    if (f.per_run) continue;
    if (std::find(found.begin(), found.end(), f.disturbance) == found.end()) h.value(f) = f.mean;
  }
  h.runs = seen_starts(h, runs);
}

// Whether an inertia that is only believed has left its belief by more than its sigma.
bool inertia_is_bent(const Hypothesis& h, size_t nominal_disturbances) {
  return std::any_of(h.free.begin(), h.free.end(), [&](const Free& f) {
    if (f.per_run || f.disturbance >= nominal_disturbances) return false;
    return changes_inertia(h.model.disturbances[f.disturbance]) &&
           std::abs(h.parameter(f).value - f.mean) > f.sigma;
  });
}

// The fit from `h`. The torque equation is homogeneous, so that a model that lacks something bends
// its inertia first, and what is added to it then only finds the minimum beside that: there it is
// fitted from what was stated as well.
Fit fit_unbent(const Hypothesis& h, size_t nominal_disturbances,
               const std::vector<Observation>& runs, const FitSettings& settings,
               const Thresholds& limits) {
  Fit bent = fit(h, runs, settings);
  if (!inertia_is_bent(h, nominal_disturbances)) return bent;
  Hypothesis stated = h;
  for (const Free& f : h.free) {
    if (!f.per_run && f.disturbance < nominal_disturbances) stated.value(f) = f.mean;
  }
  stated.runs = seen_starts(stated, runs);
  FitSettings growing = settings;
  growing.windows = limits.fitting.first_windows;
  growing.max_start_chi2 = inference::infinity;
  const Fit straight = fit(stated, runs, growing);
  return straight.chi2 < bent.chi2 ? straight : bent;
}

// All that is fitted of a candidate that stands at `index` in the model.
void free_parameters(Hypothesis& h, const Candidate& c, size_t index, const Thresholds& limits) {
  for (size_t p = 0; p < c.scale.size(); ++p) {
    if (!c.is_fitted(p)) continue;
    Free f{index, static_cast<int>(p)};
    f.mean = c.searched[p] ? h.parameter(f).value : 0.0;
    f.sigma = limits.evidence.fit_prior_widths * c.scale[p];
    // One axis of several may have none of what the others have.
    if (c.searched[p] || c.effect.of_free_bodies) {
      f.lowest = c.lowest[p];
      f.highest = c.highest[p];
    }
    h.free.push_back(f);
  }
}

// Adds a candidate with all that is fitted of it. Returns its disturbance.
size_t add_free(Hypothesis& h, const Candidate& c, const Disturbance& start,
                const Thresholds& limits) {
  const size_t index = add_disturbance(h, start);
  free_parameters(h, c, index, limits);
  return index;
}

// Without the candidates of a trial: their disturbances stand behind the nominal ones.
Hypothesis nominal_part(const Trial& trial) {
  Hypothesis h = trial.fit.best;
  const auto is_candidates = [&](size_t d) {
    return std::find(trial.disturbances.begin(), trial.disturbances.end(), d) !=
           trial.disturbances.end();
  };
  std::erase_if(h.free, [&](const Free& f) { return is_candidates(f.disturbance); });
  auto& disturbances = h.model.disturbances;
  disturbances.resize(disturbances.size() - trial.candidates.size());
  size_t states = 0;
  for (const Disturbance& d : disturbances) states += d.states.size();
  for (RunStart& run : h.runs) run.initial.extra.resize(states);
  return h;
}

}  // namespace

std::vector<Eigen::Index> shared_indices(const Trial& trial, size_t which) {
  std::vector<Eigen::Index> result;
  Eigen::Index shared = 0;
  for (const Free& f : trial.fit.best.free) {
    if (f.per_run) continue;
    if (f.disturbance == trial.disturbances[which]) result.push_back(shared);
    ++shared;
  }
  return result;
}

Trial nominal_trial(const Fit& nominal, const Candidates& all) {
  Trial trial;
  trial.fit = nominal;
  trial.log_evidence = log_evidence(trial, all);
  return trial;
}

Trial extend(const Trial& parent, const Candidates& all, size_t candidate, const Disturbance& start,
             const std::vector<Observation>& runs, const FitSettings& settings) {
  Trial trial;
  trial.candidates = parent.candidates;
  trial.disturbances = parent.disturbances;
  Hypothesis h = parent.fit.best;
  FitSettings how = settings;
  if (parent.fit.chi2_per_sample() > all.limits.diverged_chi2_per_sample) {
    start_again(h, parent, runs);
    how.windows = all.limits.fitting.diverged_windows;
  }
  trial.candidates.push_back(candidate);
  trial.disturbances.push_back(add_free(h, all[candidate], start, all.limits));
  trial.fit =
      fit_unbent(h, h.model.disturbances.size() - trial.candidates.size(), runs, how, all.limits);
  judge(trial, all);
  return trial;
}

std::vector<inference::Term<Start>> terms_of(const Trial& trial) {
  std::vector<inference::Term<Start>> terms;
  for (size_t i = 0; i < trial.candidates.size(); ++i) {
    terms.push_back(
        {trial.candidates[i], {trial.fit.best.model.disturbances[trial.disturbances[i]]}});
  }
  return terms;
}

namespace {

inference::Members<Start> without_forecast(inference::Members<Start> members) {
  for (inference::Member<Start>& member : members) member.strengths.resize(0);
  return members;
}

// Everything that the trial has is among the members.
bool adds_to(const Trial& trial, const inference::Members<Start>& members) {
  return std::all_of(trial.candidates.begin(), trial.candidates.end(), [&](size_t c) {
    return std::any_of(members.begin(), members.end(),
                       [&](const auto& member) { return member.term.candidate == c; });
  });
}

// Windows in which there is something to fit.
std::vector<double> growing_windows(const Thresholds& limits,
                                    const std::vector<Observation>& runs) {
  size_t shortest = std::numeric_limits<size_t>::max();
  for (const Observation& seen : runs) shortest = std::min(shortest, seen.blocks());
  std::vector<double> windows = limits.fitting.diverged_windows;
  std::erase_if(windows, [&](double w) {
    const bool too_few = w * static_cast<double>(shortest) <
                         static_cast<double>(limits.search.min_readings_of_piece);
    return w < 1.0 && too_few;
  });
  return windows;
}

Trial assembled(const Trial& from, const Candidates& all, const inference::Members<Start>& members,
                const std::vector<Observation>& runs, const FitSettings& settings) {
  Hypothesis h = nominal_part(from);
  Trial trial;
  for (const inference::Member<Start>& member : members) {
    const Candidate& c = all[member.term.candidate];
    Disturbance start = member.term.start.disturbance;
    Eigen::Index k = 0;
    for (size_t p = 0; p < c.scale.size() && member.strengths.size() > 0; ++p) {
      if (!c.is_strength(p)) continue;
      start.parameters[p].value = std::clamp(member.strengths[k++], c.lowest[p], c.highest[p]);
    }
    trial.candidates.push_back(member.term.candidate);
    trial.disturbances.push_back(add_free(h, c, start, all.limits));
  }
  trial.fit = fit_unbent(h, h.model.disturbances.size() - trial.candidates.size(), runs, settings,
                         all.limits);
  return trial;
}

}  // namespace

Trial assemble(const Trial& from, const Candidates& all, const inference::Members<Start>& members,
               const std::vector<Observation>& runs, const FitSettings& settings) {
  FitSettings near = settings;
  near.max_start_chi2 = std::max(all.limits.fitting.max_start_growth * from.fit.chi2,
                                 all.limits.diverged_chi2_per_sample * from.fit.samples);
  // With nothing taken out, the first step of a fit from the trial itself is the forecast, and
  // moves what each run began with too; with something taken out, the forecast is the nearest
  // start.
  Trial trial = assembled(from, all, adds_to(from, members) ? without_forecast(members) : members,
                          runs, near);
  if (!std::isfinite(trial.fit.chi2)) {
    FitSettings growing = settings;
    growing.windows = growing_windows(all.limits, runs);
    trial = assembled(from, all, without_forecast(members), runs, growing);
  }
  judge(trial, all);
  return trial;
}

Trial exchange(const Trial& trial, const Candidates& all, size_t which, size_t candidate,
               const Disturbance& start, const std::vector<Observation>& runs,
               const FitSettings& settings) {
  Trial result = trial;
  const size_t index = trial.disturbances[which];
  result.candidates[which] = candidate;
  Hypothesis h = trial.fit.best;
  h.model.disturbances[index] = start;
  std::erase_if(h.free, [&](const Free& f) { return f.disturbance == index; });
  free_parameters(h, all[candidate], index, all.limits);
  result.fit = fit(h, runs, settings);
  judge(result, all);
  return result;
}

Trial within_physics(const Trial& trial, const Candidates& all,
                     const std::vector<Observation>& runs) {
  std::vector<Free> bounded = trial.fit.best.free;
  bool any_beyond = false;
  for (Free& f : bounded) {
    for (size_t i = 0; i < trial.candidates.size(); ++i) {
      if (f.per_run || f.disturbance != trial.disturbances[i]) continue;
      const Candidate& c = all[trial.candidates[i]];
      const auto p = static_cast<size_t>(f.parameter);
      f.lowest = c.lowest[p];
      f.highest = c.highest[p];
      const double found = trial.fit.best.parameter(f).value;
      any_beyond = any_beyond || found < f.lowest || found > f.highest;
    }
  }
  if (!any_beyond) return trial;
  const Hypothesis start = within_bounds(trial.fit, bounded, runs);
  Trial result = trial;
  const auto leads_back = [&](const std::vector<double>& windows) {
    FitSettings settings;
    settings.windows = windows;
    settings.max_iterations = all.limits.fitting.patient_iterations;
    result.fit = fit(start, runs, settings);
    return result.fit.chi2 < trial.fit.chi2 + all.limits.leaders.near_chi2;
  };
  // Where the way back was a long one, what was fitted beside it may be off.
  return leads_back({1.0}) || leads_back(all.limits.fitting.diverged_windows) ? result : trial;
}

Trial refit(const Trial& trial, const Candidates& all, const std::vector<Observation>& runs,
            const std::vector<RunStart>& starts, const FitSettings& settings) {
  Trial result = trial;
  Hypothesis h = trial.fit.best;
  h.runs = starts;
  suit_to_runs(h, runs);
  result.fit = fit(h, runs, settings);
  judge(result, all);
  return result;
}

Trial refit_near(const Trial& trial, const Trial& other, const Candidates& all,
                 const std::vector<Observation>& runs, const FitSettings& settings) {
  Trial from = trial;
  std::vector<Disturbance>& to = from.fit.best.model.disturbances;
  const std::vector<Disturbance>& source = other.fit.best.model.disturbances;
  const size_t nominal = to.size() - trial.candidates.size();
  for (size_t d = 0; d < nominal; ++d) to[d].parameters = source[d].parameters;
  for (size_t i = 0; i < trial.candidates.size(); ++i) {
    const auto twin =
        std::find(other.candidates.begin(), other.candidates.end(), trial.candidates[i]);
    if (twin == other.candidates.end()) continue;
    const auto j = static_cast<size_t>(twin - other.candidates.begin());
    to[trial.disturbances[i]].parameters = source[other.disturbances[j]].parameters;
  }
  std::vector<RunStart> starts = other.fit.best.runs;
  for (size_t run = 0; run < starts.size(); ++run) {
    std::vector<double>& extra = starts[run].initial.extra;
    const std::vector<double>& own = from.fit.best.runs[run].initial.extra;
    if (extra.size() != own.size()) extra = own;
  }
  // From a start that is far worse than where the trial is, it would only come back.
  FitSettings near = settings;
  near.max_start_chi2 = std::max(all.limits.fitting.max_start_growth * trial.fit.chi2,
                                 all.limits.diverged_chi2_per_sample * trial.fit.samples);
  return refit(from, all, runs, starts, near);
}

}  // namespace photorque
