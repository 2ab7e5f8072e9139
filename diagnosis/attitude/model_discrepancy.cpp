#include "diagnosis/attitude/answer.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "attitude/estimation/fit.h"
#include "attitude/estimation/swing.h"
#include "attitude/observation/noise_levels.h"
#include "attitude/propagation/run.h"
#include "core/text/format.h"

namespace photorque {
namespace {

// Treats the residual of a fit to the train runs as noise. Its level is estimated separately in
// each of `parts` parts of a run; 0: one level for all runs.
void use_rest(const Fit& fit, const NoiseLevels& own, Remainder remainder, size_t parts,
              RecordedData& data) {
  const std::vector<Prediction> residuals = residuals_of(fit, data.train);
  set_noise(with_discrepancy(residuals, data.train, own, remainder), data);
  if (parts > 0) set_profiles(residuals, parts, data.train);
}

// Number of segments, limited to one to three times `limits.segments`: the number of independent
// residuals of the best explanation, n (1 − ρ)/(1 + ρ) for n readings with neighbour correlation ρ.
// With few segments, a difference that varies between them is not significant.
size_t segment_count(const Answer& answer, const RecordedData& data, const NoiseLevels& own) {
  constexpr double most = 3.0;
  const auto fewest = static_cast<double>(answer.all.limits.discrepancy.segments);
  const Trial* best = &answer.trials.front();
  for (const Trial& t : answer.trials) {
    if (t.objection.empty() && t.fit.chi2 < best->fit.chi2) best = &t;
  }
  const NoiseLevels left =
      with_discrepancy(residuals_of(best->fit, data.train), data.train, own, Remainder::correlated);
  double independent = most * fewest;
  for (int channel = 0; channel < channel_count; ++channel) {
    double readings = 0.0;
    for (const Observation& seen : data.train) {
      for (size_t i = 0; i < seen.blocks(); ++i) readings += seen.rows_of(i, channel) > 0.0;
    }
    const double shared = left.of(channel).coloured;
    if (!(readings > 0.0) || !(left.of(channel).level > own.of(channel).level)) continue;
    independent = std::min(independent, readings * (1.0 - shared) / (1.0 + shared));
  }
  return static_cast<size_t>(std::max(fewest, independent));
}

// An explanation with the χ² of predicted segments, and of the held-out data from a fit to the
// train recordings alone.
struct Contender {
  Trial trial;
  std::vector<double> chi2;
  double held_chi2 = inference::infinity;
  double held_samples = 0.0;
};

// The most likely allowed explanations of a search and the best predictors of the held-out data,
// including the nominal model.
std::vector<size_t> likely_of(const Answer& answer) {
  const Thresholds::Discrepancy& limits = answer.all.limits.discrepancy;
  std::vector<size_t> order = inference::by_evidence(answer.trials);
  std::erase_if(order, [&](size_t i) {
    return !answer.trials[i].objection.empty() || !std::isfinite(answer.trials[i].fit.chi2);
  });
  std::vector<size_t> by_held = order;
  std::erase_if(by_held,
                [&](size_t i) { return !answer.trials[i].holdout_chi2_per_sample.has_value(); });
  std::ranges::stable_sort(by_held, {},
                           [&](size_t i) { return *answer.trials[i].holdout_chi2_per_sample; });
  order.resize(std::min(order.size(), limits.max_probable));
  by_held.resize(std::min(by_held.size(), limits.max_predicting));
  for (const size_t i : by_held) {
    if (std::ranges::find(order, i) == order.end()) order.push_back(i);
  }
  if (std::ranges::find(order, 0U) == order.end()) order.push_back(0);
  return order;
}

// Compares some explanations (`which`) by their predictions of segments.
class Contest {
 public:
  Contest(const Answer& answer, const std::vector<size_t>& which, const RecordedData& data,
          size_t segments, int threads)
      : answer_(answer),
        limits_(answer.all.limits.discrepancy),
        train_(data.train),
        held_(data.held),
        segments_(answer.all, data.train, data.held, segments, threads) {
    for (const size_t i : which) contenders_.push_back(contender(answer_.trials[i]));
  }

  size_t segments() const { return segments_.count(); }

