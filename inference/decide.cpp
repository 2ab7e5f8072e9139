#include "inference/decide.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

namespace photorque::inference {
namespace {

class Judge {
 public:
  Judge(const std::vector<Explanation>& trials, const std::vector<CandidateTraits>& all,
        const Checks& checks, const Thresholds::Decision& limits)
      : trials_(trials), all_(all), checks_(checks), limits_(limits) {}

  Decision decide() const {
    std::vector<std::optional<double>> gains;
    std::set<std::string> unneeded;
    const size_t empirical = best(true);
    // Gates (b) and (c) of decide.h.
    const size_t named = needed_by_segments(pruned(best(false)), gains, unneeded);
    Decision d;
    d.probability = posterior(named);
    d.best_named = d.chosen = named;
    // Gate (d).
    const bool only_empirical = empirical != 0 && is_missed(named, empirical);
    const bool leaves_structure = checks_.excess_sigma(named) > limits_.max_excess_sigma;
    const bool is_predictive = predicts(named);
    if (only_empirical || leaves_structure || !is_predictive) {
      d.verdict = Verdict::unexplained;
      d.because = only_empirical     ? "a smooth law without physics explains the recording better"
                  : leaves_structure ? "the best known physics leaves structure in the recording"
                                     : "the best known physics does not predict the held-out data";
      d.leaves_more = true;
      if (only_empirical) choose_empirical(empirical, d);
      d.confidence = probability_of(d, [&](size_t i) { return is_empirical(i); });
      if (leaves_structure || !is_predictive) {
        d.confidence = std::max(d.confidence, limits_.structure_confidence);
      }
    } else if (named == 0) {
      judge_nothing(unneeded, d);
    } else {
      choose_names(std::move(gains), d);
    }
    return d;
  }

 private:
  // Chooses the empirical trial, and the effect that is certain beside its law.
  void choose_empirical(size_t empirical, Decision& d) const {
    d.chosen = empirical;
    d.leaves_more = !predicts(empirical) ||
                    !lowers_held_out(empirical, limits_.max_held_out_fraction) ||
                    !(checks_.excess_sigma(empirical) < limits_.max_excess_sigma);
    if (!d.leaves_more) d.beside_law = indispensable(empirical);
    // The empirical law is an approximation. Several effects beside it may merely absorb its
    // residual.
    if (d.beside_law.size() > 1) d.beside_law.clear();
    std::erase_if(d.beside_law,
                  [&](size_t c) { return !is_clear(trials_[empirical], c, limits_); });
  }

  // No name passes. Rivals of the nominal model are explanations that are more likely and in which
  // every name improves the prediction. The number of unlikely explanations therefore has no
  // influence.
  void judge_nothing(const std::set<std::string>& unneeded, Decision& d) const {
    const double rivals = probability_of(d, [&](size_t i) {
      const bool predicts_nothing =
          std::ranges::any_of(unneeded, [&](const std::string& name) { return has_name(i, name); });
      return d.probability[i] > d.probability.front() && !predicts_nothing;
    });
    const double nothing = d.probability.front() + rivals;
    d.confidence = nothing > 0.0 ? d.probability.front() / nothing : 1.0;
    if (d.confidence >= limits_.min_probability_of_nothing) return;
    d.verdict = Verdict::unexplained;
    d.because = "no explanation of the misfit predicts the held-out data";
    d.leaves_more = true;
    d.confidence = 1.0 - d.confidence;
  }

