// Evidence of the held-out runs for explanations from the train runs.
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "inference/estimator/evidence.h"
#include "inference/rounds.h"

namespace photorque::inference {

// Allowed trials whose evidence is near the best, and the nominal model.
template <class Trial>
std::vector<size_t> leaders_among(const std::vector<Trial>& trials,
                                  const Thresholds::HeldOut& limits) {
  const std::vector<size_t> order = by_evidence(trials);
  std::vector<size_t> leaders;
  for (const size_t i : order) {
    if (!trials[i].objection.empty() || leaders.size() == limits.max_leaders) continue;
    // The distance is counted from the best trial that physics allows.
    const size_t first = leaders.empty() ? i : leaders.front();
    if (trials[i].log_evidence < trials[first].log_evidence - limits.within) break;
    leaders.push_back(i);
  }
  if (std::find(leaders.begin(), leaders.end(), 0u) == leaders.end()) leaders.push_back(0);
  return leaders;
}

template <Domain D>
class Weighing {
 public:
  using Trial = typename D::Trial;
  using Runs = std::vector<typename D::Run>;

  Weighing(const D& domain, const Runs& train, const Runs& held, int threads,
           std::vector<Trial>& trials)
      : domain_(domain),
        limits_(domain.limits),
        train_(train),
        held_(held),
        threads_(threads),
        trials_(trials),
        all_runs_(train) {
    all_runs_.insert(all_runs_.end(), held.begin(), held.end());
  }

  void run() {
    const std::vector<size_t> places = leaders_among(trials_, limits_.held_out);
    const double nominal = trials_.front().log_evidence;
    const double gain = trials_[places.front()].log_evidence - nominal;
    add_leaders(places);
    const size_t found = trials_.size();
    add_candidates_of_all_runs(trials_.front().candidates);
    add_candidates_of_all_runs(best().joint.candidates);
    refit_from_best();
    search_on();
    search_swings();
    relocate_oscillations();
    add_without_each();
    exchange_places();
    restart_from_joint_fit();
    for (const Leader& leader : leaders_) {
      Trial& trial = trials_[leader.at];
      trial.predictive = predictive_of(trial, leader.joint);
      trial.held_out_sigma = sigma_of_prediction(trial, leader.joint);
      trial.log_evidence = leader.joint.log_evidence;
      trial.joint_significance = leader.joint.significance;
      if (trial.objection.empty()) trial.objection = leader.joint.objection;
    }
    limit_evidence_of_others(found, nominal, gain);
  }

 private:
  // An explanation fitted to the train runs (index into the trials) and to all runs.
  struct Leader {
    size_t at;
    Trial joint;
    // χ² of the best and of this leader when a refit from the best last brought no improvement.
    std::array<double, 2> refitted_at = {};
  };

  // The most likely trial and the nominal model are fitted first. The other fits stop if they
  // cannot come near them.
  void add_leaders(const std::vector<size_t>& places) {
    leaders_.resize(places.size());
    std::vector<size_t> first, others;
    for (size_t k = 0; k < places.size(); ++k) {
      (k == 0 || places[k] == 0 ? first : others).push_back(k);
    }
    add_leaders(places, first, until_convergence(limits_));
    add_leaders(places, others,
                within_reach(until_convergence(limits_), leaders_.front().joint, limits_));
    refit_from_best();
  }

  void add_leaders(const std::vector<size_t>& places, const std::vector<size_t>& which,
                   const Effort& effort) {
    const int64_t samples = trials_.front().fit.samples;
    parallel_for(which.size(), threads_, [&](size_t i) {
      const size_t at = places[which[i]];
      Trial& t = trials_[at];
      // Some trials have been fitted to averages or pieces only.
      if (t.fit.samples != samples)
        t = domain_.refit(t, train_, domain_.initial_conditions_of(t), {});
      leaders_[which[i]] = {at, fit_together(t, effort)};
    });
  }

  Trial fit_together(Trial& t, const Effort& effort) const {
    const Trial held = predict_held(t);
    auto begins = domain_.initial_conditions_of(t);
    for (auto& begin : domain_.initial_conditions_of(held)) begins.push_back(std::move(begin));
    return domain_.refit(t, all_runs_, begins, effort);
  }