  // The best predictor, or a simpler explanation that is indistinguishable from it, without names
  // that no segment requires.
  Contender winner() {
    const Contender* best = &contenders_.front();
    for (const Contender& other : contenders_) {
      const double gain = inference::gain_sigma(best->chi2, other.chi2);
      if (gain > (halves_held_out(*best, other) ? 0.0 : limits_.min_rival_sigma)) best = &other;
    }
    const Contender won = pruned(*best);
    const Contender& simplest = simplest_like(won);
    return &simplest == &won ? won : pruned(simplest);
  }

  // The trial without names that no segment requires.
  Trial needed_of(const Trial& trial) { return pruned(contender(trial)).trial; }

  // Gain in prediction by each name of the winner, compared with its absence [standard errors].
  const std::vector<double>& sigma() const { return sigma_; }

  // The winner without one name and without names that are then superfluous.
  Contender without(const Contender& best, size_t which) {
    return pruned(contender(trial_without(best.trial, which)));
  }

  // Names that replace the `which`-th of `best` in indistinguishable explanations.
  std::vector<std::string> rivals(const Contender& best, size_t which) const {
    std::set<std::string> names;
    for (const Contender& other : contenders_) {
      std::vector<size_t> theirs = other.trial.candidates;
      for (size_t i = 0; i < best.trial.candidates.size(); ++i) {
        if (i != which) std::erase(theirs, best.trial.candidates[i]);
      }
      const bool is_exchanged = other.trial.candidates.size() == best.trial.candidates.size() &&
                                theirs.size() == 1 && theirs[0] != best.trial.candidates[which];
      if (is_exchanged && is_as_good(other, best)) {
        names.insert(answer_.all[theirs[0]].name);
      }
    }
    return {names.begin(), names.end()};
  }

  // The sets of names that predict the segments as well as those of `best` but lack one of them.
  std::vector<std::string> tied(const Contender& best) const {
    std::set<std::string> sets;
    for (const Contender& other : contenders_) {
      std::vector<size_t> theirs = other.trial.candidates, ours = best.trial.candidates;
      std::ranges::sort(theirs);
      std::ranges::sort(ours);
      if (std::ranges::includes(theirs, ours) || !is_as_good(other, best)) continue;
      if (theirs.empty()) continue;
      sets.insert(joined_text(theirs, " + ", [&](size_t c) { return answer_.all[c].name; }));
    }
    return {sets.begin(), sets.end()};
  }

 private:
  Contender contender(const Trial& trial) const {
    const Trial held = answer_.all.predict(trial, held_);
    const double chi2 = std::isnan(held.fit.chi2) ? inference::infinity : held.fit.chi2;
    return {trial, segments_.chi2(trial), chi2, static_cast<double>(held.fit.samples)};
  }

  // Whether `with` leaves less than half of the held-out χ² of `without`.
  bool halves_held_out(const Contender& without, const Contender& with) const {
    return with.held_chi2 < answer_.all.limits.decision.max_held_out_fraction * without.held_chi2;
  }

  bool halves_segments(const Contender& without, const Contender& with) const {
    const auto sum = [](const Contender& c) {
      return std::accumulate(c.chi2.begin(), c.chi2.end(), 0.0);
    };
    return sum(with) < answer_.all.limits.decision.max_held_out_fraction * sum(without);
  }

  // Motion about three axes is flexible enough to fit anything. There a further name must halve the
  // residuals of the held-out data.
  bool improves_enough(const Contender& without, const Contender& with) const {
    const Platform& platform = answer_.trials.front().fit.best.model.platform;
    return platform.turns_about_one_axis() || platform.slides() ||
           without.trial.candidates.empty() || halves_held_out(without, with);
  }

  // Improvement of the prediction of segments by a name [standard errors]; 0 if the name worsens
  // the prediction of the held-out data. If the name halves the χ² of the held-out data or of all
  // segments together, the improvement is multiplied by 1.8, so 1.67 standard errors count as
  // three.
  double missed(const Contender& without, const Contender& with) const {
    constexpr double by_chance = 3.0, confirmed = 1.8;
    // A residual beyond the noise scatters in proportion to its size.
    const double excess = std::max(1.0, without.held_chi2 / without.held_samples),
                 scatter = excess * std::sqrt(2.0 * with.held_samples);
    if (with.held_chi2 > limits_.max_held_growth * without.held_chi2 + by_chance * scatter) {
      return 0.0;
    }
    return inference::gain_sigma(without.chi2, with.chi2) *
           (halves_held_out(without, with) || halves_segments(without, with) ? confirmed : 1.0);
  }