  // Gate (a). Trials that contain the same names, in any parametrisation, count together.
  void choose_names(std::vector<std::optional<double>> gains, Decision& d) const {
    const size_t named = d.best_named;
    const auto probability_of_all = [&](size_t trial) {
      return probability_of(d, [&](size_t i) { return has_names_of(trial, i); });
    };
    const auto is_probable = [&](size_t c) {
      return probability_of(d, [&](size_t i) { return has_name(i, all_[c].name); }) >=
             limits_.min_probability;
    };
    d.confidence = probability_of_all(named);
    const double of_group = probability_of(
        d, [&](size_t i) { return has_names_of(named, i) || exchanges_one(named, i); });
    // Weak: not probable enough, and not significant in the fitted recordings alone.
    const bool is_weak = d.confidence < limits_.min_probability &&
                         !inference::is_significant(trials_[named].significance, limits_);
    d.undecided = is_weak && predicts(0);
    if (d.undecided) {
      d.chosen = 0;
      d.confidence = 1.0 - d.confidence;
      return;
    }
    if (is_weak || of_group < limits_.min_probability) {
      // Another effect acts in addition to the probable names, but several effects are about
      // equally likely. If the probable names alone explain the recordings, they are named.
      d.chosen = part_of(named, is_probable);
      if (d.chosen == 0 || !predicts(d.chosen) ||
          checks_.excess_sigma(d.chosen) > limits_.max_excess_sigma) {
        d.verdict = Verdict::unexplained;
        d.because = "several explanations are about as likely";
        d.chosen = named;
        d.confidence = 1.0 - d.confidence;
        for (const size_t c : trials_[named].candidates) {
          if (!is_weak && is_probable(c)) d.beside_law.push_back(c);
        }
        return;
      }
      gains.clear();
      d.confidence = probability_of_all(d.chosen);
    }
    d.verdict = Verdict::missing_physics;
    add_names(gains, d);
  }

  // Gates (e) and (f). `gains`: one per name, or none.
  void add_names(const std::vector<std::optional<double>>& gains, Decision& d) const {
    d.held_out_tests_names = lowers_held_out(d.chosen, checks_.limits.max_untested_fraction);
    for (size_t which = 0; which < trials_[d.chosen].candidates.size(); ++which) {
      Name name{trials_[d.chosen].candidates[which]};
      name.probability = probability_of(d, [&](size_t i) {
        return has_name(i, all_[name.candidate].name) || exchanges(d.chosen, which, i);
      });
      if (which < gains.size()) name.gain_sigma = gains[which];
      name.equal_places = equal_places(d.chosen, which);
      d.names.push_back(std::move(name));
    }
  }

  // Posterior probability of each trial. It is 0 for unphysical trials, for trials with a candidate
  // that does not differ significantly from zero, and for empirical laws that predict the held-out
  // data worse than the best known physics.
  std::vector<double> posterior(size_t named) const {
    const auto counts = [&](size_t i) {
      return trials_[i].objection.empty() && is_significant(i) &&
             (named == 0 || !is_empirical(i) || predicts_as_well(named, i));
    };
    double best = -1e300;
    for (size_t i = 0; i < trials_.size(); ++i) {
      if (counts(i)) best = std::max(best, trials_[i].log_evidence);
    }
    std::vector<double> p;
    double sum = 0.0;
    for (size_t i = 0; i < trials_.size(); ++i) {
      p.push_back(counts(i) ? std::exp(trials_[i].log_evidence - best) : 0.0);
      sum += p.back();
    }
    for (double& x : p) x /= sum;
    return p;
  }

  // Total probability of the trials for which `counts` is true.
  static double probability_of(const Decision& d, const std::function<bool(size_t)>& counts) {
    double sum = 0.0;
    for (size_t i = 0; i < d.probability.size(); ++i) {
      if (counts(i)) sum += d.probability[i];
    }
    return std::min(1.0, sum);  // rounding can exceed 1
  }

  bool is_empirical(size_t trial) const { return has_empirical(trials_[trial].candidates, all_); }

  bool is_significant(size_t trial) const {
    return inference::is_significant(trials_[trial], limits_) &&
           !(is_combination(trial) && has_clear_rival(trial));
  }

  // The trial of largest evidence whose log odds against the nominal model reach the limit; 0 if
  // none.
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

  // Removes candidates from the trial one at a time, as long as one of them is not needed
  // (is_missed()) or the remaining trial contains one that is not significant.
  size_t pruned(size_t trial) const {
    while (trial != 0) {
      size_t fewer = trial;
      for (size_t i = 0; i < trials_.size(); ++i) {
        if (!is_part(i, trial) || !trials_[i].objection.empty()) continue;
        if (is_missed(i, trial) && is_significant(trial)) continue;
        if (fewer == trial || trials_[i].log_evidence > trials_[fewer].log_evidence) fewer = i;
      }
      if (fewer == trial) return is_significant(trial) ? trial : 0;
      trial = fewer;
    }
    return trial;
  }