  // Stores how well the trial predicts the held-out data.
  Trial predict_held(Trial& t) const {
    Trial held = domain_.predict(t, held_);
    t.holdout_chi2_per_sample =
        std::isfinite(held.fit.chi2) ? held.fit.chi2_per_sample() : infinity;
    return held;
  }

  // Refits every leader from the result of the best leader; skips those for which this failed
  // before.
  void refit_from_best() {
    const Trial best =
        std::min_element(leaders_.begin(), leaders_.end(), [](const Leader& a, const Leader& b) {
          return a.joint.fit.chi2 < b.joint.fit.chi2;
        })->joint;
    parallel_for(leaders_.size(), threads_, [&](size_t k) {
      Leader& leader = leaders_[k];
      const std::array<double, 2> now = {best.fit.chi2, leader.joint.fit.chi2};
      if (leader.refitted_at == now) return;
      inference::refit_from_best(domain_, all_runs_, best, leader.joint);
      if (leader.joint.fit.chi2 == now[1]) leader.refitted_at = now;
    });
  }

  // Makes the fits to the train runs and to all runs end in one local minimum. More readings cannot
  // lower χ². If the joint χ² is lower, the train fit ended in another minimum and its held-out
  // prediction seems too good. If the prediction is far worse than its errors allow, the train runs
  // may have another, equally good minimum. The train fit then restarts from the joint fit.
  void restart_from_joint_fit() {
    constexpr double as_good_chi2 = 9.0;
    parallel_for(leaders_.size(), threads_, [&](size_t k) {
      const Trial& joint = leaders_[k].joint;
      Trial& train = trials_[leaders_[k].at];
      const bool is_lower = joint.fit.chi2 < train.fit.chi2 - limits_.leaders.worth_a_fit;
      if (!is_lower && !is_elsewhere(train, joint)) return;
      Trial again = on_train_runs(joint, until_convergence(limits_));
      if (!(again.fit.chi2 < train.fit.chi2 + (is_lower ? 0.0 : as_good_chi2))) return;
      predict_held(again);
      if (!is_lower && !(again.holdout_chi2_per_sample < train.holdout_chi2_per_sample)) return;
      train = std::move(again);
    });
  }

  // Whether the joint fit predicts the held-out runs but the fit to the train runs does not.
  bool is_elsewhere(const Trial& train, const Trial& joint) const {
    const double most = limits_.decision.max_predictive_sigma;
    return sigma_of_prediction(train, joint) > most && predictive_of(train, joint).sigma < most;
  }

  // Excess of the held-out χ² over the value that the parameter errors of the train fit predict
  // [sigma]; infinite if the model cannot be propagated along the held-out data; 0 where unknown.
  double sigma_of_prediction(const Trial& train, const Trial& joint) const {
    if (train.holdout_chi2_per_sample == infinity) return infinity;
    return train.holdout_chi2_per_sample
               ? held_out_sigma(train.fit, joint.fit, *train.holdout_chi2_per_sample,
                                noise_of(train))
               : 0.0;
  }

  // The allowed leader of largest evidence on all runs.
  const Leader& best() const {
    const Leader* best = nullptr;
    for (const Leader& leader : leaders_) {
      if (!leader.joint.objection.empty() || !trials_[leader.at].objection.empty()) continue;
      if (best == nullptr || leader.joint.log_evidence > best->joint.log_evidence) best = &leader;
    }
    return best != nullptr ? *best : leaders_.front();
  }

  const Leader& nominal() const {
    return *std::find_if(leaders_.begin(), leaders_.end(),
                         [](const Leader& l) { return l.at == 0; });
  }

  Predictive predictive_of(const Trial& train, const Trial& joint) const {
    Predictive result;
    const double fitted = static_cast<double>(train.fit.samples),
                 held = static_cast<double>(joint.fit.samples) - fitted;
    result.chi2_per_sample = (joint.fit.chi2 - train.fit.chi2) / held;
    result.log_score = joint.log_evidence - train.log_evidence;
    result.expected_chi2_per_sample = predict_held_out(train.fit, joint.fit).chi2_per_sample;
    if (!std::isfinite(result.chi2_per_sample)) {
      result.sigma = limits_.noise.excess_unknown;
      return result;
    }
    // The noise level is known to a few per cent; the train runs measure it.
    const double noise = noise_of(train);
    result.sigma = (result.chi2_per_sample - noise) / std::sqrt(2.0 / held + 2.0 / fitted);
    const std::vector<typename D::Begin> begins = domain_.initial_conditions_of(joint);
    const Trial on_held = domain_.with_initial_conditions(
        joint, {begins.end() - static_cast<std::ptrdiff_t>(held_.size()), begins.end()});
    result.sigma = std::max(result.sigma, domain_.excess_sigma(on_held, held_));
    return result;
  }

