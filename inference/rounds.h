// Rounds of forecast and fit, starting from the best explanation so far.
#pragma once

#include <cmath>
#include <map>

#include "inference/subsets.h"
#include "inference/trials.h"

namespace photorque::inference {

// Each round linearises the problem about one trial, predicts the gain of every set of candidates
// (subsets.h), and fits the best few. The next round starts from the best trial. When no set gains
// further, effects that only a scan can find are added to the best trial, and the rounds continue.
template <Domain D>
class Rounds {
 public:
  using Trial = typename D::Trial;
  using Runs = std::vector<typename D::Run>;

  // `base` has no candidates and is fitted to the set; at most `max_effects` are combined.
  Rounds(const D& domain, const RunSet<D>& set, const Trial& base, size_t max_effects, int threads)
      : domain_(domain),
        limits_(domain.limits),
        set_(set),
        max_effects_(max_effects),
        threads_(threads),
        trials_{base} {}

  // Returns all fitted trials, the base first. The rounds start at `from`, which is fitted to the
  // set. `scans`: whether to search also for effects that only a scan can find.
  std::vector<Trial> run(const Trial& from, bool scans = true) {
    if (!from.candidates.empty()) trials_.push_back(from);
    go_on(from, {}, scans);
    return std::move(trials_);
  }

 private:
  // Rounds over trials that contain the candidates `swinging`. If there are none, the first round
  // is followed by rounds that start from the results of a scan of the base.
  void go_on(Trial at, const std::vector<size_t>& swinging, bool scans) {
    bool scan = false;
    const bool is_first_track = swinging.empty();
    for (int round = 0; round < limits_.search.max_rounds; ++round) {
      const bool is_first = is_first_track && round == 0;
      std::vector<Trial> found = scan ? scanned(at) : predicted(at, is_first);
      if (is_first) {
        for (Trial& t : each_alone(at)) found.push_back(std::move(t));
      }
      if (scan) {
        for (Trial& t : relocated(at)) found.push_back(std::move(t));
      } else {
        for (Trial& t : switched_on(at)) found.push_back(std::move(t));
      }
      std::vector<Trial> parents = {at};
      // Pieces only select the sets to fit to whole runs, so fits to them need not converge.
      if (set_.pieces == 1) converge_leaders(domain_, set_.runs, threads_, found, parents);
      for (Trial& parent : parents) keep(std::move(parent));
      for (Trial& trial : found) keep(std::move(trial));
      const Trial before = *std::find_if(trials_.begin(), trials_.end(), [&](const Trial& t) {
        return same_candidates(t.candidates, at.candidates);
      });
      Trial best = best_allowed(trials_, swinging);
      if (is_first && scans && may_be_surrogates(best)) {
        const std::vector<size_t> fast = search_oscillating_effects(best);
        best = best_allowed(trials_, swinging);
        if (!fast.empty() && includes(best.candidates, fast)) return;
      }
      const bool gained =
          best.log_evidence > before.log_evidence + limits_.search.min_log_evidence_gain;
      at = gained ? best : before;
      // Pieces select the sets that are fitted to whole runs.
      if (set_.pieces > 1 && explains(at)) {
        at = without_each(std::move(at));
        if (!has_empirical(at)) return;
      }
      // Scans are slow: they start when no predicted candidate lowers χ² further.
      if (!gained && (scan || !scans || !is_worth_a_scan(at))) return;
      if (scan && set_.pieces > 1) return;
      scan = !gained;
    }
  }

