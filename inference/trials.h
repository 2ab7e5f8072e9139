// Functions of the search rounds: fits of the best trials, averaged runs and pieces of runs.
#pragma once

#include <algorithm>
#include <limits>

#include "core/parallel.h"
#include "inference/domain.h"

namespace photorque::inference {

// Options to iterate until convergence. If a fit stops early, every extension of it seems to gain.
inline Effort until_convergence(const Thresholds& limits) {
  return {.max_iterations = limits.fitting.leader_iterations,
          .min_relative_decrease = limits.fitting.min_relative_decrease};
}

// Stops the fit when it cannot come near the best trial on the same runs.
template <class Trial>
Effort within_reach(Effort effort, const Trial& best, const Thresholds& limits) {
  effort.worth_chi2 = best.fit.chi2 + limits.leaders.near_chi2;
  return effort;
}

// Whether the χ² of a trial is near that of the best trial on the same runs. If even the nominal
// model has diverged, most trials are not near.
template <class Trial>
bool is_near(const Trial& trial, const Trial& best, const Thresholds& limits) {
  return trial.fit.chi2 < limits.leaders.near_fraction * best.fit.chi2 + limits.leaders.near_chi2;
}

// Refits a trial, starting from the result of the best fit on the same runs; keeps the better
// result.
template <Domain D>
void refit_from_best(const D& domain, const std::vector<typename D::Run>& runs,
                     const typename D::Trial& best, typename D::Trial& trial) {
  const Thresholds& limits = domain.limits;
  if (trial.fit.chi2 < best.fit.chi2 + limits.leaders.worth_a_fit) return;
  const Effort brief{.max_iterations = limits.fitting.brief_iterations};
  const Effort effort =
      within_reach(is_near(trial, best, limits) ? until_convergence(limits) : brief, best, limits);
  typename D::Trial again = domain.refit_near(trial, best, runs, effort);
  if (again.log_evidence > trial.log_evidence) trial = std::move(again);
}

// Iterates the leaders' fits to convergence. Otherwise a fit that merely continues its parent's
// unfinished fit would seem to gain by the added candidate. For the same reason leaders and parents
// are also refitted from the result of the best fit.
template <Domain D>
void converge_leaders(const D& domain, const std::vector<typename D::Run>& runs, int threads,
                      std::vector<typename D::Trial>& found,
                      std::vector<typename D::Trial>& parents) {
  using Trial = typename D::Trial;
  const Thresholds& limits = domain.limits;
  std::vector<size_t> leaders = by_evidence(found);
  if (leaders.empty()) return;
  leaders.resize(std::min(limits.leaders.max_leaders, leaders.size()));
  const Trial first = found[leaders.front()];
  std::erase_if(leaders, [&](size_t i) { return !is_near(found[i], first, limits); });
  parallel_for(leaders.size(), threads, [&](size_t i) {
    Trial& trial = found[leaders[i]];
    Trial again = domain.refit(trial, runs, domain.initial_conditions_of(trial),
                               within_reach(until_convergence(limits), first, limits));
    if (again.log_evidence > trial.log_evidence) trial = std::move(again);
  });
  const Trial best = found[by_evidence(found).front()];
  parallel_for(leaders.size() + parents.size(), threads, [&](size_t i) {
    refit_from_best(domain, runs, best,
                    i < leaders.size() ? found[leaders[i]] : parents[i - leaders.size()]);
  });
}

// The base with the errors of instruments that the trial contains; without any, the base itself.
template <Domain D>
typename D::Trial with_instruments(const D& domain, const typename D::Trial& trial,
                                   const typename D::Trial& base,
                                   const std::vector<typename D::Run>& runs) {
  Members<typename D::Start> members = members_of(domain.terms_of(trial));
  std::erase_if(members, [&](const auto& member) {
    return !domain.list[member.term.candidate].is_of_instrument;
  });
  if (members.empty()) return base;
  const Effort effort{.max_iterations = domain.limits.fitting.trial_iterations};
  return domain.assemble(trial, members, runs, effort);
}

// The runs, or their pieces.
template <Domain D>
struct RunSet {
  std::vector<typename D::Run> runs;
  size_t pieces = 1;  // number of pieces per recording
};

// Averages with fewer samples: sufficient for slow effects and several times faster.
template <Domain D>
std::vector<typename D::Run> slow_runs(const D& domain, const typename D::Trial& about,
                                       const RunSet<D>& set) {
  return domain.average(about, set.runs, domain.limits.fitting.slow_blocks / set.pieces);
}

// Averages and pieces overestimate some evidence. The first `fitted` trials are fitted to all
// readings; the evidence of the others is limited to the lowest of these.
template <class Trial>
void keep_below(std::vector<Trial>& trials, size_t fitted) {
  double lowest = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < fitted; ++i) lowest = std::min(lowest, trials[i].log_evidence);
  for (size_t i = fitted; i < trials.size(); ++i) {
    trials[i].log_evidence = std::min(trials[i].log_evidence, lowest);
  }
}

