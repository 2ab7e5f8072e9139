// The search for missing effects: rounds of forecast and fit, starting from the nominal model.
#pragma once

#include "inference/rounds.h"

namespace photorque::inference {

template <Domain D>
class Search {
 public:
  using Trial = typename D::Trial;
  using Runs = std::vector<typename D::Run>;

  Search(const D& domain, const Trial& nominal, const Runs& runs, int threads)
      : domain_(domain), limits_(domain.limits), runs_(runs), threads_(threads) {
    trials_.push_back(nominal);
  }

  // `near`: a trial fitted to the runs from which the rounds start; nullptr: the nominal model.
  std::vector<Trial> run(const Trial* near = nullptr) {
    const Trial nominal = trials_.front();
    if (near != nullptr) return about(nominal, *near);
    Trial from = nominal;
    if (has_diverged(nominal, limits_)) {
      auto [pieces, parted] = near_pieces(domain_, nominal, runs_);
      if (pieces.pieces == 1) return about(nominal, from);
      for (Trial& t : by_pieces(nominal, pieces, parted)) trials_.push_back(std::move(t));
      // Forecasts about a prediction far from the readings are useless. The limit is ten times
      // wider here: a trial from the pieces is a usable start even if noise is understated or a
      // part is unknown.
      constexpr double as_near = 10.0;
      const Trial& best = best_allowed(trials_);
      const bool is_elsewhere =
          !(best.fit.chi2_per_sample() < as_near * limits_.diverged_chi2_per_sample);
      if (is_elsewhere || best.fit.samples != nominal.fit.samples) {
        return deduplicated(std::move(trials_));
      }
      from = best;
    }
    return about(nominal, from);
  }

 private:
  Rounds<D> rounds(const RunSet<D>& set, const Trial& base) const {
    return Rounds<D>(domain_, set, base, limits_.search.max_effects, threads_);
  }

  // All trials, including those of the rounds over whole runs.
  std::vector<Trial> about(const Trial& nominal, const Trial& from) {
    auto found = rounds({runs_}, nominal).run(from);
    for (size_t i = 1; i < found.size(); ++i) trials_.push_back(std::move(found[i]));
    trials_.front() = std::move(found.front());
    return deduplicated(std::move(trials_));
  }

  // A prediction that has diverged does not reveal the cause. The runs are therefore cut into
  // pieces with separate initial conditions, in which the prediction stays near the readings
  // (multiple shooting). The best trials of the pieces are then fitted to whole runs.
  std::vector<Trial> by_pieces(const Trial& nominal, const RunSet<D>& pieces,
                               const Trial& near) const {
    std::vector<Trial> found = rounds(pieces, near).run(near);
    found.erase(found.begin());
    if (found.empty()) return found;  // no effect explains the pieces
    sort_by_evidence(found);
    const size_t refits = put_refits_first(found);
    const Effort growing{.windows = limits_.fitting.diverged_windows};
    parallel_for(found.size(), threads_, [&](size_t i) {
      Trial& t = found[i];
      const std::vector<typename D::Begin> begins = domain_.initial_conditions_from_data(t, runs_);
      if (i < refits) {
        t = domain_.refit(t, runs_, begins, growing);
      } else {
        t.log_evidence += nominal.log_evidence - near.log_evidence;
        t = domain_.with_initial_conditions(t, begins);
      }
    });
    keep_below(found, refits);
    return found;
  }

  // Moves the trials to refit to the front and returns their number. Half of the places are for
  // trials without an empirical law: in pieces such a law can replace effects that it cannot
  // replace in whole runs. `found` is sorted by evidence.
  size_t put_refits_first(std::vector<Trial>& found) const {
    const size_t most = std::min(limits_.search.max_refits_of_pieces, found.size());
    const Trial best = found.front();
    size_t with_law = 0, chosen = 0;
    std::vector<bool> is_chosen(found.size(), false);
    for (size_t i = 0; i < found.size() && chosen < most; ++i) {
      if (!is_near(found[i], best, limits_) || !found[i].objection.empty()) continue;
      const bool has_law = has_empirical(found[i].candidates, domain_.list);
      if (has_law && ++with_law > most / 2) continue;
      is_chosen[i] = true;
      ++chosen;
    }
    std::vector<Trial> ordered;
    for (const bool first : {true, false}) {
      for (size_t i = 0; i < found.size(); ++i) {
        if (is_chosen[i] == first) ordered.push_back(std::move(found[i]));
      }
    }
    found = std::move(ordered);
    return chosen;
  }

  const D& domain_;
  const Thresholds& limits_;
  const Runs& runs_;
  int threads_;
  std::vector<Trial> trials_;
};

// Returns all fitted trials, the nominal model first; `near` as in Search::run().
template <Domain D>
std::vector<typename D::Trial> search(const D& domain, const typename D::Trial& nominal,
                                      const std::vector<typename D::Run>& runs, int threads = 0,
                                      const typename D::Trial* near = nullptr) {
  return Search<D>(domain, nominal, runs, threads).run(near);
}

}  // namespace photorque::inference