  double noise_of(const Trial& train) const {
    return std::clamp(train.fit.chi2_per_sample(), 1.0, limits_.held_out.max_noise);
  }

  // If the best explanation does not predict the held-out data, the search continues on all runs.
  void search_on() {
    const Leader from = best();
    if (predictive_of(trials_[from.at], from.joint).sigma < limits_.decision.max_predictive_sigma)
      return;
    if (has_diverged(from.joint, limits_) || !std::isfinite(from.joint.fit.chi2)) return;
    Rounds<D> rounds(domain_, {all_runs_}, nominal().joint, limits_.search.max_effects, threads_);
    // If the start contains an empirical law, the train runs have been scanned for fast effects.
    const bool has_law = has_empirical(from.joint.candidates, domain_.list);
    std::vector<Trial> found = rounds.run(from.joint, !has_law);
    size_t added = 0;
    for (const size_t i : by_evidence(found)) {
      if (found[i].log_evidence < from.joint.log_evidence + limits_.search.min_log_evidence_gain ||
          added == limits_.held_out.max_effects) {
        break;
      }
      if (!found[i].objection.empty()) continue;
      const bool is_elsewhere = has_place(found[i].candidates, domain_.list);
      if (leads(found[i].candidates) && !is_elsewhere) continue;
      Trial joint = domain_.refit(found[i], all_runs_, domain_.initial_conditions_of(found[i]),
                                  until_convergence(limits_));
      add_joint(std::move(joint));
      ++added;
    }
  }

  // Replaces the slow limit of an oscillating effect by the oscillating effect, if all runs
  // together show oscillations in addition to the limit. The train runs alone may hardly excite
  // them, or the search may have fitted another oscillation to the residual of the limit.
  void search_swings() {
    const Leader from = best();
    const auto& all = domain_.list;
    const auto is_limit = [&](size_t c) { return all[c].is_limit_of_swinging; };
    const auto swings = [&](size_t c) { return all[c].swings; };
    if (std::ranges::none_of(from.joint.candidates, is_limit)) return;
    const Effort effort = within_reach(until_convergence(limits_), from.joint, limits_);
    std::vector<Trial> parents = {from.joint};
    if (std::ranges::any_of(from.joint.candidates, swings)) {
      parents.push_back(together_without(from.joint, swings, until_convergence(limits_)));
    }
    for (const Trial& about : parents) {
      const Terms<D> terms =
          terms_to_add(domain_, about, addable(about.candidates, all, &CandidateTraits::swings),
                       all_runs_, slow_runs<D>(domain_, about, {all_runs_}), threads_);
      for (const Trial& both : extend_by_each(domain_, about, terms, all_runs_, threads_)) {
        add_if_near(together_without(both, is_limit, effort));
      }
    }
  }

  // The frequency of an oscillation was found with a poorer model, and a fit does not move far from
  // it. Each oscillation of the best explanation is removed, and all are scanned again.
  void relocate_oscillations() {
    const Leader from = best();
    const auto& all = domain_.list;
    const auto oscillates = [](const CandidateTraits& c) { return c.is_fast && !c.swings; };
    const Effort effort = within_reach(until_convergence(limits_), from.joint, limits_);
    for (const size_t candidate : from.joint.candidates) {
      if (!oscillates(all[candidate])) continue;
      const Trial parent = together_without(
          from.joint, [&](size_t c) { return c == candidate; }, until_convergence(limits_));
      const Terms<D> terms =
          terms_to_add(domain_, parent, addable(parent.candidates, all, oscillates), all_runs_,
                       slow_runs<D>(domain_, parent, {all_runs_}), threads_);
      for (const Trial& with : extend_by_each(domain_, parent, terms, all_runs_, threads_)) {
        add_if_near(domain_.refit(with, all_runs_, domain_.initial_conditions_of(with), effort));
      }
    }
  }

