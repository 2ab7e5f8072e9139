#include "diagnosis/attitude/answer.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "attitude/estimation/fit.h"
#include "attitude/observation/noise_levels.h"
#include "attitude/propagation/run.h"
#include "diagnosis/attitude/account.h"
#include "diagnosis/attitude/domain.h"
#include "diagnosis/attitude/holdout.h"
#include "diagnosis/attitude/locate.h"
#include "diagnosis/attitude/refine.h"
#include "inference/search.h"
#include "inference/weigh.h"

namespace photorque {

namespace {

double held_chi2_per_sample(const Trial& trial, const RecordedData& data,
                            const Thresholds& limits) {
  const double found = propagate_model(trial.fit, data.held, limits).chi2_per_sample();
  return std::isfinite(found) ? found : inference::infinity;
}

// A law that bends to what was fitted and leads away from what was held out describes nothing: the
// likeliest explanation that predicts better than the nominal model stands in its place, or, where
// none does, the nominal model.
void keep_what_predicts(const RecordedData& data, const Thresholds& limits, Answer& a) {
  if (data.held.empty()) return;
  const double nominal = held_chi2_per_sample(a.trials.front(), data, limits);
  size_t kept = 0;
  if (held_chi2_per_sample(a.chosen(), data, limits) <= nominal) return;
  for (const size_t i : inference::by_evidence(a.trials)) {
    const Trial& t = a.trials[i];
    if (i == a.decision.chosen || !t.objection.empty() || !t.holdout_chi2_per_sample) continue;
    if (held_chi2_per_sample(t, data, limits) <= nominal) {
      kept = i;
      break;
    }
  }
  a.decision.chosen = kept;
  const std::vector<size_t>& acts = a.trials[kept].candidates;
  std::erase_if(a.decision.beside_law,
                [&](size_t c) { return std::find(acts.begin(), acts.end(), c) == acts.end(); });
  a.decision.because = kept == 0 ? "nothing that was tried predicts what was held out"
                                 : "what explains the recording best does not predict what was "
                                   "held out";
}

}  // namespace

void tell(const DiagnoseOptions& options, const std::string& what) {
  if (options.progress) options.progress(what);
}

Answer explain(const NominalModel& nominal, const Fit& nominal_fit, const RecordedData& data,
               const DiagnoseOptions& options, Among among) {
  Answer a;
  a.all = all_candidates(nominal, data.train, options.limits);
  if (among == Among::unscanned) {
    std::erase_if(a.all.list, [](const Candidate& c) { return !c.is_linear(); });
  }
  if (among == Among::plain_physics) {
    std::erase_if(a.all.list, [](const Candidate& c) {
      return c.empirical() || !c.is_linear() || c.start.stage == Stage::measurement;
    });
  }
  const AttitudeDomain domain(a.all);
  tell(options, "fitting every effect of the catalogue");
  a.trials =
      inference::search(domain, nominal_trial(nominal_fit, a.all), data.train, options.threads);
  a.depends_on = dependences(a.trials, a.all);
  tell(options, "comparing with what was held out");
  inference::weigh_with_held_out(domain, data.train, data.held, options.threads, a.trials);
  const auto excess = [&](size_t trial) {
    return domain.excess_sigma(a.trials[trial], data.train);
  };
  a.decision = inference::decide({a.trials.begin(), a.trials.end()}, domain.candidates(), excess,
                                 options.limits.decision);
  if (among == Among::all && a.decision.finding == inference::Finding::unknown) {
    Trial& chosen = a.trials[a.decision.chosen];
    chosen = refined_in_time(chosen, a.all, data.train);
    keep_what_predicts(data, options.limits, a);
  }
  return a;
}

Answer unexplained(const NominalModel& nominal, const Fit& nominal_fit, const RecordedData& data,
                   const Thresholds& limits) {
  Answer a;
  a.all = all_candidates(nominal, data.train, limits);
  a.trials = {nominal_trial(nominal_fit, a.all)};
  a.decision.finding = inference::Finding::unknown;
  a.decision.confidence = limits.decision.structure_confidence;
  a.decision.because = "the nominal model leaves structure in the recording";
  a.decision.probability = {1.0};
  return a;
}

namespace {

void use_noise(const NoiseLevels& noise, RecordedData& data) {
  for (auto* runs : {&data.train, &data.held}) {
    for (Observation& seen : *runs) seen.noise = noise;
  }
}

bool contains(const std::vector<size_t>& all, const std::vector<size_t>& some) {
  const std::set<size_t> in(all.begin(), all.end());
  return std::all_of(some.begin(), some.end(), [&](size_t c) { return in.count(c) > 0; });
}

// Whether nothing that physics allows predicts what was held out better without these names.
bool predicts_best(const std::vector<Trial>& trials, const Trial& named) {
  return std::none_of(trials.begin(), trials.end(), [&](const Trial& t) {
    return t.objection.empty() && !contains(t.candidates, named.candidates) &&
           t.holdout_chi2_per_sample && *t.holdout_chi2_per_sample < *named.holdout_chi2_per_sample;
  });
}

// Of the best names those that what was held out misses: without any one of them it would be
// predicted worse by the factor that makes a name. What is left is no noise, and an effect that
// bends a little with it gains evidence where it does not act.
void drop_what_held_out_does_not_miss(const Thresholds& limits, Answer& a) {
  size_t& best = a.decision.best_named;
  const bool is_chosen = a.decision.chosen == best;
  for (bool drops = best != 0; drops;) {
    const Trial& whole = a.trials[best];
    size_t fewer = best;
    for (size_t i = 1; i < a.trials.size(); ++i) {
      const Trial& part = a.trials[i];
      const bool has_one_less = part.candidates.size() + 1 == whole.candidates.size() &&
                                contains(whole.candidates, part.candidates);
      if (!has_one_less || !part.objection.empty() || !part.holdout_chi2_per_sample ||
          !whole.holdout_chi2_per_sample ||
          *whole.holdout_chi2_per_sample <
              limits.decision.max_held_out_fraction * *part.holdout_chi2_per_sample) {
        continue;
      }
      if (fewer == best || part.log_evidence > a.trials[fewer].log_evidence) fewer = i;
    }
    drops = fewer != best;
    best = fewer;
  }
  if (is_chosen) a.decision.chosen = best;
}

// Whether known physics is part of the answer: it predicts what was held out far better than the
// nominal model, and where a law without a name explains more, it does so beside the same names.
// What was held out may hold more of the rest than what was fitted, which no distribution
// foretells: then the names have to predict better by a factor still larger, and best of all;
// nothing is added so to names that were `found` before.
bool has_names(const Answer& a, bool found, const Thresholds& limits) {
  const inference::Decision& decision = a.decision;
  if (decision.best_named == 0) return false;
  const Trial &named = a.trials[decision.best_named], &chosen = a.chosen();
  const auto& nominal_held = a.trials.front().holdout_chi2_per_sample;
  const auto& named_held = named.holdout_chi2_per_sample;
  if (!nominal_held || !named_held || std::isnan(*named_held) ||
      !(*named_held < limits.decision.max_held_out_fraction * *nominal_held)) {
    return false;
  }
  if (decision.finding == inference::Finding::named) return true;
  if (decision.chosen == decision.best_named) {
    return !found && *named_held < limits.decision.max_uncovered_fraction * *nominal_held &&
           predicts_best(a.trials, named);
  }
  return chosen.candidates.size() > named.candidates.size() &&
         contains(chosen.candidates, named.candidates);
}

// χ² of what was held out against the noise that `data` has, whatever that is.
double held_chi2(const Fit& fit, const RecordedData& data, const Thresholds& limits) {
  return propagate_model(fit, data.held, limits).chi2;
}

// The names with parameters and errors by what is left beside them. The less is left, the more the
// readings weigh against what was stated; so it goes on as long as what was held out gains by it.
void refit_beside_the_rest(const NoiseLevels& own, RecordedData data, const Thresholds& limits,
                           Answer& answer) {
  constexpr int most_rounds = 6;
  Trial& named = answer.trials[answer.decision.chosen];
  const auto rest = [&](Remainder remainder) {
    return with_discrepancy(residuals_of(named.fit, data.train), data.train, own, remainder);
  };
  for (int round = 0; round < most_rounds; ++round) {
    use_noise(rest(Remainder::white), data);
    const Trial again = refit(named, answer.all, data.train, named.fit.best.runs);
    if (!std::isfinite(again.fit.chi2) || !again.objection.empty() ||
        !(held_chi2(again.fit, data, limits) < 0.9 * held_chi2(named.fit, data, limits))) {
      break;
    }
    named.fit = again.fit;
  }
  use_noise(rest(Remainder::correlated), data);
  const Trial again = refit(named, answer.all, data.train, named.fit.best.runs);
  if (std::isfinite(again.fit.chi2)) named.fit = again.fit;
}

// The nominal model fitted with all that it leaves counted as noise, which `data` then has.
Fit fit_in_the_rough(const NominalModel& nominal, const NoiseLevels& own, const Thresholds& limits,
                     RecordedData& data) {
  use_noise(patient_noise(data.train, own), data);
  Fit fitted = fit_nominal(nominal, data.train, limits);
  if (!std::isfinite(fitted.chi2)) return fitted;
  use_noise(with_discrepancy(residuals_of(fitted, data.train), data.train, own, Remainder::white),
            data);
  return fit_nominal(nominal, data.train, limits);
}

}  // namespace

Answer explained_in_the_rough(const NominalModel& nominal, RecordedData data,
                              const DiagnoseOptions& options) {
  const NoiseLevels own = data.train.front().noise;
  const Fit fitted = fit_in_the_rough(nominal, own, options.limits, data);
  tell(options, "describing what acts, with the rest counted as noise");
  return explain(nominal, fitted, data, options, Among::unscanned);
}

std::optional<Answer> named_beside_the_rest(const NominalModel& nominal, RecordedData data,
                                            const DiagnoseOptions& options) {
  constexpr int most_steps = 4;
  const NoiseLevels own = data.train.front().noise;
  std::optional<Answer> best;
  use_noise(patient_noise(data.train, own), data);
  Fit left_by = fit_nominal(nominal, data.train, options.limits);
  for (int step = 0; step < most_steps && std::isfinite(left_by.chi2); ++step) {
    const NoiseLevels noise =
        with_discrepancy(residuals_of(left_by, data.train), data.train, own, Remainder::white);
    if (step > 0 && !is_quieter(noise, data.train.front().noise)) break;
    use_noise(noise, data);
    tell(options, "naming what stands out, with the rest counted as noise");
    Answer next = explain(nominal, fit_nominal(nominal, data.train, options.limits), data, options,
                          Among::plain_physics);
    drop_what_held_out_does_not_miss(options.limits, next);
    const bool named = has_names(next, best.has_value(), options.limits);
    if (!named && (best || next.decision.best_named == 0)) break;
    left_by = next.trials[next.decision.best_named].fit;
    if (!named) continue;
    next.decision.chosen = next.decision.best_named;
    best = std::move(next);
  }
  if (best) refit_beside_the_rest(own, data, options.limits, *best);
  return best;
}

}  // namespace photorque
