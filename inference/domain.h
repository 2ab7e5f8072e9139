// The interface between the search for missing effects and the domain in which it searches.
//
// A domain has recordings ("runs"), a nominal model of them, and candidates: terms that may be
// missing from that model. A trial is the nominal model with some of the candidates, fitted to the
// runs. The flow is
//
//   residual -> score every candidate -> fit -> compare evidence -> weigh with held-out data
//            -> decide
//
// (search.h, weigh.h, decide.h). How a trial is fitted, what its evidence is and what forbids it,
// the domain alone knows.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <concepts>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "inference/estimator/evidence.h"
#include "inference/estimator/thresholds.h"
#include "inference/subsets.h"

namespace photorque::inference {

// Properties of a candidate that the search uses.
struct CandidateTraits {
  // Candidates of one name are the same term in different parametrisations: it acts once.
  std::string name;
  // A smooth function without a law: it competes with the others, so that something unknown is not
  // mistaken for one of them, but it names nothing.
  bool is_empirical = false;
  // Whether a score test can predict the gain of its fit.
  bool is_linear = true;
  // Whether it changes faster than averages show.
  bool is_fast = false;
  // Whether it has strengths, in which it is linear.
  bool has_strength = true;
  size_t parameters = 0;
  // Whether it stands at a place of which one recording alone may leave several open.
  bool has_place = false;
  // Of candidates of one kind at different places (cells, lamps) the kind; empty: it has no place.
  std::string kind_of_place = {};
  // Whether readings bend with it so much that no forecast is made about a model without it: each
  // is fitted alone, from all its starts, before sets are forecast.
  bool is_fitted_first = false;
};

// Candidates, evidence and significance of a trial, without the fit.
struct Explanation {
  std::vector<size_t> candidates;  // in the order in which they were added; none: the nominal model
  // Natural logarithm of the evidence, with the prior odds of the candidates, but for a constant
  // that all trials on the same runs share.
  double log_evidence = 0.0;
  // Of each candidate: √(θᵀ C⁻¹ θ) of the parameters that are its size; not a number for one that
  // has none.
  std::vector<double> significance = {};
  std::vector<double> joint_significance = {};  // with the held-out data, where they were weighed
  std::string objection = {};                   // why it is forbidden; empty: nothing
  // Of its prediction of the held-out data, where it was requested.
  std::optional<double> holdout_chi2_per_sample = {};
  std::optional<Predictive> predictive = {};
  // How far its χ² lies above what the errors of the fitted parameters predict (held_out.h).
  std::optional<double> held_out_sigma = {};
};

// How patiently is fitted: the fractions of each run that are fitted in turn, and the iterations
// of each; a fit to whole runs may end where it will not come below `worth_chi2`, or fits badly and
// falls by less than the fraction `creep` in a step.
struct Effort {
  std::vector<double> windows = {1.0};
  int max_iterations = 25;
  double worth_chi2 = std::numeric_limits<double>::infinity();
  double creep = 0.0;
};

// A candidate with the start of its fit.
template <class Start>
struct Term {
  size_t candidate = 0;
  Start start;
};

// One of those that are to act together; `strengths`: where the fit of its strengths starts; empty:
// as the start says.
template <class Start>
struct Member {
  Term<Start> term;
  Eigen::VectorXd strengths = {};
};
template <class Start>
using Members = std::vector<Member<Start>>;

// A fit as the search sees it: χ² with the priors, the number of residuals, χ² of the data over it.
template <class F>
concept Fitted = requires(const F& fit) {
  { fit.chi2 } -> std::convertible_to<double>;
  { fit.samples } -> std::convertible_to<int64_t>;
  { fit.chi2_per_sample() } -> std::convertible_to<double>;
};

// A domain defines its trials, runs, starts and begins. A Start is the initial value of the fit of
// a candidate, with the gain (fall of χ²) that a scan predicts; infinite where nothing was scanned.
// A Begin contains the initial conditions of one run, which are nuisances. All functions are const
// and are called from several threads.
template <class D>
concept Domain = std::derived_from<typename D::Trial, Explanation> &&
    Fitted<decltype(D::Trial::fit)> &&
    requires(const D& domain, const typename D::Trial& trial, const typename D::Start& start,
             const std::vector<typename D::Run>& runs, const std::vector<size_t>& candidates,
             const std::vector<typename D::Begin>& begins, const Effort& effort, size_t count,
             const std::vector<Term<typename D::Start>>& terms,
             const Members<typename D::Start>& members, int threads) {
  { domain.candidates() } -> std::same_as<const std::vector<CandidateTraits>&>;
  { domain.limits() } -> std::same_as<const Thresholds&>;

  // Where a fit of the candidate starts if nothing is scanned.
  { domain.start_of(count) } -> std::same_as<typename D::Start>;
  // A candidate more, fitted; `count` is its index.
  { domain.extend(trial, count, start, runs, effort) } -> std::same_as<typename D::Trial>;
  // Refits the trial to other or more runs, each from its initial conditions.
  { domain.refit(trial, runs, begins, effort) } -> std::same_as<typename D::Trial>;
  // Refits the trial from the end of another trial on the same runs, in all parameters that both
  // have.
  { domain.refit_near(trial, trial, runs, effort) } -> std::same_as<typename D::Trial>;
  // The trial's prediction of runs that it never saw: only nuisances are fitted.
  { domain.predict(trial, runs) } -> std::same_as<typename D::Trial>;
  { domain.begins_of(trial) } -> std::same_as<std::vector<typename D::Begin>>;
  // Initial conditions from the first readings of each run.
  { domain.seen_begins(trial, runs) } -> std::same_as<std::vector<typename D::Begin>>;
  // The trial with these initial conditions for its next fit.
  { domain.with_begins(trial, begins) } -> std::same_as<typename D::Trial>;

  // The fall of χ² that each candidate would bring (0 for those that are not linear).
  { domain.gains(trial, candidates, runs) } -> std::same_as<std::vector<double>>;
  // The trial's own candidates as they were fitted, in their order.
  { domain.terms_of(trial) } -> std::same_as<std::vector<Term<typename D::Start>>>;
  // The strengths of terms about a trial, everything else that is fitted projected out. The first
  // of `terms` are the trial's own; those that averages do not show make no group.
  { domain.linear_problem(trial, terms, runs) } -> std::same_as<LinearProblem>;
  // The nominal model with these members alone, fitted from where the trial ended.
  { domain.assemble(trial, members, runs, effort) } -> std::same_as<typename D::Trial>;
  // Starts of each candidate added to the trial: one, or the best of a scan over its nonlinear
  // parameters. The second runs are averages of the first.
  {
    domain.starts(trial, candidates, runs, runs, threads)
    } -> std::same_as<std::vector<std::vector<typename D::Start>>>;

  // The runs averaged about the trial's prediction into about so many samples each.
  { domain.average(trial, runs, count) } -> std::same_as<std::vector<typename D::Run>>;
  // Each run in so many pieces; without those that hold too little to be fitted.
  { domain.cut(runs, count) } -> std::same_as<std::vector<typename D::Run>>;
  // Structure that the trial leaves (whiteness.h) [sigma].
  { domain.excess_sigma(trial, runs) } -> std::convertible_to<double>;
};

// Indices of trials on the same runs, the largest evidence first.
template <std::derived_from<Explanation> T>
std::vector<size_t> by_evidence(const std::vector<T>& trials) {
  std::vector<size_t> order(trials.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return trials[a].log_evidence > trials[b].log_evidence;
  });
  return order;
}

// Whether two sets of candidates are equal, in any order.
inline bool same_candidates(const std::vector<size_t>& a, const std::vector<size_t>& b) {
  return a.size() == b.size() && std::is_permutation(a.begin(), a.end(), b.begin());
}

// Whether one of these stands at a place.
inline bool has_place(const std::vector<size_t>& among, const std::vector<CandidateTraits>& all) {
  return std::any_of(among.begin(), among.end(), [&](size_t c) { return all[c].has_place; });
}

// Whether one of `among` is the same term as `candidate`.
inline bool acts_already(const std::vector<size_t>& among, size_t candidate,
                         const std::vector<CandidateTraits>& all) {
  return std::any_of(among.begin(), among.end(),
                     [&](size_t other) { return all[other].name == all[candidate].name; });
}

// Whether the derivatives of a trial are useless, because its prediction has diverged.
template <class Trial>
bool has_diverged(const Trial& trial, const Thresholds& limits) {
  return trial.fit.chi2_per_sample() > limits.diverged_chi2_per_sample;
}

}  // namespace photorque::inference