  // Whether `one` predicts the segments not significantly worse than `other` does.
  bool is_as_good(const Contender& one, const Contender& other) const {
    return inference::gain_sigma(one.chi2, other.chi2) < limits_.min_rival_sigma;
  }

  // Whether the trial has a drag with a non-integer power of the rate. Such a drag may imitate a
  // sum of two drags with integer powers.
  bool has_broken_power(const Trial& trial) const {
    return std::ranges::any_of(trial.candidates, [&](size_t c) {
      const auto power = braking_power(answer_.all[c], answer_.trials.front().fit.best.model);
      return power && std::abs(*power - std::round(*power)) > 0.25;
    });
  }

  // Whether `one` is preferred to `other` if both predict equally well. The criteria are, in this
  // order: no non-integer power of a drag, fewer names, the simpler of two kinds of one law
  // (simpler_by()), the larger evidence.
  bool is_simpler(const Contender& one, const Contender& other) const {
    const bool broken = has_broken_power(one.trial);
    if (broken != has_broken_power(other.trial)) return !broken;
    const size_t ours = one.trial.candidates.size(), theirs = other.trial.candidates.size();
    if (ours != theirs) return ours < theirs;
    return simpler_by(one.trial, other.trial, answer_)
               .value_or(one.trial.log_evidence - other.trial.log_evidence) > 0.0;
  }

  // The simplest contender that predicts as well as `won`, or `won`.
  const Contender& simplest_like(const Contender& won) const {
    const Contender* best = &won;
    for (const Contender& other : contenders_) {
      const bool is_alike = is_as_good(other, won) && !halves_held_out(other, won);
      if (!other.trial.candidates.empty() && is_alike && is_simpler(other, *best)) best = &other;
    }
    return *best;
  }

  // First removes names that the segments do not require, then names that add too little. The order
  // matters: of two names for one effect, each adds little to the other.
  Contender pruned(Contender best) {
    best = without_least(std::move(best), [&](const Contender& without, const Contender& with) {
      return missed(without, with);
    });
    return without_least(std::move(best), [&](const Contender& without, const Contender& with) {
      return improves_enough(without, with) ? missed(without, with) : 0.0;
    });
  }

  // Repeatedly removes the name of least `worth` while it is too small.
  template <class Worth>
  Contender without_least(Contender best, const Worth& worth) {
    while (!best.trial.candidates.empty()) {
      std::vector<Contender> fewer;
      sigma_.clear();
      for (size_t i = 0; i < best.trial.candidates.size(); ++i) {
        fewer.push_back(contender(trial_without(best.trial, i)));
        sigma_.push_back(worth(fewer.back(), best));
      }
      const auto least = std::ranges::min_element(sigma_);
      if (*least >= limits_.min_sigma) break;
      best = std::move(fewer[static_cast<size_t>(least - sigma_.begin())]);
    }
    return best;
  }

  Trial trial_without(const Trial& trial, size_t which) const {
    // Removing this candidate may move the other parameters far.
    const inference::Effort growing{.windows = answer_.all.limits.fitting.diverged_windows};
    return answer_.all.assemble(trial, inference::members_of(answer_.all.terms_of(trial), which),
                                train_, growing);
  }

