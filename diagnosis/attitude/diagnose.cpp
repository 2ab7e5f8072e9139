#include "diagnosis/attitude/diagnose.h"

#include <algorithm>
#include <cmath>

#include "attitude/estimation/conventions.h"
#include "attitude/estimation/noise.h"
#include "core/errors.h"
#include "diagnosis/attitude/account.h"
#include "diagnosis/attitude/domain.h"
#include "diagnosis/attitude/empirical_torque.h"
#include "diagnosis/attitude/holdout.h"
#include "diagnosis/attitude/locate.h"
#include "diagnosis/attitude/manoeuvre.h"
#include "diagnosis/attitude/recorded_data.h"
#include "diagnosis/attitude/refine.h"
#include "diagnosis/attitude/settle.h"
#include "diagnosis/verdict.h"
#include "inference/decide.h"
#include "inference/search.h"
#include "inference/weigh.h"

namespace photorque {
namespace {

// All that was fitted, and what is made of it.
struct Answer {
  Candidates all;
  std::vector<Trial> trials;
  // Before the runs held out count: in one that diverges there all explanations differ by chance.
  std::vector<Where::Dependence> depends_on;
  inference::Decision decision;

  const Trial& chosen() const { return trials[decision.chosen]; }
};

void tell(const DiagnoseOptions& options, const std::string& what) {
  if (options.progress) options.progress(what);
}

// Score every effect, fit, compare, weigh with what was held out, decide.
Answer explain(const NominalModel& nominal, const Fit& nominal_fit, const RecordedData& data,
               const DiagnoseOptions& options) {
  Answer a;
  a.all = all_candidates(nominal, data.train, options.limits);
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
  if (a.decision.finding == inference::Finding::unknown) {
    Trial& chosen = a.trials[a.decision.chosen];
    chosen = refined_in_time(chosen, a.all, data.train);
  }
  return a;
}

// Nowhere where the nominal model cannot be propagated: they part from the start.
Where where_they_part(const Fit& nominal_fit, const RecordedData& data,
                      const Thresholds::Location& limits) {
  try {
    return locate(residuals_of(nominal_fit, data.train), data.train, limits);
  } catch (const NumericalError&) {
    return {};
  }
}

void say_what_was_found(const Answer& answer, const Fit& nominal_fit, const RecordedData& data,
                        const DiagnoseOptions& options, Diagnosis& d) {
  const auto& [all, trials, depends_on, decision] = answer;
  const Trial& chosen = answer.chosen();
  d.verdict = verdict_of(decision.finding);
  d.confidence = decision.confidence;
  d.where = where_they_part(nominal_fit, data, all.limits.location);
  if (d.verdict == Verdict::missing_physics) {
    d.where.depends_on = depends_on;
    d.effects = found_effects(decision, trials, all);
  }
  if (d.verdict == Verdict::unexplained) {
    d.where.depends_on = of_unknown_law(depends_on, chosen, all);
    d.empirical = empirical_torques(chosen, all, data.train);
    d.unnamed = unnamed_effects(decision, trials, all, d.effects);
  }
  d.alternatives = alternatives(decision, trials, all);
  try {
    d.manoeuvres = manoeuvres(d.effects, decision, trials, all, data.train, options.threads);
  } catch (const NumericalError&) {
    // Of a motion that cannot be propagated there is none to propose.
  }
  d.priors_refined = refined_priors(chosen);
  d.because = decision.because;
}

// The part of what the nominal model leaves of the held-out runs that the chosen one explains.
double explained_fraction(const Fit& held_before, const Fit& held_after) {
  const double before = held_before.chi2_per_sample() - 1.0,
               after = held_after.chi2_per_sample() - 1.0;
  if (std::isnan(before) || std::isnan(after) || std::isinf(after)) return 0.0;
  if (std::isinf(before)) return 1.0;
  const double noise = 5.0 * std::sqrt(2.0 / static_cast<double>(held_before.samples));
  return before > noise ? std::clamp((before - after) / before, 0.0, 1.0) : 1.0;
}

// Numbers and curves of the nominal and the chosen model, beside what was fitted and held out.
void say_how_well(const Fit& before, const Trial& chosen, const RecordedData& data,
                  const Thresholds& limits, Diagnosis& d) {
  const Fit& after = chosen.fit;
  d.chi2_per_sample_before = before.chi2_per_sample();
  d.chi2_per_sample_after = after.chi2_per_sample();
  d.samples = before.samples;
  const Fit held_before = propagate_model(before, data.held, limits),
            held_after = propagate_model(after, data.held, limits);
  d.holdout = compare_holdout(held_before, held_after, data.held);
  d.holdout->predictive = chosen.predictive;
  d.holdout->explained_fraction = explained_fraction(held_before, held_after);
  for (size_t run = 0; run < data.train.size(); ++run) {
    d.series.push_back(series_of(before, after, data.train[run], run));
  }
  for (size_t run = 0; run < data.held.size(); ++run) {
    d.series.push_back(series_of(held_before, held_after, data.held[run], run));
    d.series.back().held_out_s = {{data.held[run].time_s.front(), data.held[run].time_s.back()}};
  }
}

std::vector<std::string> warnings_of(const RecordedData& data,
                                     const inference::Decision& decision) {
  std::vector<std::string> warnings = data.warnings;
  for (const InstrumentFinding& finding : data.instruments) warnings.push_back(finding.text);
  if (decision.undecided) {
    warnings.push_back(
        "the recordings and what was held out show together what neither shows alone, but not "
        "which effect it is: see the alternatives");
  }
  return warnings;
}

Replay replay_of(const Fit& fit, const Observation& seen) {
  Replay replay;
  replay.recording = seen.name;
  for (const ZeroOrderHold& held : seen.schedule.held) {
    replay.has_commands = replay.has_commands || held != ZeroOrderHold{};
  }
  replay.duration_s = seen.duration_s();
  replay.output_rate_Hz = static_cast<double>(seen.blocks() - 1) / seen.duration_s();
  const PlatformState& initial = fit.best.runs.front().initial;
  const Quat& q = initial.lab_from_body;
  replay.initial_attitude = {q.w(), q.x(), q.y(), q.z()};
  replay.initial_rate_rad_s = initial.rate_body_rad_s;
  replay.initial_time_s = initial.time_s;
  replay.initial_charge_C = initial.charge_drawn_C;
  return replay;
}

}  // namespace

Diagnosis diagnose(const NominalModel& nominal, const std::vector<NamedRecording>& recordings,
                   const std::vector<NamedRecording>& holdouts, const DiagnoseOptions& options) {
  if (recordings.empty()) throw InputError({}, "--recording", "none", "at least one recording");
  RecordedData data = read_data(nominal, recordings, holdouts, options);
  tell(options, "fitting the nominal model");
  Fit nominal_fit = settle(nominal, options.limits, data);
  Answer answer = explain(nominal, nominal_fit, data, options);
  if (settle_again(answer.chosen().fit, options.limits, data)) {
    tell(options, "again, with the noise that was found");
    nominal_fit = fit(nominal_fit.best, data.train);
    answer = explain(nominal, nominal_fit, data, options);
  }
  Diagnosis d;
  say_what_was_found(answer, nominal_fit, data, options, d);
  say_how_well(nominal_fit, answer.chosen(), data, options.limits, d);
  d.warnings = warnings_of(data, answer.decision);
  for (const std::string& text : contradicted_beliefs(answer.chosen(), options.limits.decision)) {
    d.warnings.push_back(text);
  }
  d.instruments = data.instruments;
  d.data = quality_of(recordings, holdouts, data);
  d.replay = replay_of(answer.chosen().fit, data.train.front());
  d.sentence = sentence_of(d);
  return d;
}

}  // namespace photorque