  void add_if_near(Trial joint) {
    if (joint.log_evidence < best().joint.log_evidence - limits_.held_out.within) return;
    add_joint(std::move(joint));
  }

  // Fits the candidates of `joint`, except those that are left out, to all runs.
  template <class Condition>
  Trial together_without(const Trial& joint, const Condition& is_left_out,
                         const Effort& effort) const {
    Members<typename D::Start> others = members_of(domain_.terms_of(joint));
    std::erase_if(others, [&](const auto& other) { return is_left_out(other.term.candidate); });
    return domain_.assemble(joint, others, all_runs_, effort);
  }

  // Refits the best explanation without each of its names, to measure the rise of χ² for each name.
  // Repeats until no omission gives a better leader.
  void add_without_each() {
    for (Leader from = best();;) {
      const auto terms = domain_.terms_of(from.joint);
      for (size_t i = 0; i < terms.size() && terms.size() > 1; ++i) add_without(from, terms, i);
      Leader now = best();
      if (same_candidates(trials_[now.at].candidates, trials_[from.at].candidates)) return;
      from = std::move(now);
    }
  }

  // The train runs may leave the place of an effect ambiguous, and other effects may bias it. On
  // all runs, each candidate of the best explanation is replaced in turn by every candidate with a
  // place, until no exchange improves the evidence.
  void exchange_places() {
    constexpr int most_rounds = 3;
    const auto& all = domain_.list;
    for (int round = 0; round < most_rounds; ++round) {
      const Leader from = best();
      const auto terms = domain_.terms_of(from.joint);
      const bool has_places = std::ranges::any_of(
          terms, [&](const auto& term) { return !all[term.candidate].kind_of_place.empty(); });
      if (!has_places) return;
      for (size_t which = 0; which < terms.size(); ++which) exchange(from, terms, which);
      if (same_candidates(best().joint.candidates, from.joint.candidates)) return;
      add_without_each();
    }
  }

  // Replaces the candidate at `which` in the best explanation and adds the results that are better.
  void exchange(const Leader& from, const Terms<D>& terms, size_t which) {
    // The forecast is crude: a cell has little effect until it limits its string.
    constexpr double forecast_error = 20.0;
    const auto& all = domain_.list;
    const size_t at = leader_of(candidates_of(members_of(terms, which)));
    if (at == leaders_.size()) return;
    const Leader* without = &leaders_[at];
    const std::vector<size_t> others =
        addable(from.joint.candidates, all,
                [](const CandidateTraits& c) { return !c.kind_of_place.empty() && c.is_linear; });
    const std::vector<double> gains =
        domain_.gains(without->joint, others, slow_runs<D>(domain_, without->joint, {all_runs_}));
    const Effort effort =
        within_reach({.max_iterations = limits_.fitting.trial_iterations}, from.joint, limits_);
    std::vector<Members<typename D::Start>> sets;
    for (size_t i = 0; i < others.size(); ++i) {
      const size_t c = others[i];
      if (forecast_error * gains[i] < without->joint.fit.chi2 - from.joint.fit.chi2) continue;
      Members<typename D::Start>& members = sets.emplace_back(members_of(terms));
      // A candidate of the same kind starts from the values of the one it replaces.
      const bool is_alike = all[c].kind_of_place == all[terms[which].candidate].kind_of_place;
      members[which].term = {c, is_alike ? terms[which].start : domain_.start_of(c)};
    }
    std::vector<Trial> tried(sets.size());
    parallel_for(sets.size(), threads_, [&](size_t k) {
      tried[k] = domain_.assemble(from.joint, sets[k], all_runs_, effort);
    });
    for (const size_t k : by_evidence(tried)) {
      if (!(tried[k].log_evidence > from.joint.log_evidence)) return;
      if (!tried[k].objection.empty() || leads(tried[k].candidates)) continue;
      add_joint(std::move(tried[k]));
      return;
    }
  }

