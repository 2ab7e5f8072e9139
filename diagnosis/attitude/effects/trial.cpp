#include "diagnosis/attitude/effects/trial.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "attitude/estimation/fit.h"
#include "attitude/propagation/run.h"

namespace photorque {
namespace {

// Resets the parameters of the nominal disturbances, which come first, to their stated values, and
// the runs to their first readings.
void reset_to_stated(size_t nominal_disturbances, const std::vector<Observation>& runs,
                     Hypothesis& h) {
  for (const Free& f : h.free) {
    if (!f.per_run && f.disturbance < nominal_disturbances) h.value(f) = f.mean;
  }
  h.runs = starts_from_data(h, runs);
}

// Options of a fit whose start is useless if its χ² is far above that of the trial behind it.
inference::Options with_start_limit(inference::Options options, const Trial& trial,
                                    const Thresholds& limits) {
  options.max_start_chi2 = std::max(limits.fitting.max_start_growth * trial.fit.chi2,
                                    limits.diverged_chi2_per_sample * trial.fit.samples);
  return options;
}

// Whether an uncertain inertia differs from its nominal value by more than its sigma.
bool inertia_is_shifted(const Hypothesis& h, size_t nominal_disturbances) {
  return std::any_of(h.free.begin(), h.free.end(), [&](const Free& f) {
    if (f.per_run || f.disturbance >= nominal_disturbances) return false;
    return changes_inertia(h.model.disturbances[f.disturbance]) &&
           std::abs(h.parameter(f).value - f.mean) > f.sigma;
  });
}

// Fits from `h` and, if its inertia is shifted, also from the stated values. The torque equation is
// homogeneous, so a model that lacks an effect shifts its inertia first; an added effect then only
// finds the local minimum near that inertia.
Fit fit_also_from_stated(const Hypothesis& h, size_t nominal_disturbances,
                         const std::vector<Observation>& runs, const inference::Options& options,
                         const Thresholds& limits) {
  Fit shifted = fit(h, runs, {options});
  if (!inertia_is_shifted(h, nominal_disturbances)) return shifted;
  Hypothesis stated = h;
  reset_to_stated(nominal_disturbances, runs, stated);
  inference::Options growing = options;
  growing.windows = limits.fitting.first_windows;
  growing.max_start_chi2 = inference::infinity;
  const Fit from_stated = fit(stated, runs, {growing});
  return from_stated.chi2 < shifted.chi2 ? from_stated : shifted;
}

// Adds the fitted parameters of a candidate, whose disturbance has index `index` in the model.
void free_parameters(Hypothesis& h, const Candidate& c, size_t index, const Thresholds& limits) {
  for (size_t p = 0; p < c.scale.size(); ++p) {
    if (!c.is_fitted(p)) continue;
    Free f{index, static_cast<int>(p)};
    f.mean = c.searched[p] ? h.parameter(f).value : 0.0;
    f.sigma = limits.evidence.fit_prior_widths * c.scale[p];
    // Strengths of effects of free bodies are bounded too: one may be zero about one of several
    // axes.
    if (c.searched[p] || c.effect.of_free_bodies) {
      f.lowest = c.lowest[p];
      f.highest = c.highest[p];
    }
    h.free.push_back(f);
  }
}

// Adds a candidate and its fitted parameters. Returns the index of its disturbance.
size_t add_free(Hypothesis& h, const Candidate& c, const Disturbance& start,
                const Thresholds& limits) {
  const size_t index = add_disturbance(h, start);
  free_parameters(h, c, index, limits);
  return index;
}

// The hypothesis without the candidates of a trial, whose disturbances follow the nominal ones.
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

inference::Members<Start> without_forecast(inference::Members<Start> members) {
  for (inference::Member<Start>& member : members) member.strengths.resize(0);
  return members;
}

// Whether the members include all candidates of the trial.
bool adds_to(const Trial& trial, const inference::Members<Start>& members) {
  return std::all_of(trial.candidates.begin(), trial.candidates.end(), [&](size_t c) {
    return std::any_of(members.begin(), members.end(),
                       [&](const auto& member) { return member.term.candidate == c; });
  });
}

// Windows of a growing fit, without those that contain too few readings.
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

// Index of the first extra state of a disturbance.
size_t first_state(const AttitudeModel& model, size_t disturbance) {
  size_t first = 0;
  for (size_t d = 0; d < disturbance; ++d) first += model.disturbances[d].states.size();
  return first;
}

// Index in `others` of each candidate, or `others.size()` if it is absent. Each index is used once.
std::vector<size_t> counterparts(const std::vector<size_t>& candidates,
                                 const std::vector<size_t>& others) {
  std::vector<bool> is_taken(others.size(), false);
  std::vector<size_t> result;
  for (const size_t candidate : candidates) {
    size_t j = 0;
    while (j < others.size() && (is_taken[j] || others[j] != candidate)) ++j;
    if (j < others.size()) is_taken[j] = true;
    result.push_back(j);
  }
  return result;
}

// Copies the initial states of the candidates that `from` also contains, for each run. A part that
// is deflected at the start swings without being driven.
void begin_as(const Trial& from, const Trial& trial, Hypothesis& h) {
  const std::vector<size_t> same = counterparts(trial.candidates, from.candidates);
  for (size_t i = 0; i < same.size(); ++i) {
    const size_t j = same[i];
    if (j == from.candidates.size()) continue;
    const size_t count = h.model.disturbances[trial.disturbances[i]].states.size();
    const size_t source = first_state(from.fit.best.model, from.disturbances[j]),
                 target = first_state(h.model, trial.disturbances[i]);
    for (size_t run = 0; run < h.runs.size(); ++run) {
      std::copy_n(from.fit.best.runs[run].initial.extra.begin() + source, count,
                  h.runs[run].initial.extra.begin() + target);
    }
  }
}

Trial assembled(const Trial& from, const Candidates& all, const inference::Members<Start>& members,
                const std::vector<Observation>& runs, const inference::Options& options) {
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
  begin_as(from, trial, h);
  trial.fit = fit_also_from_stated(h, h.model.disturbances.size() - trial.candidates.size(), runs,
                                   options, all.limits);
  return trial;
}

}  // namespace

std::vector<Effect> catalogue(const DisturbanceContext& context) {
  const Platform& platform = context.platform;
  const double inertia_kg_m2 = platform.inertia_kg_m2.trace() / 3.0;
  std::vector<Effect> all;
  for (const DisturbanceKind& kind : disturbance_kinds()) {
    const auto own = kind.screening.of_experiment;
    const std::vector<Parametrisation> ways =
        own != nullptr ? own(context) : kind.screening.parametrisations;
    for (const Parametrisation& p : ways) {
      if (p.of_free_bodies && platform.has_bearing()) continue;
      Effect effect{kind.name, {}, p.explanation, kind.screening, p.of_free_bodies};
      effect.keys = p.keys;
      for (EffectKey& key : effect.keys) {
        if (!key.times_inertia) continue;
        for (double& start : key.start) start *= inertia_kg_m2;
        key.scale *= inertia_kg_m2;
      }
      all.push_back(std::move(effect));
    }
  }
  return all;
}

Disturbance disturbance_of(const Effect& effect, const DisturbanceContext& context) {
  std::vector<std::pair<std::string, std::vector<double>>> values;
  for (const EffectKey& key : effect.keys) values.emplace_back(key.key, key.start);
  return make_disturbance_of(effect.kind, values, context);
}

Trial nominal_trial(const Fit& nominal, const Candidates& all) {
  Trial trial;
  trial.fit = nominal;
  trial.log_evidence = log_evidence(trial, all);
  return trial;
}

Trial Candidates::extend(const Trial& parent, size_t candidate, const Start& start,
                         const Runs& runs, const Effort& effort) const {
  Trial trial;
  trial.candidates = parent.candidates;
  trial.disturbances = parent.disturbances;
  Hypothesis h = parent.fit.best;
  Effort how = effort;
  // The scan of a mode that explains most of the residual starts near the solution.
  const bool is_near =
      list[candidate].effect.how.scan == Scan::mode && start.gain > 0.5 * parent.fit.chi2;
  if (is_near) {
    how.max_iterations = std::max(how.max_iterations, limits.fitting.leader_iterations);
  } else if (parent.fit.chi2_per_sample() > limits.diverged_chi2_per_sample) {
    // The parameters of a diverged fit are useless as a start.
    reset_to_stated(h.model.disturbances.size() - parent.candidates.size(), runs, h);
    how.windows = limits.fitting.diverged_windows;
  }
  trial.candidates.push_back(candidate);
  trial.disturbances.push_back(add_free(h, list[candidate], start.disturbance, limits));
  if (is_near) {
    // The initial deflection of each run is fitted first. Without it the readings do not determine
    // the frequency.
    Hypothesis as_scanned = h;
    std::erase_if(as_scanned.free, [](const Free& f) { return !f.per_run; });
    h.runs = fit(as_scanned, runs, {effort}).best.runs;
  }
  trial.fit = fit_also_from_stated(h, h.model.disturbances.size() - trial.candidates.size(), runs,
                                   how, limits);
  judge(trial, *this);
  return trial;
}

Candidates::Terms Candidates::terms_of(const Trial& trial) const {
  Terms terms;
  for (size_t i = 0; i < trial.candidates.size(); ++i) {
    terms.push_back(
        {trial.candidates[i], {trial.fit.best.model.disturbances[trial.disturbances[i]]}});
  }
  return terms;
}

Trial Candidates::assemble(const Trial& from, const inference::Members<Start>& members,
                           const Runs& runs, const Effort& effort) const {
  // If no candidate is removed, the first step of a fit from the trial equals the forecast and also
  // moves the initial conditions of each run. Otherwise the forecast is the nearest start.
  Trial trial = assembled(from, *this, adds_to(from, members) ? without_forecast(members) : members,
                          runs, with_start_limit(effort, from, limits));
  if (!std::isfinite(trial.fit.chi2)) {
    Effort growing = effort;
    growing.windows = growing_windows(limits, runs);
    trial = assembled(from, *this, without_forecast(members), runs, growing);
  }
  judge(trial, *this);
  return trial;
}

Trial exchange(const Trial& trial, const Candidates& all, size_t which, size_t candidate,
               const Disturbance& start, const std::vector<Observation>& runs,
               const inference::Options& options) {
  Trial result = trial;
  const size_t index = trial.disturbances[which];
  result.candidates[which] = candidate;
  Hypothesis h = trial.fit.best;
  h.model.disturbances[index] = start;
  std::erase_if(h.free, [&](const Free& f) { return f.disturbance == index; });
  free_parameters(h, all[candidate], index, all.limits);
  result.fit = fit(h, runs, {options});
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
    settings.max_iterations = all.limits.fitting.leader_iterations;
    result.fit = fit(start, runs, settings);
    return result.fit.chi2 < trial.fit.chi2 + all.limits.leaders.near_chi2;
  };
  // If the bound is far away, the other parameters may be off: growing windows are tried too.
  return leads_back({1.0}) || leads_back(all.limits.fitting.diverged_windows) ? result : trial;
}

