// The search for what is missing: every candidate alone, then the best with every other.
#pragma once

#include "inference/pairs.h"

namespace photorque::inference {

struct SearchOptions {
  int threads = 0;      // 0: all
  int max_effects = 3;  // together
};

// Of trials of the same candidates, found in different order, the best.
template <class Trial>
std::vector<Trial> without_twins(std::vector<Trial> trials) {
  std::vector<Trial> kept;
  for (Trial& trial : trials) {
    const auto twin = std::find_if(kept.begin(), kept.end(), [&](const Trial& t) {
      return same_candidates(t.candidates, trial.candidates);
    });
    if (twin == kept.end()) {
      kept.push_back(std::move(trial));
    } else if (trial.log_evidence > twin->log_evidence) {
      *twin = std::move(trial);
    }
  }
  return kept;
}

// One search: trials with one candidate, then two, then three, each from the best before.
template <Domain D>
class Search {
 public:
  using Trial = typename D::Trial;
  using Runs = std::vector<typename D::Run>;

  Search(const D& domain, const Trial& nominal, const Runs& runs, const SearchOptions& options)
      : domain_(domain), runs_(runs), options_(options), trials_{nominal}, parents_{nominal} {}

  std::vector<Trial> run() {
    for (int effects = 1; effects <= options_.max_effects; ++effects) {
      std::vector<Trial> found = without_twins(extend_parents(effects));
      settle_leaders(domain_, runs_, options_.threads, found, parents_);
      keep_parents();
      std::vector<Trial> next = worth_extending(found, effects);
      for (Trial& t : found) trials_.push_back(std::move(t));
      if (next.empty()) break;
      parents_ = std::move(next);
    }
    return std::move(trials_);
  }

 private:
  // All trials with one candidate more than the parents, and pairs that hide each other. Empirical
  // candidates compete alone and beside the best of the others.
  std::vector<Trial> extend_parents(int effects) const {
    std::vector<Trial> found;
    for (const Trial& parent : parents_) {
      add_extended(parent, effects <= 2 && &parent == &parents_.front(), found);
    }
    if (effects != 2 || found.empty()) return found;
    const Trial best = found[by_evidence(found).front()];
    if (has_gained(best) && !is_empirical(best)) {
      for (const Trial& half : other_halves(domain_, best, parents_, trials_, runs_)) {
        add_extended(half, false, found);
      }
    }
    for (Trial& t : best_pairs(domain_, trials_.front(), runs_, found, options_.threads)) {
      found.push_back(std::move(t));
    }
    return found;
  }

  void add_extended(const Trial& parent, bool with_empirical, std::vector<Trial>& found) const {
    const std::vector<CandidateTraits>& all = domain_.candidates();
    std::vector<size_t> others;
    for (size_t c = 0; c < all.size(); ++c) {
      if (all[c].is_empirical && !with_empirical) continue;
      if (!acts_already(parent.candidates, c, all)) others.push_back(c);
    }
    for (Trial& t : extend_by_each(domain_, parent, others, runs_, options_.threads)) {
      found.push_back(std::move(t));
    }
  }

  // The parents were fitted again: so they stand among all trials.
  void keep_parents() {
    for (const Trial& parent : parents_) {
      for (Trial& trial : trials_) {
        if (trial.candidates == parent.candidates) trial = parent;
      }
    }
  }

  // The best named trial goes on, and the next best while the best leaves structure behind; when
  // nothing gained, nothing more will.
  std::vector<Trial> worth_extending(const std::vector<Trial>& found, int effects) const {
    const Thresholds::Search& limits = domain_.limits().search;
    const size_t most = effects == 1 ? limits.max_single_parents : limits.max_parents;
    std::vector<Trial> next;
    for (const size_t i : by_evidence(found)) {
      const Trial& trial = found[i];
      if (!has_gained(trial) || next.size() == most) break;
      if (is_empirical(trial) || !trial.objection.empty()) continue;
      // Two effects that leave the prediction elsewhere: no third will bring it back.
      if (effects >= 2 && has_diverged(trial, domain_.limits())) break;
      next.push_back(trial);
      if (domain_.excess_sigma(trial, runs_) < limits.explained_sigma) break;
    }
    return next;
  }

  bool has_gained(const Trial& trial) const {
    return trial.log_evidence >
           parents_.front().log_evidence + domain_.limits().search.min_log_evidence_gain;
  }

  bool is_empirical(const Trial& trial) const {
    return std::any_of(trial.candidates.begin(), trial.candidates.end(),
                       [&](size_t c) { return domain_.candidates()[c].is_empirical; });
  }

  const D& domain_;
  const Runs& runs_;
  SearchOptions options_;
  std::vector<Trial> trials_, parents_;
};

// All trials that were fitted, the nominal model first.
template <Domain D>
std::vector<typename D::Trial> search(const D& domain, const typename D::Trial& nominal,
                                      const std::vector<typename D::Run>& runs,
                                      const SearchOptions& options = {}) {
  return Search<D>(domain, nominal, runs, options).run();
}

}  // namespace photorque::inference