  void add_without(const Leader& from, const Terms<D>& terms, size_t left_out) {
    const Members<typename D::Start> members = members_of(terms, left_out);
    const std::vector<size_t> candidates = candidates_of(members);
    // Nonlinear candidates are refitted even if the set leads already: the result depends on the
    // start.
    const auto is_linear = [&](size_t c) { return domain_.list[c].is_linear; };
    if (leads(candidates) && std::ranges::all_of(candidates, is_linear)) return;
    // Removing the candidate may move the others far, in particular nominal values that it
    // replaced.
    Effort growing = until_convergence(limits_);
    growing.windows = limits_.fitting.diverged_windows;
    Trial joint = domain_.assemble(from.joint, members, all_runs_,
                                   within_reach(growing, from.joint, limits_));
    // This model contains the nominal model, so a fit that is worse did not converge and is
    // skipped.
    if (!(joint.fit.chi2 < nominal().joint.fit.chi2 + limits_.leaders.near_chi2)) return;
    if (is_near(joint, from.joint, limits_)) {
      add_joint(std::move(joint));
    } else {
      const Effort brief{.max_iterations = limits_.fitting.brief_iterations};
      Trial train = on_train_runs(joint, brief);
      add_leader(std::move(train), std::move(joint));
    }
  }

  // Fits the candidates of `joint`, which is fitted to all runs, to the train runs.
  Trial on_train_runs(const Trial& joint, const Effort& effort) const {
    const std::vector<typename D::Begin> begins = domain_.initial_conditions_of(joint);
    const Trial start = domain_.with_initial_conditions(
        joint, {begins.begin(), begins.begin() + static_cast<std::ptrdiff_t>(train_.size())});
    return domain_.assemble(start, members_of(domain_.terms_of(joint)), train_, effort);
  }

  // Adds an explanation that is fitted to all runs.
  void add_joint(Trial joint) {
    Trial train = on_train_runs(joint, until_convergence(limits_));
    add_leader(std::move(train), std::move(joint));
  }

  // Adds a leader, or replaces one with smaller joint evidence. Both fits are replaced together:
  // the held-out evidence is their difference, which requires a common local minimum.
  void add_leader(Trial train, Trial joint) {
    const size_t leader = leader_of(train.candidates);
    const bool leads_already = leader < leaders_.size();
    if (leads_already && !(joint.log_evidence > leaders_[leader].joint.log_evidence)) return;
    predict_held(train);
    const size_t at = place_of(std::move(train));
    if (leads_already) {
      leaders_[leader].joint = std::move(joint);
    } else {
      leaders_.push_back({at, std::move(joint)});
    }
  }

  // Extends the leader `parent` by candidates that gain on all runs, unless the extended set
  // already leads.
  void add_candidates_of_all_runs(const std::vector<size_t>& parent) {
    const auto is_parent = [&](const Leader& l) { return trials_[l.at].candidates == parent; };
    const auto at = std::find_if(leaders_.begin(), leaders_.end(), is_parent);
    const Trial joint = at->joint, train = trials_[at->at];
    if (!(joint.fit.chi2_per_sample() < limits_.diverged_chi2_per_sample)) return;
    const std::vector<size_t> candidates = worth_adding(joint, parent);
    const Leader& leader = best();
    const Effort of_train = within_reach(Effort{}, trials_[leader.at], limits_),
                 of_all = within_reach(until_convergence(limits_), leader.joint, limits_);
    std::vector<Trial> on_train(candidates.size()), on_all(candidates.size());
    parallel_for(candidates.size(), threads_, [&](size_t k) {
      const size_t c = candidates[k];
      on_train[k] = domain_.extend(train, c, domain_.start_of(c), train_, of_train);
      on_all[k] = domain_.extend(joint, c, domain_.start_of(c), all_runs_, of_all);
    });
    for (size_t k = 0; k < candidates.size(); ++k) {
      add_leader(std::move(on_train[k]), std::move(on_all[k]));
    }
  }

