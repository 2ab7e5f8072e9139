// The best of many trials, fitted with more patience than all of them could be.
#pragma once

#include <algorithm>

#include "core/parallel.h"
#include "inference/domain.h"

namespace photorque::inference {

// Until a fit converges: one that is given up early makes whatever goes on from it seem to gain.
inline Effort patient(const Thresholds& limits) {
  return {.max_iterations = limits.fitting.patient_iterations, .creep = limits.fitting.creep};
}

// As long as it may still come near the best on the same runs.
template <class Trial>
Effort within_reach(Effort effort, const Trial& best, const Thresholds& limits) {
  effort.worth_chi2 = best.fit.chi2 + limits.leaders.near_chi2;
  return effort;
}

// Whether a trial explains nearly as much as the best on the same runs: where even the nominal
// model has diverged, most others are no leaders, however few they are.
template <class Trial>
bool is_near(const Trial& trial, const Trial& best, const Thresholds& limits) {
  return trial.fit.chi2 < limits.leaders.near_fraction * best.fit.chi2 + limits.leaders.near_chi2;
}

// A second chance for a trial, from where the best on the same runs ended.
template <Domain D>
void learn(const D& domain, const std::vector<typename D::Run>& runs, const typename D::Trial& best,
           typename D::Trial& trial) {
  const Thresholds& limits = domain.limits();
  if (trial.fit.chi2 < best.fit.chi2 + limits.leaders.worth_a_fit) return;
  const Effort brief{.max_iterations = limits.fitting.brief_iterations};
  const Effort effort =
      within_reach(is_near(trial, best, limits) ? patient(limits) : brief, best, limits);
  typename D::Trial again = domain.refit_near(trial, best, runs, effort);
  if (again.log_evidence > trial.log_evidence) trial = std::move(again);
}

// The leaders' fits are carried on until they converge: what only goes on where its parent's fit
// stopped would seem to gain by the candidate that it adds. For the same reason they, and the
// parents, have a second chance from where the best of them ended.
template <Domain D>
void settle_leaders(const D& domain, const std::vector<typename D::Run>& runs, int threads,
                    std::vector<typename D::Trial>& found,
                    std::vector<typename D::Trial>& parents) {
  using Trial = typename D::Trial;
  const Thresholds& limits = domain.limits();
  std::vector<size_t> leaders = by_evidence(found);
  if (leaders.empty()) return;
  leaders.resize(std::min(limits.leaders.max_leaders, leaders.size()));
  const Trial first = found[leaders.front()];
  std::erase_if(leaders, [&](size_t i) { return !is_near(found[i], first, limits); });
  parallel_for(leaders.size(), threads, [&](size_t i) {
    Trial& trial = found[leaders[i]];
    Trial again = domain.refit(trial, runs, domain.begins_of(trial),
                               within_reach(patient(limits), first, limits));
    if (again.log_evidence > trial.log_evidence) trial = std::move(again);
  });
  const Trial best = found[by_evidence(found).front()];
  parallel_for(leaders.size() + parents.size(), threads, [&](size_t i) {
    learn(domain, runs, best, i < leaders.size() ? found[leaders[i]] : parents[i - leaders.size()]);
  });
}

}  // namespace photorque::inference