  // Removes candidates that do not improve the prediction of left-out segments; `unneeded` receives
  // their names, `gains` the gains of the others [sigma].
  size_t needed_by_segments(size_t trial, std::vector<std::optional<double>>& gains,
                            std::set<std::string>& unneeded) const {
    gains.clear();
    if (!checks_.gain_sigma) return trial;
    for (size_t which = 0; which < trials_[trial].candidates.size(); ++which) {
      const std::optional<double> gain = checks_.gain_sigma(trial, which);
      if (gain && *gain < checks_.limits.min_gain_sigma) {
        unneeded.insert(all_[trials_[trial].candidates[which]].name);
        return needed_by_segments(without(trial, which), gains, unneeded);
      }
      gains.push_back(gain);
    }
    return trial;
  }

  // Whether the held-out χ² of a trial is below this fraction of that of the nominal model; true
  // where it is not known.
  bool lowers_held_out(size_t trial, double fraction) const {
    const auto &before = trials_.front().holdout_chi2_per_sample,
               &after = trials_[trial].holdout_chi2_per_sample;
    return !before || !after || *after < fraction * *before;
  }

  // Candidates at other places that explain as much as the one at `which`.
  std::vector<size_t> equal_places(size_t trial, size_t which) const {
    std::vector<size_t> equal;
    if (!checks_.other_places) return equal;
    for (const auto& [candidate, behind] : checks_.other_places(trial, which)) {
      if (behind < checks_.limits.min_log_odds_of_place) equal.push_back(candidate);
    }
    return equal;
  }

  // The best trial with exactly those names of the trial for which `counts` is true, if it is
  // significant; 0 if there is none.
  size_t part_of(size_t trial, const std::function<bool(size_t)>& counts) const {
    std::multiset<std::string> names;
    for (const size_t c : trials_[trial].candidates) {
      if (counts(c)) names.insert(all_[c].name);
    }
    return names.empty() ? 0 : best_with(names);
  }

  // Whether the trial predicts the held-out data. If the nominal model has been tested on them, an
  // untested trial does not pass.
  bool predicts(size_t trial) const {
    const std::optional<Predictive>& p = trials_[trial].predictive;
    if (!p) return !trials_.front().predictive;
    const bool is_off = trials_[trial].held_out_sigma.value_or(0.0) > limits_.max_predictive_sigma;
    return p->sigma < limits_.max_predictive_sigma && !is_off;
  }

  // Candidates whose name occurs in every explanation of comparable evidence.
  std::vector<size_t> indispensable(size_t trial) const {
    std::vector<size_t> result;
    for (const size_t c : trials_[trial].candidates) {
      const auto lacks = [&](const Explanation& t) {
        return std::none_of(t.candidates.begin(), t.candidates.end(),
                            [&](size_t other) { return all_[other].name == all_[c].name; });
      };
      const auto is_rival = [&](const Explanation& t) {
        return t.objection.empty() && lacks(t) &&
               t.log_evidence > trials_[trial].log_evidence - limits_.min_log_odds_beside_law;
      };
      if (!all_[c].is_empirical && std::none_of(trials_.begin(), trials_.end(), is_rival)) {
        result.push_back(c);
      }
    }
    return result;
  }

  bool has_names_of(size_t part, size_t whole) const {
    const auto some = names_of(part), all = names_of(whole);
    return std::includes(all.begin(), all.end(), some.begin(), some.end());
  }

  bool has_name(size_t trial, const std::string& name) const {
    return names_of(trial).count(name) > 0;
  }

  // Whether `other` has all names of `trial` but one, and another known effect in its place.
  bool exchanges_one(size_t trial, size_t other) const {
    const auto ours = names_of(trial), theirs = names_of(other);
    std::vector<std::string> shared;
    std::set_intersection(ours.begin(), ours.end(), theirs.begin(), theirs.end(),
                          std::back_inserter(shared));
    return ours.size() == theirs.size() && shared.size() + 1 == ours.size() && !is_empirical(other);
  }

  // Whether `other` has all names of `trial` but replaces the one at `which` by another known
  // effect.
  bool exchanges(size_t trial, size_t which, size_t other) const {
    return exchanges_one(trial, other) &&
           !has_name(other, all_[trials_[trial].candidates[which]].name);
  }

  std::multiset<std::string> names_of(size_t trial) const {
    std::multiset<std::string> names;
    for (const size_t c : trials_[trial].candidates) names.insert(all_[c].name);
    return names;
  }

  // The best trial with the same names except the one at `which`; the nominal model if there is
  // none.
  size_t without(size_t trial, size_t which) const {
    std::multiset<std::string> rest = names_of(trial);
    rest.erase(rest.find(all_[trials_[trial].candidates[which]].name));
    return best_with(rest);
  }