  // The few untried candidates with the largest predicted gains when added to `joint`, which is
  // fitted to all runs: some physical, some empirical.
  std::vector<size_t> worth_adding(const Trial& joint, const std::vector<size_t>& parent) const {
    const auto& all = domain_.list;
    std::vector<size_t> untried = addable(parent, all, &CandidateTraits::is_linear);
    std::erase_if(untried, [&](size_t c) {
      std::vector<size_t> together = parent;
      together.push_back(c);
      return leads(together);
    });
    const std::vector<double> gains =
        domain_.gains(joint, untried, slow_runs<D>(domain_, joint, {all_runs_}));
    const auto beyond_chance = [&](size_t i) {
      return gains[i] - static_cast<double>(all[untried[i]].parameters);
    };
    // A candidate whose predicted gain is far below the lead of the best is not fitted.
    constexpr double forecast_error = 2.0;
    const double behind_chi2 = joint.fit.chi2 - best().joint.fit.chi2 - limits_.leaders.near_chi2;
    std::vector<size_t> order;
    for (size_t i = 0; i < untried.size(); ++i) {
      const bool is_out_of_reach = forecast_error * gains[i] < behind_chi2;
      if (!is_out_of_reach && beyond_chance(i) > limits_.scoring.min_joint_gain) order.push_back(i);
    }
    std::stable_sort(order.begin(), order.end(),
                     [&](size_t a, size_t b) { return beyond_chance(a) > beyond_chance(b); });
    std::vector<size_t> best;
    size_t named = 0, empirical = 0;
    for (const size_t i : order) {
      const bool few = all[untried[i]].is_empirical ? empirical++ < limits_.held_out.max_empirical
                                                    : named++ < limits_.held_out.max_effects;
      if (few) best.push_back(untried[i]);
    }
    return best;
  }

  // Index of the leader with these candidates; the number of leaders if there is none.
  size_t leader_of(const std::vector<size_t>& candidates) const {
    const auto leader = std::ranges::find_if(leaders_, [&](const Leader& l) {
      return same_candidates(candidates, trials_[l.at].candidates);
    });
    return static_cast<size_t>(leader - leaders_.begin());
  }
  bool leads(const std::vector<size_t>& candidates) const {
    return leader_of(candidates) < leaders_.size();
  }

  // Stores the trial, replacing one with the same candidates if there is one; returns its index.
  size_t place_of(Trial trial) {
    for (size_t i = 0; i < trials_.size(); ++i) {
      if (!same_candidates(trial.candidates, trials_[i].candidates)) continue;
      trials_[i] = std::move(trial);
      return i;
    }
    trials_.push_back(std::move(trial));
    return trials_.size() - 1;
  }

  // Limits the evidence of those of the first `found` trials that are not leaders.
  void limit_evidence_of_others(size_t found, double nominal, double gain) {
    // The minimum is over the leaders except the nominal model, which may diverge on the held-out
    // runs.
    const double nominal_now = trials_.front().log_evidence;
    double lowest = std::numeric_limits<double>::infinity(), highest = nominal_now;
    std::vector<bool> is_leader(trials_.size(), false);
    for (const Leader& leader : leaders_) {
      is_leader[leader.at] = true;
      if (leader.at != 0) lowest = std::min(lowest, trials_[leader.at].log_evidence);
      highest = std::max(highest, trials_[leader.at].log_evidence);
    }
    const double ratio = gain > 0.0 ? (highest - nominal_now) / gain : 1.0;
    for (size_t i = 0; i < found; ++i) {
      if (is_leader[i]) continue;
      double& evidence = trials_[i].log_evidence;
      evidence = std::min(lowest, nominal_now + ratio * (evidence - nominal));
    }
  }

  const D& domain_;
  const Thresholds& limits_;
  const Runs& train_;
  const Runs& held_;
  int threads_;
  std::vector<Trial>& trials_;
  Runs all_runs_;  // train runs, then held-out runs
  std::vector<Leader> leaders_;
};

// Replaces the evidence of the leaders on the train runs by that on all runs. The gains of the
// other trials over the nominal model scale by the ratio of the best, and stay below the leaders.
// Effects that a nominal model's uncertainty absorbs in each run, so that only all runs together
// show them, are scored and added to `trials`, fitted to the train runs. The nominal model stays
// first.
template <Domain D>
void weigh_with_held_out(const D& domain, const std::vector<typename D::Run>& train,
                         const std::vector<typename D::Run>& held, int threads,
                         std::vector<typename D::Trial>& trials) {
  Weighing<D>(domain, train, held, threads, trials).run();
}

}  // namespace photorque::inference