  // Slow effects absorb the quasi-static part of an oscillating effect and then hide the rest of
  // it. The base is therefore scanned without slow effects, but with the instrument errors of
  // `best`, and rounds start from the best result. Returns the candidates of that result; empty: no
  // oscillating effect was found.
  std::vector<size_t> search_oscillating_effects(const Trial& best) {
    const Trial base = with_instruments(domain_, best, trials_.front(), set_.runs);
    // A scan about a diverged base is useless if some candidate leads back to the readings.
    if (has_diverged(base, limits_) && !has_diverged(best, limits_)) return {};
    std::vector<Trial> found = scanned(base);
    if (found.empty()) return {};
    sort_by_evidence(found);
    const Trial again =
        domain_.refit(found.front(), set_.runs, domain_.initial_conditions_of(found.front()),
                      until_convergence(limits_));
    if (again.log_evidence > found.front().log_evidence) found.front() = again;
    const Trial first = found.front();
    for (Trial& t : found) keep(std::move(t));
    const double least = base.log_evidence + limits_.decision.min_log_odds;
    if (!(first.log_evidence > least) || !first.objection.empty()) return {};
    go_on(first, first.candidates, true);
    return first.candidates;
  }

  // Whether slow effects may imitate an oscillating effect. This is possible for several effects
  // together, for the slow limit of an oscillating effect, for an effect of which only a
  // combination is significant, and for an effect that leaves a residual. The residual may cancel
  // in means of neighbours, but it raises χ².
  bool may_be_surrogates(const Trial& at) const {
    const bool swings =
        std::ranges::any_of(at.candidates, [&](size_t c) { return domain_.list[c].is_fast; });
    if (at.candidates.empty() || swings) return false;
    if (domain_.list[at.candidates.front()].is_limit_of_swinging) return true;
    const double most = limits_.search.explained_sigma;
    const bool is_vague = std::ranges::any_of(at.largest_component, [&](double sigma) {
      return sigma < limits_.decision.min_significance;
    });
    return at.candidates.size() > 1 || is_vague ||
           at.fit.chi2_per_sample() >
               1.0 + most * std::sqrt(2.0 / static_cast<double>(at.fit.samples)) ||
           domain_.excess_sigma(at, set_.runs) > most;
  }

  // Whether neither residual structure nor a large misfit remains. Both are tested, because in a
  // short piece structure alone may be insignificant.
  bool explains(const Trial& at) const {
    return at.fit.chi2_per_sample() < limits_.held_out.max_noise &&
           domain_.excess_sigma(at, set_.runs) < limits_.search.explained_sigma;
  }

  bool has_empirical(const Trial& at) const {
    return inference::has_empirical(at.candidates, domain_.list);
  }

  static bool has_empirical(const Subset& s, const LinearProblem& problem) {
    return std::any_of(s.groups.begin(), s.groups.end(),
                       [&](size_t g) { return problem.groups[g].is_empirical; });
  }

  // Removes candidates one by one as long as that improves the trial; keeps all trials that it
  // fits.
  Trial without_each(Trial at) {
    const Runs averages = slow_runs(domain_, at, set_);
    while (at.candidates.size() > 1) {
      const Terms<D> terms = domain_.terms_of(at);
      std::vector<Members<typename D::Start>> fewer;
      for (size_t i = 0; i < terms.size(); ++i) fewer.push_back(members_of(terms, i));
      std::vector<Trial> found = fitted(at, fewer, averages);
      const Trial& best = found.front();
      const bool is_better = best.log_evidence > at.log_evidence && best.objection.empty();
      if (is_better) at = best;
      for (Trial& t : found) keep(std::move(t));
      if (!is_better) break;
    }
    return at;
  }

  // Whether a scan is worthwhile. Pieces of runs do not resolve weak lines or jumps, which are
  // found later in whole runs.
  bool is_worth_a_scan(const Trial& at) const {
    return set_.pieces == 1 ||
           domain_.excess_sigma(at, set_.runs) > limits_.decision.max_excess_sigma;
  }

  // Candidates with linear strengths that need no scan at the full sampling rate.
  Terms<D> slow_terms(const Trial& at, const Runs& averages) const {
    const auto slow_and = [&](bool is_linear) {
      return addable(at.candidates, domain_.list, [&](const CandidateTraits& c) {
        return !c.is_fast && c.has_strength && c.is_linear == is_linear;
      });
    };
    Terms<D> terms;
    for (const size_t c : slow_and(true)) terms.push_back({c, domain_.start_of(c)});
    for (auto& term : terms_to_add(domain_, at, slow_and(false), set_.runs, averages, threads_)) {
      terms.push_back(std::move(term));
    }
    return terms;
  }