  // The significant trial of largest evidence with exactly these names; 0 if there is none.
  size_t best_with(const std::multiset<std::string>& names) const {
    size_t best = 0;
    for (size_t i = 1; i < trials_.size(); ++i) {
      if (names_of(i) != names || !trials_[i].objection.empty() || !is_significant(i)) continue;
      if (best == 0 || trials_[i].log_evidence > trials_[best].log_evidence) best = i;
    }
    return best;
  }

  // Whether `part` has all names of `whole` but one.
  bool is_part(size_t part, size_t whole) const {
    const auto fewer = names_of(part), all = names_of(whole);
    return fewer.size() + 1 == all.size() &&
           std::includes(all.begin(), all.end(), fewer.begin(), fewer.end());
  }

  // Whether `other` beats `trial` by the full threshold and does not predict the held-out data
  // worse.
  bool is_missed(size_t trial, size_t other) const {
    return trials_[other].log_evidence >= trials_[trial].log_evidence + limits_.min_log_odds &&
           predicts_as_well(trial, other);
  }

  // Whether `other` does not predict the held-out data worse than `trial`.
  bool predicts_as_well(size_t trial, size_t other) const {
    const Explanation &a = trials_[trial], &b = trials_[other];
    const auto &before = a.holdout_chi2_per_sample, &after = b.holdout_chi2_per_sample;
    if (!a.predictive || !b.predictive) {
      return !before || !after || *after <= limits_.max_held_out_growth * std::max(1.0, *before);
    }
    // Errors of the parameters also raise the held-out χ², so growth below its expected value does
    // not reject a name. Growth also rejects no name if only the fit with the name agrees with all
    // data together.
    const double expected = b.predictive->expected_chi2_per_sample;
    const bool grows = before && after &&
                       *after > limits_.max_held_out_growth * std::max({1.0, *before, expected});
    const bool fits_alone = b.predictive->sigma < limits_.max_predictive_sigma &&
                            a.predictive->sigma > limits_.max_predictive_sigma;
    if (grows && !fits_alone) return false;
    return b.predictive->log_score > a.predictive->log_score - limits_.max_predictive_loss;
  }

  // Whether all numbers of some name are within their errors, so that only a combination is
  // identifiable.
  bool is_combination(size_t trial) const {
    return !is_empirical(trial) &&
           std::ranges::any_of(trials_[trial].largest_component,
                               [&](double sigma) { return sigma < limits_.min_component_sigma; });
  }

  // Whether an explanation that lacks one of the names, and has no such combination, is nearly as
  // good.
  bool has_clear_rival(size_t trial) const {
    const double least = trials_[trial].log_evidence - limits_.min_log_odds_of_combination;
    for (size_t i = 0; i < trials_.size(); ++i) {
      const Explanation& t = trials_[i];
      if (!(t.log_evidence > least) || !t.objection.empty() || is_empirical(i)) continue;
      if (is_combination(i) || has_names_of(trial, i)) continue;
      if (inference::is_significant(t, limits_)) return true;
    }
    return false;
  }

  const std::vector<Explanation>& trials_;
  const std::vector<CandidateTraits>& all_;
  const Checks& checks_;
  const Thresholds::Decision& limits_;
};

}  // namespace

bool is_significant(const std::vector<double>& significance, const Thresholds::Decision& limits) {
  return std::ranges::none_of(significance,
                              [&](double sigma) { return sigma < limits.min_significance; });
}

bool is_significant(const Explanation& trial, const Thresholds::Decision& limits) {
  return is_significant(
      trial.joint_significance.empty() ? trial.significance : trial.joint_significance, limits);
}

bool is_clear(const Explanation& trial, size_t candidate, const Thresholds::Decision& limits) {
  const auto at = std::ranges::find(trial.candidates, candidate) - trial.candidates.begin();
  const auto i = static_cast<size_t>(at);
  if (i == trial.candidates.size()) return false;
  const bool is_combination =
      !trial.largest_component.empty() && trial.largest_component[i] < limits.min_component_sigma;
  return is_significant({trial.significance[i]}, limits) && !is_combination;
}

Decision decide(const std::vector<Explanation>& trials, const std::vector<CandidateTraits>& all,
                const Checks& checks, const Thresholds::Decision& limits) {
  return Judge(trials, all, checks, limits).decide();
}

}  // namespace photorque::inference
