// Every candidate added to a trial: scored, the promising ones fitted.
#pragma once

#include <algorithm>
#include <limits>

#include "core/parallel.h"
#include "inference/leaders.h"

namespace photorque::inference {

// The runs, or what each was cut into.
template <Domain D>
struct RunSet {
  std::vector<typename D::Run> runs;
  size_t pieces = 1;  // of each recording
};

// In fewer samples: enough for changes of the fit that are slow, and several times faster.
template <Domain D>
std::vector<typename D::Run> slow_runs(const D& domain, const typename D::Trial& about,
                                       const RunSet<D>& set) {
  return domain.average(about, set.runs, domain.limits().fitting.slow_blocks / set.pieces);
}

// Candidates that are worth a fit.
struct Promising {
  std::vector<size_t> candidates;
  double min_gain;  // that a scan's start must predict, to be worth a fit beside these
};

// Where the prediction is near the readings, the score test predicts what each candidate would
// gain: those that would gain hardly anything against the best need no fit of their own.
template <Domain D>
Promising promising(const D& domain, const typename D::Trial& parent,
                    const std::vector<size_t>& candidates,
                    const std::vector<typename D::Run>& averages) {
  const Thresholds::Scoring& limits = domain.limits().scoring;
  if (has_diverged(parent, domain.limits())) return {candidates, 0.0};
  const std::vector<double> gains = domain.gains(parent, candidates, averages);
  double best = 0.0;
  for (const double gain : gains) best = std::max(best, gain);
  Promising result{{}, limits.min_fraction * best};
  for (size_t i = 0; i < candidates.size(); ++i) {
    const CandidateTraits& c = domain.candidates()[candidates[i]];
    const double by_chance = static_cast<double>(c.parameters);
    const bool worth_it = gains[i] > std::max(limits.min_gain + by_chance, result.min_gain);
    if (!c.is_linear || worth_it) result.candidates.push_back(candidates[i]);
  }
  return result;
}

// Averages and pieces flatter some: what was not fitted to the full readings stands below the first
// `fitted` of these trials, which were, as it stood before.
template <class Trial>
void keep_below(std::vector<Trial>& trials, size_t fitted) {
  double lowest = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < fitted; ++i) lowest = std::min(lowest, trials[i].log_evidence);
  for (size_t i = fitted; i < trials.size(); ++i) {
    trials[i].log_evidence = std::min(trials[i].log_evidence, lowest);
  }
}

template <class Trial>
void sort_by_evidence(std::vector<Trial>& trials) {
  std::stable_sort(trials.begin(), trials.end(),
                   [](const Trial& a, const Trial& b) { return a.log_evidence > b.log_evidence; });
}

// One fit that is to be done.
template <Domain D>
struct Task {
  size_t candidate;
  typename D::Start start;
};

// The fits of all tasks on `runs`; of several starts of a candidate the best.
template <Domain D>
std::vector<typename D::Trial> extend_by_tasks(const D& domain, const typename D::Trial& parent,
                                               const std::vector<Task<D>>& tasks,
                                               const std::vector<typename D::Run>& runs,
                                               int threads) {
  using Trial = typename D::Trial;
  const Effort effort{.max_iterations = domain.limits().fitting.trial_iterations};
  std::vector<Trial> trials(tasks.size());
  parallel_for(tasks.size(), threads, [&](size_t i) {
    trials[i] = domain.extend(parent, tasks[i].candidate, tasks[i].start, runs, effort);
  });
  std::vector<Trial> best;
  for (Trial& trial : trials) {
    if (!best.empty() && best.back().candidates == trial.candidates) {
      if (trial.log_evidence > best.back().log_evidence) best.back() = std::move(trial);
    } else {
      best.push_back(std::move(trial));
    }
  }
  return best;
}

// The fits of slow candidates: to averages first, and those that come near the best to all
// readings.
template <Domain D>
std::vector<typename D::Trial> extend_by_averages(const D& domain, const typename D::Trial& parent,
                                                  const std::vector<Task<D>>& tasks,
                                                  const std::vector<typename D::Run>& runs,
                                                  const std::vector<typename D::Run>& averages,
                                                  int threads) {
  using Trial = typename D::Trial;
  std::vector<Trial> rough = extend_by_tasks(domain, parent, tasks, averages, threads);
  // Their evidence counts as what they gain over the parent on the same averages.
  const double rough_parent =
      domain.refit(parent, averages, domain.begins_of(parent), {}).log_evidence;
  for (Trial& t : rough) t.log_evidence += parent.log_evidence - rough_parent;
  sort_by_evidence(rough);
  const size_t refits = std::min(domain.limits().search.max_refits_of_averages, rough.size());
  parallel_for(refits, threads, [&](size_t i) {
    rough[i] = domain.refit(rough[i], runs, domain.begins_of(rough[i]), {});
  });
  keep_below(rough, refits);
  return rough;
}