  // Fits the sets that the linear problem about `at` predicts to be best.
  std::vector<Trial> predicted(const Trial& at, bool first) const {
    const Runs averages = slow_runs(domain_, at, set_);
    Terms<D> terms = domain_.terms_of(at);
    const size_t own = terms.size();
    for (auto& term : slow_terms(at, averages)) terms.push_back(std::move(term));
    const LinearProblem problem = domain_.linear_problem(at, terms, averages);
    const std::vector<bool> is_kept = kept_terms(problem, own);
    const auto kept = static_cast<size_t>(std::count(is_kept.begin(), is_kept.end(), true));
    if (kept >= max_effects_) return {};
    const std::vector<Subset> subsets = best_subsets(problem, max_effects_ - kept, limits_);
    if (subsets.empty()) return {};
    std::vector<Members<typename D::Start>> chosen;
    size_t sets = 0, known_sets = 0;
    const double of_trial = forecast_of_trial(subsets, problem, own);
    const double least = std::max(subsets.front().log_evidence - limits_.search.forecast_within,
                                  of_trial - limits_.decision.min_log_odds);
    for (const Subset& s : subsets) {
      const bool is_single =
          first && s.groups.size() == 1 && s.gain > least_gain(s, problem, subsets);
      const bool is_leader = s.log_evidence > least && sets < limits_.search.max_fits_of_round;
      // An empirical law fits anything, whereas known effects may gain only when all parts are
      // present.
      const bool is_known = has_empirical(at) && !has_empirical(s, problem) &&
                            known_sets < limits_.search.max_known_fits_of_round;
      if (!is_leader && !is_single && !is_known) continue;
      Members<typename D::Start> members = predicted_members(s, problem, terms, is_kept);
      if (members.empty()) continue;
      // A trial with more names needs a predicted gain.
      if (s.log_evidence < of_trial && is_enlarged(candidates_of(members), at)) continue;
      const double expected = at.log_evidence + s.log_evidence - of_trial;
      if (was_tried(members, expected) || is_refused(members, expected)) continue;
      if (is_leader) ++sets;
      if (is_known) ++known_sets;
      chosen.push_back(std::move(members));
    }
    return fitted(at, chosen, averages);
  }

  // Flags the terms of the trial that the problem leaves out because averages do not resolve them.
  static std::vector<bool> kept_terms(const LinearProblem& problem, size_t own) {
    std::vector<bool> kept(own, true);
    for (const StrengthGroup& group : problem.groups) {
      if (group.term < own) kept[group.term] = false;
    }
    return kept;
  }

  // Predicted log evidence of the trial itself, as the reference for other sets; −∞ if the trial is
  // not among the predicted sets.
  static double forecast_of_trial(const std::vector<Subset>& subsets, const LinearProblem& problem,
                                  size_t own) {
    const auto is_own = [&](size_t g) { return problem.groups[g].term < own; };
    size_t all = 0;
    for (size_t g = 0; g < problem.groups.size(); ++g) all += is_own(g) ? 1 : 0;
    for (const Subset& s : subsets) {
      const bool is_trial =
          s.groups.size() == all && std::all_of(s.groups.begin(), s.groups.end(), is_own);
      if (is_trial) return s.log_evidence;
    }
    return -std::numeric_limits<double>::infinity();
  }

  // Whether the set contains all candidates of the trial and more. False for a trial without
  // candidates, because some single candidates are always fitted for comparison.
  static bool is_enlarged(const std::vector<size_t>& candidates, const Trial& at) {
    return !at.candidates.empty() && candidates.size() > at.candidates.size() &&
           includes(candidates, at.candidates);
  }

