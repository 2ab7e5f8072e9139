#include "diagnosis/search.h"

#include <algorithm>

#include "core/parallel.h"
#include "diagnosis/scan.h"

namespace photorque {
namespace {

struct Task {
  size_t candidate;
  Disturbance start;
};

// Every candidate added to `parent`; of several starts the best.
std::vector<Trial> extend_by_each(const Trial& parent, const std::vector<Candidate>& all,
                                  const std::vector<size_t>& candidates,
                                  const std::vector<Observation>& runs, int threads) {
  const std::vector<double> lines_Hz = line_frequencies_Hz(parent.fit, runs);
  std::vector<std::vector<Disturbance>> starts(candidates.size());
  parallel_for(candidates.size(), threads, [&](size_t i) {
    starts[i] = starts_of(all[candidates[i]], parent, runs, lines_Hz);
  });
  std::vector<Task> tasks;
  for (size_t i = 0; i < candidates.size(); ++i) {
    for (const Disturbance& start : starts[i]) tasks.push_back({candidates[i], start});
  }
  std::vector<Trial> trials(tasks.size());
  parallel_for(tasks.size(), threads, [&](size_t i) {
    trials[i] = extend(parent, all, tasks[i].candidate, tasks[i].start, runs);
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

bool contains(const Trial& trial, size_t candidate) {
  return std::find(trial.candidates.begin(), trial.candidates.end(), candidate) !=
         trial.candidates.end();
}

std::vector<size_t> by_evidence(const std::vector<Trial>& trials) {
  std::vector<size_t> order(trials.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return trials[a].log_evidence > trials[b].log_evidence;
  });
  return order;
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
      std::vector<size_t> others;
      for (size_t c = 0; c < all.size(); ++c) {
        if (!contains(parent, c)) others.push_back(c);
      }
      for (Trial& t : extend_by_each(parent, all, others, runs, options.threads)) {
        found.push_back(std::move(t));
      }
    }
    // The best physics go on; when not even the best gained, nothing more will.
    constexpr size_t most_parents = 2;
    std::vector<Trial> next;
    for (const size_t i : by_evidence(found)) {
      if (next.size() == most_parents) break;
      const bool gained = found[i].log_evidence > parents.front().log_evidence + 3.0;
      if (gained && is_physics(found[i], all) && found[i].objection.empty()) {
        next.push_back(found[i]);
      }
    }
    for (Trial& t : found) trials.push_back(std::move(t));
    if (next.empty()) break;
    parents = std::move(next);
  }
  return trials;
}

}  // namespace photorque
