#include "diagnosis/attitude/answer.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "attitude/estimation/fit.h"
#include "attitude/propagation/run.h"
#include "diagnosis/attitude/findings.h"
#include "inference/search.h"
#include "inference/weigh.h"

namespace photorque {
namespace {

bool is_among(const Candidate& c, Among among) {
  if (among == Among::all) return true;
  const bool is_known = among == Among::unscanned || !c.is_empirical;
  const bool acts = c.start.stage != Stage::measurement,
             is_bias = !acts && c.effect.how.per_recording;
  return c.is_linear && is_known &&
         (acts || among < Among::torques_and_bias || (is_bias && among == Among::torques_and_bias));
}

// Keeps the simplest (simpler_by()) of the names that are indistinguishable from the chosen ones.
void prefer_simpler(const Thresholds& limits, Answer& a) {
  if (a.decision.verdict != Verdict::missing_physics) return;
  const double alike = a.chosen().log_evidence - limits.search.min_log_evidence_gain;
  for (size_t i = 0; i < a.trials.size(); ++i) {
    const Trial& t = a.trials[i];
    const bool stands = t.objection.empty() && t.log_evidence > alike && t.predictive &&
                        t.predictive->sigma < limits.decision.max_predictive_sigma &&
                        inference::is_significant(t, limits.decision);
    if (!stands || simpler_by(t, a.chosen(), a).value_or(0.0) <= 0.0) continue;
    a.decision.chosen = a.decision.best_named = i;
  }
}

double held_chi2_per_sample(const Trial& trial, const RecordedData& data,
                            const Thresholds& limits) {
  const double found = propagate_model(trial.fit, data.held, limits).chi2_per_sample();
  return std::isfinite(found) ? found : inference::infinity;
}

// Rejects a law that fits the recordings but predicts the held-out data worse than the nominal
// model. It is replaced by the most likely explanation that predicts better than the nominal model
// or, if there is none, by the nominal model.
void keep_predictive_explanation(const RecordedData& data, const Thresholds& limits, Answer& a) {
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
  a.decision.because = kept == 0 ? "no tried explanation predicts the held-out data"
                                 : "the best explanation does not predict the held-out data";
}

// Searches with the noise level of the readings. The noise is then estimated again about the
// explanation if the nominal model fitted too badly for that, or if known physics explains most of
// the residual: an unexplained oscillation may have been taken for correlated noise. If the
// estimate changes, the search is repeated with it.
Answer at_noise_of_readings(const NominalModel& nominal, RecordedData& data,
                            const DiagnoseOptions& options, Fit& nominal_fit, const Trial* near) {
  constexpr double most_left = 0.5;
  report_step(options, "fitting every effect of the catalogue");
  Answer a = searched(nominal, nominal_fit, data, options, Among::all, near);
  const size_t known = a.decision.best_named;
  const bool is_known = a.decision.verdict == Verdict::missing_physics ||
                        (a.decision.verdict == Verdict::unexplained && known != 0 &&
                         a.trials[known].fit.chi2 < most_left * nominal_fit.chi2);
  if (!data.noise_is_open && !is_known) return a;
  const Trial explained = is_known ? a.trials[known] : a.chosen();
  if (!estimate_noise_again(explained.fit, options.limits, data)) return a;
  report_step(options, "again, with the noise that was found");
  nominal_fit = fit(nominal_fit.best, data.train);
  return searched(nominal, nominal_fit, data, options, Among::all, is_known ? &explained : near);
}

// Whether an empirical law describes the recordings far better than known physics.
bool law_is_far_better(const Answer& a, const Thresholds& limits) {
  const bool is_law = a.decision.chosen != a.decision.best_named;
  const double law = a.chosen().fit.chi2_per_sample(),
               known = a.trials[a.decision.best_named].fit.chi2_per_sample();
  return is_law && law < limits.discrepancy.max_fraction_of_law * known;
}

// Describes the unexplained residual by a refined law in time. Effects named in addition to this
// law are dropped if they are not clear in the refined fit.
void describe(const RecordedData& data, const DiagnoseOptions& options, Answer& a) {
  if (a.decision.verdict != Verdict::unexplained) return;
  Trial& chosen = a.trials[a.decision.chosen];
  chosen = refined_in_time(chosen, a.all, data.train);
  keep_predictive_explanation(data, options.limits, a);
  const Trial& now = a.chosen();
  std::erase_if(a.decision.beside_law,
                [&](size_t c) { return !inference::is_clear(now, c, options.limits.decision); });
}

bool has_law(const Trial& trial, const Candidates& all) {
  return std::ranges::any_of(trial.candidates, [&](size_t c) { return all[c].is_empirical; });
}

void leave_unexplained(inference::Decision& decision) {
  decision.verdict = Verdict::unexplained;
  decision.because = "the residual is far above the noise of the readings";
}

// Whether the motion is measured well enough for a full search: on an air bearing, or if attitude
// or position is measured.
bool is_watched(const NominalModel& nominal, const RecordedData& data) {
  const Observation& seen = data.train.front();
  return nominal.model.platform.has_air_bearing() || seen.sees_attitude() ||
         (seen.has(Scalar::position_x) && seen.has(Scalar::position_y));
}

// Whether a model with names, fitted with the residual as noise, also describes the recordings
// better than the nominal model with the noise of the readings, and does not predict the held-out
// data much worse.
bool is_better_at_readings(const Fit& named, const Fit& nominal, const RecordedData& data,
                           const Thresholds& limits) {
  const auto is_lower = [](double one, double other) {
    return std::isfinite(one) && !(one >= other);
  };
  if (!is_lower(propagate_model(named, data.train, limits).chi2,
                propagate_model(nominal, data.train, limits).chi2)) {
    return false;
  }
  if (data.held.empty()) return true;
  const Fit held = propagate_model(nominal, data.held, limits);
  const double most = std::max(held.chi2, static_cast<double>(held.samples));  // NaN stays
  return is_lower(propagate_model(named, data.held, limits).chi2,
                  limits.decision.max_held_out_growth * most);
}

// Whether the body turns about one axis or slides. A body that turns about three axes has so many
// uncertain parameters that effects named in the presence of a residual are spurious.
bool is_simple(const NominalModel& nominal) {
  return nominal.model.platform.turns_about_one_axis() || nominal.model.platform.slides();
}

}  // namespace

void report_step(const DiagnoseOptions& options, const std::string& what) {
  if (options.progress) options.progress(what);
}

std::optional<double> simpler_by(const Trial& first, const Trial& second, const Answer& answer) {
  std::vector<size_t> ours = first.candidates, theirs = second.candidates;
  for (const size_t c : second.candidates) std::erase(ours, c);
  for (const size_t c : first.candidates) std::erase(theirs, c);
  if (ours.size() != 1 || theirs.size() != 1) return std::nullopt;
  const Candidate &our = answer.all[ours[0]], &their = answer.all[theirs[0]];
  const bool push_alike = our.effect.how.needs == their.effect.how.needs;
  if (push_alike && our.effect.how.steady && their.effect.how.steady) {
    return static_cast<double>(their.start.parameters.size()) -
           static_cast<double>(our.start.parameters.size());
  }
  const AttitudeModel& model = answer.trials.front().fit.best.model;
  const std::optional<double> one = braking_power(our, model), other = braking_power(their, model);
  if (!one || !other) return std::nullopt;
  return *other - *one;
}

Candidates candidates_among(Among among, const NominalModel& nominal,
                            const std::vector<Observation>& runs, const Thresholds& limits) {
  Candidates all = all_candidates(nominal, runs, limits);
  for (const Among first :
       {Among::unscanned, Among::catalogue, Among::torques_and_bias, Among::torques}) {
    std::ranges::stable_partition(all.list, [&](const Candidate& c) { return is_among(c, first); });
  }
  // An uncertain inertia already has an error parameter; with a second one the scale of all torques
  // is undetermined.
  const bool has_error = nominal.uncertain_inertia.has_value();
  std::erase_if(all.list, [&](const Candidate& c) {
    const bool is_second = has_error && c.effect.how.inertia_change_kg_m2 != nullptr;
    return !is_among(c, among) || (among >= Among::catalogue && is_second);
  });
  return all;
}

Answer searched(const NominalModel& nominal, const Fit& nominal_fit, const RecordedData& data,
                const DiagnoseOptions& options, Among among, const Trial* near) {
  Answer a;
  a.all = candidates_among(among, nominal, data.train, options.limits);
  const Trial base = nominal_trial(nominal_fit, a.all);
  std::optional<Trial> begin;
  if (near != nullptr) begin = a.all.refit(*near, data.train, near->fit.best.runs, {});
  a.trials = inference::search(a.all, base, data.train, options.threads, begin ? &*begin : nullptr);
  a.depends_on = dependences(a.trials, a.all);
  report_step(options, "comparing with the held-out data");
  inference::weigh_with_held_out(a.all, data.train, data.held, options.threads, a.trials);
  const auto excess = [&](size_t trial) { return a.all.excess_sigma(a.trials[trial], data.train); };
  a.decision =
      inference::decide({a.trials.begin(), a.trials.end()}, {a.all.list.begin(), a.all.list.end()},
                        {excess}, options.limits.decision);
  prefer_simpler(options.limits, a);
  return a;
}

Answer explain(const NominalModel& nominal, RecordedData& data, const DiagnoseOptions& options,
               Fit& nominal_fit) {
  const Thresholds& limits = options.limits;
  // 1. Search with the noise of the readings. If the nominal model of a sparsely measured machine
  // is far from the recording, this would only distort the nominal model.
  const bool is_far = !is_watched(nominal, data) &&
                      !(nominal_fit.chi2_per_sample() < limits.diverged_chi2_per_sample);
  const Platform& platform = nominal.model.platform;
  const bool turns_alone = platform.turns_about_one_axis() && !platform.slides();
  Answer fine;
  if (!is_far) {
    fine = at_noise_of_readings(nominal, data, options, nominal_fit, nullptr);
    // For rotation about one axis, known laws are named in addition to an empirical law.
    const bool may_name =
        fine.decision.leaves_more || (turns_alone && fine.decision.verdict == Verdict::unexplained);
    if (!may_name || (!turns_alone && law_is_far_better(fine, limits)) || !is_simple(nominal)) {
      describe(data, options, fine);
      return fine;
    }
  }
  // 2. Fit of all textbook laws together. If it agrees with the readings, the search starts there.
  std::optional<Trial> laws;
  const Candidates known =
      candidates_among(among_with_discrepancy(nominal, data), nominal, data.train, limits);
  if (is_far || (turns_alone && is_of_textbook(known))) {
    report_step(options, "fitting the laws of a textbook together");
    laws = fit_textbook_laws(nominal_fit, known, data);
  }
  if (is_far && laws && is_consistent_with_noise(laws->fit, data)) {
    fine = at_noise_of_readings(nominal, data, options, nominal_fit, &*laws);
    if (fine.decision.verdict != Verdict::unexplained) return fine;
  }
  // 3. Search in which the residual counts as noise. If its names alone agree with the readings,
  // the search with the noise of the readings starts from them.
  RecordedData rough = data;
  std::optional<Answer> named =
      identify_with_discrepancy(nominal, rough, options, laws ? &*laws : nullptr);
  if (named && !is_better_at_readings(named->chosen().fit, nominal_fit, data, limits)) {
    named.reset();
  }
  if (named && fine.trials.empty() && is_consistent_with_noise(named->chosen().fit, data)) {
    Answer again = at_noise_of_readings(nominal, data, options, nominal_fit, &named->chosen());
    if (again.decision.verdict != Verdict::unexplained) return again;
  }
  if (named) {
    if (!fine.trials.empty() && has_law(fine.chosen(), fine.all)) {
      named->depends_on = of_unknown_law({}, fine.chosen(), fine.all);
    }
    return std::move(*named);
  }
  // 4. No effect is named: a law without a name describes the residual.
  if (!fine.trials.empty()) {
    describe(data, options, fine);
    return fine;
  }
  report_step(options, "describing the effects, with the residual counted as noise");
  Answer described = searched(nominal, fit_nominal(nominal, rough.train, limits), rough, options,
                              Among::unscanned, nullptr);
  described.rest_is_noise = true;
  leave_unexplained(described.decision);
  // A law that is no better than the nominal model at the noise of the readings describes nothing.
  if (!is_better_at_readings(described.chosen().fit, nominal_fit, data, limits)) {
    described.decision.chosen = 0;
    described.trials.front().fit = nominal_fit;
    described.rest_is_noise = false;
  }
  return described;
}

}  // namespace photorque
