#include <cmath>
#include <set>

#include "attitude/estimation/nominal_model.h"
#include "diagnosis/attitude/answer.h"
#include "diagnosis/attitude/discrepancy.h"

namespace photorque {
namespace {

void use_noise(const NoiseLevels& noise, RecordedData& data) {
  for (auto* runs : {&data.train, &data.held}) {
    for (Observation& seen : *runs) seen.noise = noise;
  }
}

// Whether no explanation that physics allows predicts what was held out better.
bool predicts_best(const std::vector<Trial>& trials, double held) {
  return std::none_of(trials.begin(), trials.end(), [&](const Trial& t) {
    return t.objection.empty() && t.holdout_chi2_per_sample && *t.holdout_chi2_per_sample < held;
  });
}

// Whether known physics is part of the answer: it predicts what was held out far better than the
// nominal model, and where a law without a name explains more, it does so beside the same names.
// What was held out may hold more of the rest than what was fitted, which no distribution foretells:
// then the names have to predict better by a factor still larger, and best of all.
bool has_names(const Answer& a, const Thresholds& limits) {
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
    return *named_held < limits.decision.max_unforetold_fraction * *nominal_held &&
           predicts_best(a.trials, *named_held);
  }
  const std::set<size_t> all(chosen.candidates.begin(), chosen.candidates.end());
  return chosen.candidates.size() > named.candidates.size() &&
         std::all_of(named.candidates.begin(), named.candidates.end(),
                     [&](size_t c) { return all.count(c) > 0; });
}

// The names with parameters and errors by what is left beside them.
void refit_beside_the_rest(const NoiseLevels& own, RecordedData data, Answer& answer) {
  Trial& named = answer.trials[answer.decision.chosen];
  use_noise(
      with_discrepancy(residuals_of(named.fit, data.train), data.train, own, Remainder::correlated),
      data);
  const Trial again = refit(named, answer.all, data.train, named.fit.best.runs);
  if (std::isfinite(again.fit.chi2)) named.fit = again.fit;
}

// The nominal model fitted with all that it leaves counted as noise, which `data` then has.
Fit fit_in_the_rough(const NominalModel& nominal, const NoiseLevels& own, const Thresholds& limits,
                     RecordedData& data) {
  use_noise(patient_noise(data.train, own), data);
  const Fit fitted = fit_nominal(nominal, data.train, limits);
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
    const bool named = has_names(next, options.limits);
    if (!named && (best || next.decision.best_named == 0)) break;
    left_by = next.trials[next.decision.best_named].fit;
    if (!named) continue;
    next.decision.chosen = next.decision.best_named;
    best = std::move(next);
  }
  if (best) refit_beside_the_rest(own, data, *best);
  return best;
}

}  // namespace photorque