// Sorts trials on the same runs, the largest evidence first.
template <class Trial>
void sort_by_evidence(std::vector<Trial>& trials) {
  std::stable_sort(trials.begin(), trials.end(),
                   [](const Trial& a, const Trial& b) { return a.log_evidence > b.log_evidence; });
}

// The trial of largest evidence that physics allows and that contains these candidates; the first
// trial if there is none.
template <class Trial>
const Trial& best_allowed(const std::vector<Trial>& trials,
                          const std::vector<size_t>& containing = {}) {
  for (const size_t i : by_evidence(trials)) {
    if (trials[i].objection.empty() && includes(trials[i].candidates, containing)) return trials[i];
  }
  return trials.front();
}

// Keeps the best of trials with equal candidates in any order.
template <class Trial>
std::vector<Trial> deduplicated(std::vector<Trial> trials) {
  std::vector<Trial> kept;
  for (Trial& trial : trials) {
    const auto equal = std::find_if(kept.begin(), kept.end(), [&](const Trial& t) {
      return same_candidates(t.candidates, trial.candidates);
    });
    if (equal == kept.end()) {
      kept.push_back(std::move(trial));
    } else if (trial.log_evidence > equal->log_evidence) {
      *equal = std::move(trial);
    }
  }
  return kept;
}

template <Domain D>
using Terms = std::vector<Term<typename D::Start>>;

// All starts of the candidates when added to the parent; `averages` are averages of the runs.
template <Domain D>
Terms<D> terms_to_add(const D& domain, const typename D::Trial& parent,
                      const std::vector<size_t>& candidates,
                      const std::vector<typename D::Run>& runs,
                      const std::vector<typename D::Run>& averages, int threads) {
  const auto starts = domain.starts(parent, candidates, runs, averages, threads);
  Terms<D> terms;
  for (size_t i = 0; i < candidates.size(); ++i) {
    for (const auto& start : starts[i]) terms.push_back({candidates[i], start});
  }
  return terms;
}

// Adds each term to the parent and fits; of several starts of a candidate, the best fit is
// returned.
template <Domain D>
std::vector<typename D::Trial> extend_by_each(const D& domain, const typename D::Trial& parent,
                                              const Terms<D>& terms,
                                              const std::vector<typename D::Run>& runs,
                                              int threads) {
  using Trial = typename D::Trial;
  const Effort effort{.max_iterations = domain.limits.fitting.trial_iterations};
  std::vector<Trial> trials(terms.size());
  parallel_for(terms.size(), threads, [&](size_t i) {
    trials[i] = domain.extend(parent, terms[i].candidate, terms[i].start, runs, effort);
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

// Cuts the runs into pieces in which the fitted parent stays near the readings. If it diverges in
// pieces of every length, the missing effects are fast and best visible in long pieces. The longest
// pieces whose residual is little more than that of the shortest are then returned, possibly whole
// runs.
template <Domain D>
std::pair<RunSet<D>, typename D::Trial> near_pieces(const D& domain,
                                                    const typename D::Trial& parent,
                                                    const std::vector<typename D::Run>& runs) {
  constexpr double little_more = 3.0;
  std::vector<std::pair<RunSet<D>, typename D::Trial>> tried{{{runs}, parent}};
  for (const size_t count : domain.limits.search.pieces) {
    std::vector<typename D::Run> shorter = domain.cut(runs, count);
    // There are too few readings to cut further.
    if (shorter.empty()) break;
    RunSet<D> pieces{std::move(shorter), count};
    typename D::Trial near = domain.refit(
        parent, pieces.runs, domain.initial_conditions_from_data(parent, pieces.runs), {});
    tried.emplace_back(std::move(pieces), std::move(near));
    if (!has_diverged(tried.back().second, domain.limits)) return std::move(tried.back());
  }
  const double enough = little_more * tried.back().second.fit.chi2_per_sample();
  return std::move(*std::find_if(tried.begin(), tried.end(), [&](const auto& one) {
    return !(one.second.fit.chi2_per_sample() > enough);
  }));
}

}  // namespace photorque::inference
