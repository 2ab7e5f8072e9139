#include "inference/decide.h"

#include <cmath>
#include <set>

namespace photorque::inference {
namespace {

class Judge {
 public:
  Judge(const std::vector<Explanation>& trials, const std::vector<CandidateTraits>& all,
        const Thresholds::Decision& limits)
      : trials_(trials), all_(all), limits_(limits) {}

  bool is_empirical(size_t trial) const {
    const std::vector<size_t>& candidates = trials_[trial].candidates;
    return std::any_of(candidates.begin(), candidates.end(),
                       [&](size_t c) { return all_[c].is_empirical; });
  }

  // Every candidate that has a size differs from nothing.
  bool is_significant(size_t trial, const std::vector<double>& significance) const {
    const std::vector<size_t>& candidates = trials_[trial].candidates;
    for (size_t i = 0; i < candidates.size(); ++i) {
      if (!all_[candidates[i]].has_strength) continue;
      if (significance[i] < limits_.min_significance) return false;
    }
    return true;
  }

  // By what was held out as well, where that was weighed.
  bool is_significant(size_t trial) const {
    const Explanation& t = trials_[trial];
    return is_significant(trial,
                          t.joint_significance.empty() ? t.significance : t.joint_significance);
  }

  // The best trial that beats the nominal model beyond doubt; 0 if there is none.
  size_t best(bool empirical) const {
    size_t best = 0;
    for (size_t i = 1; i < trials_.size(); ++i) {
      const Explanation& t = trials_[i];
      if (!t.objection.empty()) continue;
      if (t.log_evidence < trials_.front().log_evidence + limits_.min_log_odds) continue;
      if (!is_significant(i) || is_empirical(i) != empirical) continue;
      if (best == 0 || t.log_evidence > trials_[best].log_evidence) best = i;
    }
    return best;
  }

  std::multiset<std::string> names_of(size_t trial) const {
    std::multiset<std::string> names;
    for (const size_t c : trials_[trial].candidates) names.insert(all_[c].name);
    return names;
  }

 private:
  const std::vector<Explanation>& trials_;
  const std::vector<CandidateTraits>& all_;
  const Thresholds::Decision& limits_;
};

// Probability of each trial, those that are forbidden aside.
std::vector<double> posterior(const std::vector<Explanation>& trials) {
  double best = -1e300;
  for (const Explanation& t : trials) {
    if (t.objection.empty()) best = std::max(best, t.log_evidence);
  }
  std::vector<double> p;
  double sum = 0.0;
  for (const Explanation& t : trials) {
    p.push_back(t.objection.empty() ? std::exp(t.log_evidence - best) : 0.0);
    sum += p.back();
  }
  for (double& x : p) x /= sum;
  return p;
}

// Of all trials for which `counts` is true, together.
double probability_of(const std::vector<double>& probability,
                      const std::function<bool(size_t)>& counts) {
  double sum = 0.0;
  for (size_t i = 0; i < probability.size(); ++i) {
    if (counts(i)) sum += probability[i];
  }
  return sum;
}

}  // namespace

Decision decide(const std::vector<Explanation>& trials, const std::vector<CandidateTraits>& all,
                const std::function<double(size_t trial)>& excess_sigma,
                const Thresholds::Decision& limits) {
  const Judge judge(trials, all, limits);
  const size_t named = judge.best(false), empirical = judge.best(true);
  Decision d;
  d.probability = posterior(trials);
  d.best_named = named;
  const bool only_empirical =
      empirical != 0 &&
      trials[empirical].log_evidence > trials[named].log_evidence + limits.min_log_odds;
  const bool structure_left = excess_sigma(named) > limits.max_excess_sigma;
  if (only_empirical || structure_left) {
    d.finding = Finding::unknown;
    d.chosen = only_empirical ? empirical : named;
    d.confidence = probability_of(d.probability, [&](size_t i) { return judge.is_empirical(i); });
    if (structure_left) d.confidence = std::max(d.confidence, limits.structure_confidence);
    return d;
  }
  if (named == 0) {
    d.confidence = d.probability.front();
    return d;
  }
  // The same names with another parametrisation are the same answer.
  const auto names = judge.names_of(named);
  d.confidence =
      probability_of(d.probability, [&](size_t i) { return judge.names_of(i) == names; });
  d.undecided = d.confidence < limits.min_confidence_of_weak_name &&
                !judge.is_significant(named, trials[named].significance);
  if (d.undecided) {
    d.confidence = 1.0 - d.confidence;
  } else {
    d.finding = Finding::named;
    d.chosen = named;
  }
  return d;
}

}  // namespace photorque::inference