  // Minimum gain of a single candidate that is fitted for comparison.
  double least_gain(const Subset& single, const LinearProblem& problem,
                    const std::vector<Subset>& subsets) const {
    double best = 0.0;
    for (const Subset& s : subsets) {
      if (s.groups.size() == 1) best = std::max(best, s.gain);
    }
    const double by_chance = static_cast<double>(problem.groups[single.groups[0]].count());
    return std::max(limits_.scoring.min_gain + by_chance, limits_.scoring.min_fraction * best);
  }

  // The kept terms, and those of the subset with their predicted strengths.
  Members<typename D::Start> predicted_members(const Subset& s, const LinearProblem& problem,
                                               const Terms<D>& terms,
                                               const std::vector<bool>& is_kept) const {
    Members<typename D::Start> members;
    for (size_t i = 0; i < is_kept.size(); ++i) {
      if (is_kept[i]) members.push_back({terms[i], {}});
    }
    Eigen::Index first = 0;
    for (const size_t g : s.groups) {
      const StrengthGroup& group = problem.groups[g];
      members.push_back({terms[group.term], s.value.segment(first, group.count())});
      first += group.count();
    }
    return members;
  }

  // Whether the set has been fitted with about the log evidence that is `expected`. If its evidence
  // is lower, its start may have been too far off, and another fit is worthwhile.
  bool was_tried(const Members<typename D::Start>& members, double expected) const {
    const std::vector<size_t> candidates = candidates_of(members);
    return std::any_of(trials_.begin(), trials_.end(), [&](const Trial& t) {
      return same_candidates(t.candidates, candidates) &&
             !(expected > t.log_evidence + limits_.search.min_log_evidence_gain &&
               std::isfinite(expected));
    });
  }

  // Whether a part of the set has been rejected (for example for a wrong sign) and no gain beyond
  // that part is predicted. The set would be rejected too, and would take the place of a valid one.
  bool is_refused(const Members<typename D::Start>& members, double expected) const {
    const std::vector<size_t> candidates = candidates_of(members);
    return std::any_of(trials_.begin(), trials_.end(), [&](const Trial& t) {
      return !t.objection.empty() && includes(candidates, t.candidates) &&
             t.candidates.size() < candidates.size() &&
             expected < t.log_evidence + limits_.decision.min_log_odds;
    });
  }

  // Fits sets to averages; the best are refitted to all readings.
  std::vector<Trial> fitted(const Trial& at, const std::vector<Members<typename D::Start>>& chosen,
                            const Runs& averages) const {
    const Effort effort{.max_iterations = limits_.fitting.trial_iterations};
    std::vector<Trial> found(chosen.size());
    if (found.empty()) return found;
    const Trial rough = domain_.refit(at, averages, domain_.initial_conditions_of(at), {});
    parallel_for(chosen.size(), threads_, [&](size_t i) {
      found[i] = domain_.assemble(at, chosen[i], averages, within_reach(effort, rough, limits_));
    });
    for (Trial& t : found) t.log_evidence += at.log_evidence - rough.log_evidence;
    found = deduplicated(std::move(found));
    sort_by_evidence(found);
    // A diverged trial is not refitted to all readings if the best trial did not diverge.
    const bool best_is_near = !has_diverged(found.front(), limits_);
    size_t refits = 0;
    while (refits < std::min(limits_.search.max_refits_of_averages, found.size()) &&
           !(best_is_near && has_diverged(found[refits], limits_))) {
      ++refits;
    }
    parallel_for(refits, threads_, [&](size_t i) {
      const Effort whole = set_.pieces == 1 ? within_reach(Effort{}, at, limits_) : Effort{};
      found[i] = domain_.refit(found[i], set_.runs, domain_.initial_conditions_of(found[i]), whole);
    });
    keep_below(found, refits);
    return found;
  }

  // Fits candidates that are too nonlinear for a forecast, one at a time.
  std::vector<Trial> each_alone(const Trial& at) const {
    const std::vector<size_t> nonlinear =
        addable(at.candidates, domain_.list, &CandidateTraits::is_fitted_first);
    if (nonlinear.empty() || at.candidates.size() >= max_effects_) return {};
    const Runs averages = slow_runs(domain_, at, set_);
    std::vector<Members<typename D::Start>> chosen;
    for (const auto& term : terms_to_add(domain_, at, nonlinear, set_.runs, averages, threads_)) {
      chosen.push_back(members_of(domain_.terms_of(at)));
      chosen.back().push_back({term});
    }
    return fitted(at, chosen, averages);
  }