  const Answer& answer_;
  const Thresholds::Discrepancy& limits_;
  const std::vector<Observation>&train_, &held_;
  CrossValidation segments_;
  std::vector<Contender> contenders_;
  std::vector<double> sigma_;
};

// Refits the trial with its correlated residual as noise. A smaller residual gives the readings
// more weight relative to the priors, so the refit is repeated while the held-out prediction
// improves.
Trial refit_with_discrepancy(const Trial& named, const Candidates& all, const NoiseLevels& own,
                             size_t parts, RecordedData data) {
  constexpr int most_rounds = 6;
  Trial result = named;
  const auto held_chi2 = [&](const Trial& t) {
    return propagate_model(t.fit, data.held, all.limits).chi2;
  };
  for (int round = 0; round < most_rounds; ++round) {
    use_rest(result.fit, own, Remainder::white, parts, data);
    const Trial again = all.refit(result, data.train, result.fit.best.runs);
    if (!std::isfinite(again.fit.chi2) || !again.objection.empty() ||
        !(held_chi2(again) < 0.9 * held_chi2(result))) {
      break;
    }
    result = again;
  }
  use_rest(result.fit, own, Remainder::correlated, parts, data);
  const Trial again = all.refit(result, data.train, result.fit.best.runs);
  return std::isfinite(again.fit.chi2) ? again : result;
}

// Replaces the chosen trial by the winner.
void choose(const Contender& won, const Contest& contest, Answer& a) {
  const auto equal = std::ranges::find_if(a.trials, [&](const Trial& t) {
    return inference::same_candidates(t.candidates, won.trial.candidates);
  });
  a.decision.chosen = static_cast<size_t>(equal - a.trials.begin());
  if (equal == a.trials.end()) {
    a.trials.push_back(won.trial);
    a.trials.back().log_evidence = a.trials.front().log_evidence;
    a.decision.probability.push_back(0.0);
  }
  Trial& chosen = a.trials[a.decision.chosen];
  const Trial weighed = chosen;
  chosen = won.trial;
  chosen.log_evidence = weighed.log_evidence;
  chosen.predictive = weighed.predictive;
  a.decision.best_named = a.decision.chosen;
  a.beside.emplace().segments = contest.segments();
  a.beside->sigma = contest.sigma();
  for (size_t i = 0; i < chosen.candidates.size(); ++i) {
    a.beside->rivals.push_back(contest.rivals(won, i));
  }
  a.beside->tied = contest.tied(won);
}

// Replaces a search: the nominal model and every set of friction and drag laws combined with the
// other laws of `found`, all fitted with the noise of `data`.
Answer sets_of_laws(const Fit& nominal_fit, const Trial& found, const RecordedData& data,
                    const DiagnoseOptions& options, const Candidates& all) {
  Answer a;
  a.all = all;
  const Trial stated = nominal_trial(nominal_fit, a.all);
  a.trials = fit_sets_of_brakes(stated, found, a.all, data, options.threads);
  a.trials.insert(a.trials.begin(), stated);
  for (Trial& t : a.trials) {
    t.holdout_chi2_per_sample = all.predict(t, data.held).fit.chi2_per_sample();
  }
  a.decision.probability.resize(a.trials.size());
  return a;
}

// Sets of friction and drag laws combined only with those other laws that the segments require.
// Otherwise all sets would contain laws that imitate friction and drag.
Answer sets_of_needed_laws(const Fit& nominal_fit, const Trial& laws, const RecordedData& data,
                           const NoiseLevels& own, const DiagnoseOptions& options,
                           const Candidates& all) {
  const Trial found = all.refit(laws, data.train, laws.fit.best.runs);
  const Answer full = sets_of_laws(nominal_fit, found, data, options, all);
  const auto best =
      std::ranges::min_element(full.trials, {}, [](const Trial& t) { return t.fit.chi2; });
  Contest contest(full, {}, data, segment_count(full, data, own), options.threads);
  return sets_of_laws(nominal_fit, contest.needed_of(*best), data, options, all);
}

// Sets the verdict and its probability, corrected for as many tests as there are candidates.
void decide_with_discrepancy(Answer& a) {
  a.rest_is_noise = true;
  a.depends_on.clear();  // computed for laws, which the names replace
  a.decision.verdict = Verdict::unexplained;
  a.decision.beside_law.clear();
  const double least = *std::ranges::min_element(a.beside->sigma);
  const double by_chance = 0.5 * std::erfc(least / std::sqrt(2.0));
  a.decision.confidence = std::max(0.0, 1.0 - static_cast<double>(a.all.size()) * by_chance);
  a.decision.because = "the residual exceeds the noise of the readings, and counts as noise";
}

}  // namespace

bool is_of_textbook(const Candidates& all) {
  return std::ranges::none_of(all.list, [](const Candidate& c) {
    const Requirement needs = c.effect.how.needs;
    const bool is_special = c.effect.how.of_experiment != nullptr && needs != Requirement::bearing;
    return needs == Requirement::command || needs == Requirement::charge ||
           needs == Requirement::field || needs == Requirement::wheel ||
           needs == Requirement::lamps || is_special;
  });
}

Among among_with_discrepancy(const NominalModel& nominal, const RecordedData& data) {
  if (!nominal.model.platform.turns_about_one_axis()) return Among::torques;
  const Vec3& axis = nominal.model.platform.axis;
  const auto in_all_runs = [&](const auto& holds) {
    return std::ranges::all_of(data.train, holds);
  };
  const auto sees_both = [&](const Observation& seen) {
    const bool has_rate = std::ranges::any_of(
        seen.gyro_rows, [&](const Vec3& rows) { return rows.dot(axis.cwiseAbs()) > 0.0; });
    return seen.has_some_attitude() && has_rate;
  };
  const auto shows_bias = [&](const Observation& seen) {
    return !angles_of_swing(seen, axis).row.empty();
  };
  return in_all_runs(sees_both)    ? Among::catalogue
         : in_all_runs(shows_bias) ? Among::torques_and_bias
                                   : Among::torques;
}

bool is_consistent_with_noise(const Fit& fit, const RecordedData& data) {
  constexpr double as_noise = 1.5;  // χ² per sample
  const Fit at_readings = propagate_model(fit, data.train, {});
  return at_readings.chi2_per_sample() < as_noise;
}

std::optional<Answer> identify_with_discrepancy(const NominalModel& nominal, RecordedData& data,
                                                const DiagnoseOptions& options, const Trial* laws) {
  const NoiseLevels own = data.train.front().noise;
  // The residual of all laws together contains no missing effect, so its noise level may vary over
  // a run. The residual of the nominal model may be a missing effect. It must not get less weight
  // where it is largest.
  const size_t parts = laws != nullptr ? options.limits.discrepancy.segments : 0;
  std::optional<Answer> best;
  set_noise(noise_from_spread(data.train, own), data);
  Fit left_by = laws != nullptr ? laws->fit : fit_nominal(nominal, data.train, options.limits);
  for (int round = 0; round < options.limits.discrepancy.max_rounds; ++round) {
    if (!std::isfinite(left_by.chi2)) break;
    const NoiseLevels before = data.train.front().noise;
    use_rest(left_by, own, Remainder::white, parts, data);
    if (round > 0 && !is_quieter(data.train.front().noise, before)) break;
    report_step(options, "naming effects, with the residual counted as noise");
    const Among among = among_with_discrepancy(nominal, data);
    const Candidates all = candidates_among(among, nominal, data.train, options.limits);
    const Fit nominal_fit = fit_nominal(nominal, data.train, options.limits);
    const bool tries_sets = laws != nullptr && is_of_textbook(all);
    Answer next = tries_sets ? sets_of_needed_laws(nominal_fit, *laws, data, own, options, all)
                             : searched(nominal, nominal_fit, data, options, among, laws);
    std::vector<size_t> compared(next.trials.size());
    std::iota(compared.begin(), compared.end(), size_t{0});
    if (!tries_sets) compared = likely_of(next);
    Contest contest(next, compared, data, segment_count(next, data, own), options.threads);
    Contender won = contest.winner();
    Trial fitted = refit_with_discrepancy(won.trial, next.all, own, parts, data);
    while (!inference::is_significant(fitted.significance, options.limits.decision)) {
      const auto least = std::ranges::min_element(fitted.significance, {}, [](double sigma) {
        return std::isnan(sigma) ? inference::infinity : sigma;
      });
      won = contest.without(won, static_cast<size_t>(least - fitted.significance.begin()));
      fitted = refit_with_discrepancy(won.trial, next.all, own, parts, data);
    }
    left_by = won.trial.fit;
    if (won.trial.candidates.empty() || !fitted.objection.empty()) break;
    won.trial = std::move(fitted);
    choose(won, contest, next);
    decide_with_discrepancy(next);
    best = std::move(next);
  }
  return best;
}

}  // namespace photorque
