// The interface between the search for missing effects and the domain in which it searches.
//
// A domain has recordings ("runs"), a nominal model of them, and candidates: terms that may be
// missing from that model. A trial is the nominal model with some of the candidates, fitted to the
// runs. The flow is
//
//   residual -> score every candidate -> fit -> compare evidence -> weigh with held-out data
//            -> decide
//
// (search.h, weigh.h, decide.h). The domain defines how a trial is fitted, how its evidence is
// computed and which trials are forbidden.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <concepts>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/numerics/order.h"
#include "inference/estimator/evidence.h"
#include "inference/estimator/thresholds.h"
#include "inference/subsets.h"

namespace photorque::inference {

// Properties of a candidate that the search uses.
struct CandidateTraits {
  // Candidates with the same name are parametrisations of the same term; a trial contains one of
  // them.
  std::string name;
  // A smooth function without a physical law. It competes with the physical candidates, so that an
  // unknown effect is not attributed to one of them, but it names no effect.
  bool is_empirical = false;
  // Whether a score test can predict the gain of its fit.
  bool is_linear = true;
  // Whether it varies faster than averaged readings resolve.
  bool is_fast = false;
  // Whether it has strengths: parameters in which it is linear.
  bool has_strength = true;
  size_t parameters = 0;
  // Whether it has a place that a single recording may leave ambiguous.
  bool has_place = false;
  // The kind that candidates at different places (cells, lamps) have in common; empty: it has no
  // place.
  std::string kind_of_place = {};
  // Whether it is so nonlinear that forecasts about a model without it fail. Such candidates are
  // fitted one at a time, from all their starts, before sets are forecast.
  bool is_fitted_first = false;
  // `swings`: a part oscillates relative to the body. `is_limit_of_swinging`: an oscillating effect
  // equals this effect in slow motion.
  bool swings = false;
  bool is_limit_of_swinging = false;
  // Whether it is an error of an instrument, which changes the readings but not the motion.
  bool is_of_instrument = false;
  // Maximum number of times that a trial may contain it.
  size_t most = 1;
};

// Candidates, evidence and significance of a trial, without the fit.
struct Explanation {
  std::vector<size_t> candidates;  // in the order of addition; empty for the nominal model
  // Natural logarithm of the evidence with the prior odds of the candidates, up to a constant that
  // is common to all trials on the same runs.
  double log_evidence = 0.0;
  // For each candidate √(θᵀ C⁻¹ θ) of the parameters that measure its size; NaN if it has none.
  std::vector<double> significance = {};
  std::vector<double> joint_significance = {};  // including the held-out data, if weighed
  std::string objection = {};                   // why physics forbids it; empty: allowed
  // Prediction of the held-out data, where computed.
  std::optional<double> holdout_chi2_per_sample = {};
  std::optional<Predictive> predictive = {};
  // Excess of the held-out χ² over the value that the parameter errors predict (evidence.h)
  // [sigma].
  std::optional<double> held_out_sigma = {};
  // For each candidate the largest |θ|/σ of a single parameter of its size; empty: not computed.
  std::vector<double> largest_component = {};
};

// Convergence options of the fit of a trial.
using Effort = Options;

// A candidate with its initial values.
template <class Start>
struct Term {
  size_t candidate = 0;
  Start start;
};

// One candidate of a set. `strengths`: initial values of its strengths; empty: those of the start.
template <class Start>
struct Member {
  Term<Start> term;
  Eigen::VectorXd strengths = {};
};
template <class Start>
using Members = std::vector<Member<Start>>;

// The terms as members of a set, except the one at index `left_out`.
template <class Start>
Members<Start> members_of(const std::vector<Term<Start>>& terms, size_t left_out = SIZE_MAX) {
  Members<Start> members;
  for (size_t i = 0; i < terms.size(); ++i) {
    if (i != left_out) members.push_back({terms[i]});
  }
  return members;
}

template <class Start>
std::vector<size_t> candidates_of(const Members<Start>& members) {
  std::vector<size_t> candidates;
  for (const Member<Start>& m : members) candidates.push_back(m.term.candidate);
  return candidates;
}

// A domain is a list of candidates with the limits of search and decision. It defines its trials,
// runs, starts and initial conditions. A Start holds the initial values of a candidate's fit and
// the gain (fall of χ²) that a scan predicts, infinite without a scan. A Begin holds the initial
// conditions of one run, which are nuisances. All functions are const and are called from several
// threads.
template <class D>
concept Domain = std::derived_from<typename D::Trial, Explanation> &&
    std::derived_from<decltype(D::Trial::fit), Fit> &&
    requires(const D& domain, const typename D::Trial& trial, const typename D::Start& start,
             const std::vector<typename D::Run>& runs, const std::vector<size_t>& candidates,
             const std::vector<typename D::Begin>& begins, const Effort& effort, size_t count,
             const std::vector<Term<typename D::Start>>& terms,
             const Members<typename D::Start>& members, int threads) {
  requires std::derived_from<std::decay_t<decltype(domain.list[0])>, CandidateTraits>;
  { domain.limits } -> std::convertible_to<const Thresholds&>;

  // Initial values of a candidate that needs no scan.
  { domain.start_of(count) } -> std::same_as<typename D::Start>;
  // Adds the candidate of index `count` to the trial and fits it.
  { domain.extend(trial, count, start, runs, effort) } -> std::same_as<typename D::Trial>;
  // Refits the trial to other or more runs from the given initial conditions.
  { domain.refit(trial, runs, begins, effort) } -> std::same_as<typename D::Trial>;
  // Refits the trial, starting from the second trial's values in all parameters that both have.
  { domain.refit_near(trial, trial, runs, effort) } -> std::same_as<typename D::Trial>;
  // Predicts runs that the trial has not been fitted to; only nuisance parameters are fitted.
  { domain.predict(trial, runs) } -> std::same_as<typename D::Trial>;
  { domain.initial_conditions_of(trial) } -> std::same_as<std::vector<typename D::Begin>>;
  // Initial conditions from the first readings of each run.
  {
    domain.initial_conditions_from_data(trial, runs)
    } -> std::same_as<std::vector<typename D::Begin>>;
  // Returns the trial with these initial conditions for its next fit.
  { domain.with_initial_conditions(trial, begins) } -> std::same_as<typename D::Trial>;

  // Predicted fall of χ² for each candidate (0 for candidates that are not linear).
  { domain.gains(trial, candidates, runs) } -> std::same_as<std::vector<double>>;
  // The candidates of the trial with their fitted values, in their order.
  { domain.terms_of(trial) } -> std::same_as<std::vector<Term<typename D::Start>>>;
  // Linear problem in the strengths of the terms about a trial, with all other parameters projected
  // out. The first `terms` are those of the trial. Terms that averages do not resolve are omitted.
  { domain.linear_problem(trial, terms, runs) } -> std::same_as<LinearProblem>;
  // The nominal model with exactly these members. Its fit starts from the result of the trial.
  { domain.assemble(trial, members, runs, effort) } -> std::same_as<typename D::Trial>;
  // Starts of each candidate added to the trial: one, or the best of a scan over its nonlinear
  // parameters. The second runs are averages of the first.
  {
    domain.starts(trial, candidates, runs, runs, threads)
    } -> std::same_as<std::vector<std::vector<typename D::Start>>>;

  // Averages the runs about the trial's prediction into about `count` samples each.
  { domain.average(trial, runs, count) } -> std::same_as<std::vector<typename D::Run>>;
  // Cuts each run into `count` pieces; pieces with too few readings are omitted.
  { domain.cut(runs, count) } -> std::same_as<std::vector<typename D::Run>>;
  // Residual structure of the trial (whiteness.h) [sigma].
  { domain.excess_sigma(trial, runs) } -> std::convertible_to<double>;
};

// Indices of trials on the same runs, the largest evidence first.
template <std::derived_from<Explanation> T>
std::vector<size_t> by_evidence(const std::vector<T>& trials) {
  return sorted_indices(trials.size(), [&](size_t a, size_t b) {
    return trials[a].log_evidence > trials[b].log_evidence;
  });
}

// Whether two lists contain the same candidates in any order.
inline bool same_candidates(const std::vector<size_t>& a, const std::vector<size_t>& b) {
  return a.size() == b.size() && std::is_permutation(a.begin(), a.end(), b.begin());
}

// Whether `all` contains every one of `some`.
inline bool includes(const std::vector<size_t>& all, const std::vector<size_t>& some) {
  return std::ranges::all_of(some,
                             [&](size_t c) { return std::ranges::find(all, c) != all.end(); });
}

// Whether any of these candidates has a place, or is empirical.
template <std::derived_from<CandidateTraits> C>
bool has_place(const std::vector<size_t>& among, const std::vector<C>& all) {
  return std::ranges::any_of(among, [&](size_t c) { return all[c].has_place; });
}
template <std::derived_from<CandidateTraits> C>
bool has_empirical(const std::vector<size_t>& among, const std::vector<C>& all) {
  return std::ranges::any_of(among, [&](size_t c) { return all[c].is_empirical; });
}

// The candidates whose traits satisfy the condition and whose name `among` contains less often than
// allowed.
template <std::derived_from<CandidateTraits> C, class Condition>
std::vector<size_t> addable(const std::vector<size_t>& among, const std::vector<C>& all,
                            const Condition& condition) {
  std::vector<size_t> candidates;
  for (size_t c = 0; c < all.size(); ++c) {
    const auto count =
        std::ranges::count_if(among, [&](size_t other) { return all[other].name == all[c].name; });
    const bool may_act = static_cast<size_t>(count) < all[c].most;
    if (may_act && std::invoke(condition, all[c])) candidates.push_back(c);
  }
  return candidates;
}

// Whether the prediction of a trial has diverged, so that its derivatives are useless.
template <class Trial>
bool has_diverged(const Trial& trial, const Thresholds& limits) {
  return trial.fit.chi2_per_sample() > limits.diverged_chi2_per_sample;
}

}  // namespace photorque::inference