  // Adds candidates without parameters. They have no strength, so their gain cannot be forecast.
  std::vector<Trial> switched_on(const Trial& at) const {
    if (at.candidates.size() >= max_effects_) return {};
    Terms<D> terms;
    for (const size_t c : addable(at.candidates, domain_.list,
                                  [](const CandidateTraits& t) { return t.parameters == 0; })) {
      terms.push_back({c, domain_.start_of(c)});
    }
    return extend_by_each(domain_, at, terms, set_.runs, threads_);
  }

  // Removes each effect with an instant or a place, together with empirical laws that may
  // compensate its error, and locates it again. Its first location was found with a poorer model,
  // and a fit does not move far from it.
  std::vector<Trial> relocated(const Trial& at) const {
    std::vector<Trial> found;
    const auto& all = domain_.list;
    const bool is_alone = at.candidates.size() < 2 && !has_place(at.candidates, all);
    if (is_alone || (explains(at) && !has_empirical(at))) return found;
    const Runs averages = slow_runs(domain_, at, set_);
    const Terms<D> terms = domain_.terms_of(at);
    for (const Term<typename D::Start>& term : terms) {
      const CandidateTraits& traits = all[term.candidate];
      if (traits.is_linear || traits.is_fast || traits.is_empirical) continue;
      Members<typename D::Start> rest = members_of(terms);
      std::erase_if(rest, [&](const auto& other) {
        return other.term.candidate == term.candidate || all[other.term.candidate].is_empirical;
      });
      const Effort effort{.max_iterations = limits_.fitting.trial_iterations};
      const Trial parent = domain_.assemble(at, rest, set_.runs, effort);
      const Terms<D> places =
          terms_to_add(domain_, parent, {term.candidate}, set_.runs, averages, threads_);
      for (Trial& t : extend_by_each(domain_, parent, places, set_.runs, threads_)) {
        if (!same_candidates(t.candidates, at.candidates) || t.log_evidence > at.log_evidence) {
          found.push_back(std::move(t));
        }
      }
    }
    return found;
  }

  // Adds candidates that vary faster than averages of the readings resolve.
  std::vector<Trial> scanned(const Trial& at) const {
    if (at.candidates.size() >= max_effects_) return {};
    const std::vector<size_t> fast =
        addable(at.candidates, domain_.list, [](const CandidateTraits& c) {
          return c.is_fast || (!c.has_strength && c.parameters > 0);
        });
    const Terms<D> terms =
        terms_to_add(domain_, at, fast, set_.runs, slow_runs(domain_, at, set_), threads_);
    double best = 0.0;
    std::map<size_t, double> best_of;  // by candidate
    for (const auto& [candidate, start] : terms) {
      if (std::isfinite(start.gain)) best = std::max(best, start.gain);
      best_of[candidate] = std::max(best_of[candidate], start.gain);
    }
    Terms<D> promising;
    for (const auto& term : terms) {
      const bool is_best = !(term.start.gain < best_of[term.candidate]);
      if (is_best || term.start.gain >= limits_.scoring.min_start_fraction * best) {
        promising.push_back(term);
      }
    }
    return extend_by_each(domain_, at, promising, set_.runs, threads_);
  }

  void keep(Trial trial) {
    for (Trial& t : trials_) {
      if (!same_candidates(t.candidates, trial.candidates)) continue;
      if (trial.log_evidence > t.log_evidence || t.candidates == trial.candidates) {
        t = std::move(trial);
      }
      return;
    }
    trials_.push_back(std::move(trial));
  }

  const D& domain_;
  const Thresholds& limits_;
  RunSet<D> set_;
  size_t max_effects_;
  int threads_;
  std::vector<Trial> trials_;
};

}  // namespace photorque::inference
