#include "diagnosis/attitude/decide.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "diagnosis/attitude/whiteness.h"

namespace photorque {
namespace {

bool has_empirical(const Trial& t, const Candidates& all) {
  return std::any_of(t.candidates.begin(), t.candidates.end(),
                     [&](size_t c) { return all[c].empirical(); });
}

bool is_significant(const Trial& t, const Candidates& all,
                    const std::vector<double>& significance) {
  for (size_t i = 0; i < t.candidates.size(); ++i) {
    const Candidate& c = all[t.candidates[i]];
    // Without a strength that enters linearly its size is no number of standard deviations.
    if (!c.has_linear_strength()) continue;
    if (significance[i] < all.limits.decision.min_significance) return false;
  }
  return true;
}

bool is_significant(const Trial& t, const Candidates& all) {
  return is_significant(t, all,
                        t.joint_significance.empty() ? t.significance : t.joint_significance);
}

std::multiset<std::string> names_of(const Trial& t, const Candidates& all) {
  std::multiset<std::string> names;
  for (const size_t c : t.candidates) names.insert(all[c].label);
  return names;
}

std::vector<double> posterior(const std::vector<Trial>& trials) {
  double best = -1e300;
  for (const Trial& t : trials) {
    if (t.objection.empty()) best = std::max(best, t.log_evidence);
  }
  std::vector<double> p;
  double sum = 0.0;
  for (const Trial& t : trials) {
    p.push_back(t.objection.empty() ? std::exp(t.log_evidence - best) : 0.0);
    sum += p.back();
  }
  for (double& x : p) x /= sum;
  return p;
}

}  // namespace

Decision decide(const std::vector<Trial>& trials, const Candidates& all,
                const std::vector<Observation>& runs) {
  const Thresholds::Decision& limits = all.limits.decision;
  Decision d;
  d.probability = posterior(trials);
  const double none = trials.front().log_evidence;
  size_t physics = 0, empirical = 0;
  for (size_t i = 1; i < trials.size(); ++i) {
    const Trial& t = trials[i];
    if (!t.objection.empty() || t.log_evidence < none + limits.min_log_odds) continue;
    if (!is_significant(t, all)) continue;
    size_t& best = has_empirical(t, all) ? empirical : physics;
    if (best == 0 || t.log_evidence > trials[best].log_evidence) best = i;
  }
  d.physics = physics;
  const double physics_evidence = physics == 0 ? none : trials[physics].log_evidence;
  const bool law_unknown =
      empirical != 0 && trials[empirical].log_evidence > physics_evidence + limits.min_log_odds;
  const bool structure_left =
      excess_sigma(trials[physics].fit, runs, all.limits.noise) > limits.max_excess_sigma;
  if (law_unknown || structure_left) {
    d.verdict = Verdict::unexplained;
    d.chosen = law_unknown ? empirical : physics;
    for (size_t i = 0; i < trials.size(); ++i) {
      if (has_empirical(trials[i], all)) d.confidence += d.probability[i];
    }
    if (structure_left) d.confidence = std::max(d.confidence, limits.structure_confidence);
  } else if (physics != 0) {
    // The same names with another parametrisation are the same answer.
    const auto names = names_of(trials[physics], all);
    for (size_t i = 0; i < trials.size(); ++i) {
      if (names_of(trials[i], all) == names) d.confidence += d.probability[i];
    }
    d.undecided = d.confidence < limits.min_fraction_of_weak_evidence &&
                  !is_significant(trials[physics], all, trials[physics].significance);
    d.verdict = d.undecided ? Verdict::consistent : Verdict::missing_physics;
    d.chosen = d.undecided ? 0 : physics;
    if (d.undecided) d.confidence = 1.0 - d.confidence;
  } else {
    d.verdict = Verdict::consistent;
    d.confidence = d.probability.front();
  }
  return d;
}

}  // namespace photorque
