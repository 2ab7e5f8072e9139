// The search for missing effects: rounds of forecast and fit, about the nominal model first.
#pragma once

#include "inference/rounds.h"

namespace photorque::inference {

template <Domain D>
class Search {
 public:
  using Trial = typename D::Trial;
  using Runs = std::vector<typename D::Run>;

  Search(const D& domain, const Trial& nominal, const Runs& runs, int threads)
      : domain_(domain), limits_(domain.limits()), runs_(runs), threads_(threads) {
    trials_.push_back(nominal);
  }

  // `near`: where the rounds start, fitted to the runs; nullptr: about the nominal model.
  std::vector<Trial> run(const Trial* near = nullptr) {
    const Trial nominal = trials_.front();
    if (near != nullptr) return about(nominal, *near);
    Trial from = nominal;
    if (has_diverged(nominal, limits_)) {
      auto [pieces, parted] = near_pieces(domain_, nominal, runs_);
      if (pieces.pieces == 1) return about(nominal, from);
      for (Trial& t : by_pieces(nominal, pieces, parted)) trials_.push_back(std::move(t));
      // Nothing can be predicted about a prediction that is elsewhere. One that pieces led to the
      // readings, all but a part that is still unknown or noise that is more than stated, says
      // more.
      constexpr double as_near = 10.0;
      const Trial& best = trials_[best_allowed()];
      const bool is_elsewhere =
          !(best.fit.chi2_per_sample() < as_near * limits_.diverged_chi2_per_sample);
      if (is_elsewhere || best.fit.samples != nominal.fit.samples) {
        return without_twins(std::move(trials_));
      }
      from = best;
    }
    return about(nominal, from);
  }

 private:
  Rounds<D> rounds(const RunSet<D>& set, const Trial& base) const {
    return Rounds<D>(domain_, set, base, limits_.search.max_effects, threads_);
  }

  // All trials, with those of the rounds over whole runs.
  std::vector<Trial> about(const Trial& nominal, const Trial& from) {
    auto found = rounds({runs_}, nominal).run(from);
    for (size_t i = 1; i < found.size(); ++i) trials_.push_back(std::move(found[i]));
    trials_.front() = std::move(found.front());
    return without_twins(std::move(trials_));
  }

  // A prediction far from the readings does not show its cause, so the runs are cut into pieces,
  // each with its own initial conditions, in which it stays near them; the best for the pieces is
  // then fitted to the whole (multiple shooting).
  std::vector<Trial> by_pieces(const Trial& nominal, const RunSet<D>& pieces,
                               const Trial& near) const {
    std::vector<Trial> found = rounds(pieces, near).run(near);
    found.erase(found.begin());
    if (found.empty()) return found;  // nothing explains the pieces either
    sort_by_evidence(found);
    const size_t refits = put_refits_first(found);
    const Effort growing{.windows = limits_.fitting.diverged_windows};
    parallel_for(found.size(), threads_, [&](size_t i) {
      Trial& t = found[i];
      const std::vector<typename D::Begin> begins = domain_.seen_begins(t, runs_);
      if (i < refits) {
        t = domain_.refit(t, runs_, begins, growing);
      } else {
        t.log_evidence += nominal.log_evidence - near.log_evidence;
        t = domain_.with_begins(t, begins);
      }
    });
    keep_below(found, refits);
    return found;
  }

  // The trials near the best; half of the places are for trials without an empirical law, because
  // in pieces such a law replaces effects that it could not replace in the whole. `found` is by
  // evidence.
  size_t put_refits_first(std::vector<Trial>& found) const {
    const size_t most = std::min(limits_.search.max_refits_of_pieces, found.size());
    const auto has_law = [&](const Trial& t) {
      return std::any_of(t.candidates.begin(), t.candidates.end(),
                         [&](size_t c) { return domain_.candidates()[c].is_empirical; });
    };
    const Trial best = found.front();
    size_t with_law = 0, chosen = 0;
    std::vector<bool> is_chosen(found.size(), false);
    for (size_t i = 0; i < found.size() && chosen < most; ++i) {
      if (!is_near(found[i], best, limits_) || !found[i].objection.empty()) continue;
      if (has_law(found[i]) && ++with_law > most / 2) continue;
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

  size_t best_allowed() const {
    for (const size_t i : by_evidence(trials_)) {
      if (trials_[i].objection.empty()) return i;
    }
    return 0;
  }

  const D& domain_;
  const Thresholds& limits_;
  const Runs& runs_;
  int threads_;
  std::vector<Trial> trials_;
};

// All trials that were fitted, the nominal model first; `near` as in Search::run().
template <Domain D>
std::vector<typename D::Trial> search(const D& domain, const typename D::Trial& nominal,
                                      const std::vector<typename D::Run>& runs, int threads = 0,
                                      const typename D::Trial* near = nullptr) {
  return Search<D>(domain, nominal, runs, threads).run(near);
}

}  // namespace photorque::inference
