#include "diagnosis/search.h"

#include <algorithm>

#include "core/parallel.h"
#include "diagnosis/scan.h"
#include "diagnosis/screen.h"
#include "diagnosis/whiteness.h"

namespace photorque {
namespace {

struct Task {
  size_t candidate;
  Disturbance start;
};

// Whether a score test can foretell what a candidate's fit gains.
bool is_linear(const Candidate& c) {
  return !c.start.parameters.empty() &&
         std::none_of(c.searched.begin(), c.searched.end(), [](bool b) { return b; });
}

// The runs averaged over blocks: enough for what is slow, and several times faster.
std::vector<Observation> coarse(const std::vector<Observation>& runs) {
  constexpr size_t blocks = 1000;
  std::vector<Observation> result;
  for (const Observation& seen : runs) result.push_back(seen.averaged(blocks));
  return result;
}

// Where the fit is good, the score test foretells well what each candidate would gain: the others
// need no fit of their own. Where it is bad, all of them do.
std::vector<size_t> promising(const Trial& parent, const std::vector<Candidate>& all,
                              const std::vector<size_t>& candidates,
                              const std::vector<Observation>& slow_runs) {
  constexpr double good_chi2_per_sample = 1.5, least_gain = 5.0;
  if (parent.fit.chi2_per_sample() > good_chi2_per_sample) return candidates;
  std::vector<ScoreGroup> groups;
  for (const size_t c : candidates) {
    groups.push_back(
        {is_linear(all[c]) ? std::vector<Disturbance>{all[c].start} : std::vector<Disturbance>{}});
  }
  const std::vector<Score> scores = score(parent.fit, slow_runs, groups);
  std::vector<size_t> result;
  for (size_t i = 0; i < candidates.size(); ++i) {
    const Candidate& c = all[candidates[i]];
    const double parameters = static_cast<double>(c.start.parameters.size());
    if (!is_linear(c) || scores[i].gain > least_gain + parameters) result.push_back(candidates[i]);
  }
  return result;
}

// The fits of all tasks on `runs`; of several starts of a candidate the best.
std::vector<Trial> extend_by_tasks(const Trial& parent, const std::vector<Candidate>& all,
                                   const std::vector<Task>& tasks,
                                   const std::vector<Observation>& runs, int threads) {
  std::vector<Trial> trials(tasks.size());
  parallel_for(tasks.size(), threads, [&](size_t i) {
    FitSettings settings;
    settings.most_iterations = 12;
    trials[i] = extend(parent, all, tasks[i].candidate, tasks[i].start, runs, settings);
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

// Every candidate added to `parent`. Slow laws are fitted to averages first; those that come near
// the best, and all fast ones, to the full runs.
std::vector<Trial> extend_by_each(const Trial& parent, const std::vector<Candidate>& all,
                                  const std::vector<size_t>& candidates,
                                  const std::vector<Observation>& runs, int threads) {
  constexpr size_t most_refits = 4;
  const std::vector<Observation> slow_runs = coarse(runs);
  std::vector<double> lines_Hz;
  std::vector<size_t> worth_it;
  parallel_for(2, threads, [&](size_t i) {
    if (i == 0) lines_Hz = line_frequencies_Hz(parent.fit, runs);
    if (i == 1) worth_it = promising(parent, all, candidates, slow_runs);
  });
  std::vector<std::vector<Disturbance>> starts(worth_it.size());
  parallel_for(worth_it.size(), threads,
               [&](size_t i) { starts[i] = starts_of(all[worth_it[i]], parent, runs, lines_Hz); });
  std::vector<Task> slow, fast;
  for (size_t i = 0; i < worth_it.size(); ++i) {
    const std::string& kind = all[worth_it[i]].effect.kind;
    const bool is_fast =
        kind == "periodic_torque" || kind == "floor_vibration" || kind == "flexible_mode";
    for (const Disturbance& start : starts[i]) {
      (is_fast ? fast : slow).push_back({worth_it[i], start});
    }
  }
  std::vector<Trial> found = extend_by_tasks(parent, all, fast, runs, threads);
  std::vector<Trial> rough = extend_by_tasks(parent, all, slow, slow_runs, threads);
  // Their evidence counts as what they gain over the parent on the same averages.
  const double rough_parent = refit(parent, all, slow_runs, parent.fit.best.runs).log_evidence;
  for (Trial& t : rough) t.log_evidence += parent.log_evidence - rough_parent;
  std::stable_sort(rough.begin(), rough.end(),
                   [](const Trial& a, const Trial& b) { return a.log_evidence > b.log_evidence; });
  const size_t refits = std::min(most_refits, rough.size());
  parallel_for(refits, threads,
               [&](size_t i) { rough[i] = refit(rough[i], all, runs, rough[i].fit.best.runs); });
  for (Trial& t : rough) found.push_back(std::move(t));
  return found;
}

// One kind acts once, in whatever parametrisation.
bool contains(const Trial& trial, const std::vector<Candidate>& all, size_t candidate) {
  return std::any_of(trial.candidates.begin(), trial.candidates.end(),
                     [&](size_t c) { return all[c].label == all[candidate].label; });
}

std::vector<size_t> by_evidence(const std::vector<Trial>& trials) {
  std::vector<size_t> order(trials.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return trials[a].log_evidence > trials[b].log_evidence;
  });
  return order;
}

double excess_sigma(const Trial& t, const std::vector<Observation>& runs) {
  return whiteness(residuals_of(t.fit, runs)).excess_sigma;
}

bool is_physics(const Trial& trial, const std::vector<Candidate>& all) {
  return std::none_of(trial.candidates.begin(), trial.candidates.end(),
                      [&](size_t c) { return all[c].empirical(); });
}

}  // namespace

std::vector<Trial> search(const Fit& belief, const std::vector<Candidate>& all,
                          const std::vector<Observation>& runs, const SearchOptions& options) {
  std::vector<Trial> trials = {believed_trial(belief)};
  std::vector<Trial> parents = trials;
  for (int effects = 1; effects <= options.most_effects; ++effects) {
    std::vector<Trial> found;
    for (const Trial& parent : parents) {
      // Empirical laws compete alone and beside the best physics.
      const bool with_empirical = effects <= 2 && &parent == &parents.front();
      std::vector<size_t> others;
      for (size_t c = 0; c < all.size(); ++c) {
        if (all[c].empirical() && !with_empirical) continue;
        if (!contains(parent, all, c)) others.push_back(c);
      }
      for (Trial& t : extend_by_each(parent, all, others, runs, options.threads)) {
        found.push_back(std::move(t));
      }
    }
    // The best physics goes on, and the next best while the best leaves structure behind; when
    // nothing gained, nothing more will.
    const size_t most_parents = effects == 1 ? 2 : 1;
    constexpr double explained_sigma = 5.0;
    std::vector<Trial> next;
    for (const size_t i : by_evidence(found)) {
      const bool gained = found[i].log_evidence > parents.front().log_evidence + 3.0;
      if (!gained || next.size() == most_parents) break;
      if (!is_physics(found[i], all)) {
        continue;
      }
      if (!found[i].objection.empty()) continue;
      next.push_back(found[i]);
      if (excess_sigma(found[i], runs) < explained_sigma) break;
    }
    for (Trial& t : found) trials.push_back(std::move(t));
    if (next.empty()) break;
    parents = std::move(next);
  }
  return trials;
}

}  // namespace photorque