Trial Candidates::refit(const Trial& trial, const Runs& runs, const std::vector<RunStart>& begins,
                        const Effort& effort) const {
  Trial result = trial;
  Hypothesis h = trial.fit.best;
  h.runs = begins;
  adapt_to_runs(h, runs);
  result.fit = fit(h, runs, {effort});
  judge(result, *this);
  return result;
}

Trial Candidates::refit_near(const Trial& trial, const Trial& other, const Runs& runs,
                             const Effort& effort) const {
  Trial from = trial;
  std::vector<Disturbance>& to = from.fit.best.model.disturbances;
  const std::vector<Disturbance>& source = other.fit.best.model.disturbances;
  const size_t nominal = to.size() - trial.candidates.size();
  for (size_t d = 0; d < nominal; ++d) to[d].parameters = source[d].parameters;
  const std::vector<size_t> same = counterparts(trial.candidates, other.candidates);
  for (size_t i = 0; i < same.size(); ++i) {
    if (same[i] == other.candidates.size()) continue;
    to[trial.disturbances[i]].parameters = source[other.disturbances[same[i]]].parameters;
  }
  std::vector<RunStart> begins = other.fit.best.runs;
  for (size_t run = 0; run < begins.size(); ++run) {
    std::vector<double>& extra = begins[run].initial.extra;
    const std::vector<double>& own = from.fit.best.runs[run].initial.extra;
    if (extra.size() != own.size()) extra = own;
  }
  // A fit from a start that is far worse than the trial would only return to it.
  return refit(from, runs, begins, with_start_limit(effort, trial, limits));
}

}  // namespace photorque
