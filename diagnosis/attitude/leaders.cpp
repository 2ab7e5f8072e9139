#include "diagnosis/attitude/leaders.h"

#include <algorithm>

#include "core/parallel.h"

namespace photorque {
namespace {

// Enough to see whether a fit that is far off falls into another local minimum.
FitSettings brief() {
  FitSettings settings;
  settings.max_iterations = 10;
  return settings;
}

// Of χ², to be worth a second chance.
constexpr double worth_a_fit = 10.0;

void learn(Trial& trial, const Trial& best, const std::vector<Candidate>& all,
           const std::vector<Observation>& runs) {
  if (trial.fit.chi2 < best.fit.chi2 + worth_a_fit) return;
  const FitSettings how = is_near(trial, best) ? patient_fit() : brief();
  Trial again = refit_near(trial, best, all, runs, how);
  if (again.log_evidence > trial.log_evidence) trial = std::move(again);
}

}  // namespace

FitSettings patient_fit() {
  FitSettings settings;
  settings.max_iterations = 60;
  return settings;
}

bool is_near(const Trial& trial, const Trial& best) {
  constexpr double fraction = 1.3, slack = 100.0;
  return trial.fit.chi2 < fraction * best.fit.chi2 + slack;
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
                    std::vector<Trial>& trials, const std::vector<Candidate>& all,
                    const std::vector<Observation>& runs, int threads) {
  constexpr size_t max_leaders = 6;
  std::vector<size_t> leaders = by_evidence(found);
  if (leaders.empty()) return;
  leaders.resize(std::min(max_leaders, leaders.size()));
  const Trial first = found[leaders.front()];
  std::erase_if(leaders, [&](size_t i) { return !is_near(found[i], first); });
  parallel_for(leaders.size(), threads, [&](size_t i) {
    Trial& trial = found[leaders[i]];
    Trial again = refit(trial, all, runs, trial.fit.best.runs, patient_fit());
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

void learn_from_best(std::vector<Trial>& trials, const std::vector<Candidate>& all,
                     const std::vector<Observation>& runs, int threads) {
  const Trial best =
      *std::min_element(trials.begin(), trials.end(),
                        [](const Trial& a, const Trial& b) { return a.fit.chi2 < b.fit.chi2; });
  parallel_for(trials.size(), threads, [&](size_t i) { learn(trials[i], best, all, runs); });
}

}  // namespace photorque
