#include "diagnosis/attitude/leaders.h"

#include <algorithm>

#include "core/parallel.h"

namespace photorque {
namespace {

// Enough to see whether a fit that is far off falls into another local minimum.
FitSettings brief(const Thresholds& limits) {
  FitSettings settings;
  settings.max_iterations = limits.fitting.brief_iterations;
  return settings;
}

void learn(Trial& trial, const Trial& best, const Candidates& all,
           const std::vector<Observation>& runs) {
  if (trial.fit.chi2 < best.fit.chi2 + all.limits.leaders.worth_a_fit) return;
  const FitSettings how =
      is_near(trial, best, all.limits) ? patient_fit(all.limits) : brief(all.limits);
  Trial again = refit_near(trial, best, all, runs, how);
  if (again.log_evidence > trial.log_evidence) trial = std::move(again);
}

}  // namespace

FitSettings patient_fit(const Thresholds& limits) {
  FitSettings settings;
  settings.max_iterations = limits.fitting.patient_iterations;
  return settings;
}

bool is_near(const Trial& trial, const Trial& best, const Thresholds& limits) {
  return trial.fit.chi2 < limits.leaders.near_fraction * best.fit.chi2 + limits.leaders.near_chi2;
}

std::vector<size_t> by_evidence(const std::vector<Trial>& trials) {
  std::vector<size_t> order(trials.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return trials[a].log_evidence > trials[b].log_evidence;
  });
  return order;
}

void settle_leaders(std::vector<Trial>& found, std::vector<Trial>& parents,
                    std::vector<Trial>& trials, const Candidates& all,
                    const std::vector<Observation>& runs, int threads) {
  std::vector<size_t> leaders = by_evidence(found);
  if (leaders.empty()) return;
  leaders.resize(std::min(all.limits.leaders.max_leaders, leaders.size()));
  const Trial first = found[leaders.front()];
  std::erase_if(leaders, [&](size_t i) { return !is_near(found[i], first, all.limits); });
  parallel_for(leaders.size(), threads, [&](size_t i) {
    Trial& trial = found[leaders[i]];
    Trial again = refit(trial, all, runs, trial.fit.best.runs, patient_fit(all.limits));
    if (again.log_evidence > trial.log_evidence) trial = std::move(again);
  });
  const Trial best = found[by_evidence(found).front()];
  parallel_for(leaders.size() + parents.size(), threads, [&](size_t i) {
    Trial& trial = i < leaders.size() ? found[leaders[i]] : parents[i - leaders.size()];
    learn(trial, best, all, runs);
  });
  for (const Trial& parent : parents) {
    for (Trial& trial : trials) {
      if (trial.candidates == parent.candidates) trial = parent;
    }
  }
}

void learn_from_best(std::vector<Trial>& trials, const Candidates& all,
                     const std::vector<Observation>& runs, int threads) {
  const Trial best =
      *std::min_element(trials.begin(), trials.end(),
                        [](const Trial& a, const Trial& b) { return a.fit.chi2 < b.fit.chi2; });
  parallel_for(trials.size(), threads, [&](size_t i) { learn(trials[i], best, all, runs); });
}

}  // namespace photorque