// Every candidate added to a parent whose derivatives can be trusted.
template <Domain D>
std::vector<typename D::Trial> extend_near(const D& domain, const typename D::Trial& parent,
                                           const std::vector<size_t>& candidates,
                                           const RunSet<D>& set, int threads) {
  const std::vector<typename D::Run> averages = slow_runs(domain, parent, set);
  const Promising hopeful = promising(domain, parent, candidates, averages);
  const auto starts = domain.starts(parent, hopeful.candidates, set.runs, averages, threads);
  std::vector<Task<D>> slow, fast;
  for (size_t i = 0; i < hopeful.candidates.size(); ++i) {
    const size_t c = hopeful.candidates[i];
    for (const typename D::Start& start : starts[i]) {
      if (start.gain < hopeful.min_gain) continue;
      (domain.candidates()[c].is_fast ? fast : slow).push_back({c, start});
    }
  }
  auto found = extend_by_tasks(domain, parent, fast, set.runs, threads);
  for (auto& t : extend_by_averages(domain, parent, slow, set.runs, averages, threads)) {
    found.push_back(std::move(t));
  }
  return found;
}

// The pieces of the runs in which the parent stays near the readings, or the shortest that can be,
// and the parent fitted to them.
template <Domain D>
std::pair<RunSet<D>, typename D::Trial> near_pieces(const D& domain,
                                                    const typename D::Trial& parent,
                                                    const std::vector<typename D::Run>& runs) {
  std::pair<RunSet<D>, typename D::Trial> result{{runs}, parent};
  auto& [pieces, near] = result;
  for (const size_t count : domain.limits().search.pieces) {
    std::vector<typename D::Run> shorter = domain.cut(runs, count);
    // Too few readings to be cut.
    if (shorter.empty()) break;
    pieces = {std::move(shorter), count};
    near = domain.refit(parent, pieces.runs, domain.seen_begins(parent, pieces.runs), {});
    if (near.fit.chi2_per_sample() < domain.limits().diverged_chi2_per_sample) break;
  }
  return result;
}

// Every candidate added to a parent that has diverged. A prediction far from the readings says
// little about why, so the runs are cut into pieces, each with a begin of its own, in which it
// stays near them; what explains the pieces best is then fitted to the whole (multiple shooting).
template <Domain D>
std::vector<typename D::Trial> extend_by_pieces(const D& domain, const typename D::Trial& parent,
                                                const std::vector<size_t>& candidates,
                                                const std::vector<typename D::Run>& runs,
                                                int threads) {
  using Trial = typename D::Trial;
  const Thresholds& limits = domain.limits();
  const auto [pieces, near] = near_pieces(domain, parent, runs);
  const double near_evidence = near.log_evidence;
  std::vector<Trial> found = extend_near(domain, near, candidates, pieces, threads);
  sort_by_evidence(found);
  const size_t most = std::min(limits.search.max_refits_of_pieces, found.size());
  size_t refits = 0;
  while (refits < most && is_near(found[refits], found.front(), limits)) ++refits;
  const Effort growing{.windows = limits.fitting.diverged_windows};
  parallel_for(found.size(), threads, [&](size_t i) {
    Trial& t = found[i];
    const std::vector<typename D::Begin> begins = domain.seen_begins(t, runs);
    if (i < refits) {
      t = domain.refit(t, runs, begins, growing);
    } else {
      t.log_evidence += parent.log_evidence - near_evidence;
      t = domain.with_begins(t, begins);
    }
  });
  keep_below(found, refits);
  return found;
}

template <Domain D>
std::vector<typename D::Trial> extend_by_each(const D& domain, const typename D::Trial& parent,
                                              const std::vector<size_t>& candidates,
                                              const std::vector<typename D::Run>& runs,
                                              int threads) {
  if (has_diverged(parent, domain.limits())) {
    return extend_by_pieces(domain, parent, candidates, runs, threads);
  }
  return extend_near(domain, parent, candidates, {runs}, threads);
}

}  // namespace photorque::inference
