#include "diagnosis/attitude/diagnose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "attitude/disturbances/kind.h"
#include "attitude/estimation/axis_readings.h"
#include "attitude/estimation/fit.h"
#include "attitude/estimation/segments.h"
#include "attitude/estimation/swing.h"
#include "core/constants.h"
#include "core/errors.h"
#include "core/text/format.h"
#include "diagnosis/attitude/answer.h"
#include "diagnosis/attitude/findings.h"

namespace photorque {
namespace {

void report_explanation(const Answer& answer, const Fit& nominal_fit, const RecordedData& data,
                        const DiagnoseOptions& options, Diagnosis& d) {
  const Candidates& all = answer.all;
  const std::vector<Trial>& trials = answer.trials;
  const inference::Decision& decision = answer.decision;
  const Trial& chosen = answer.chosen();
  d.verdict = decision.verdict;
  d.confidence = decision.confidence;
  d.where = locate(nominal_fit, data.train, all.limits.location);
  if (d.verdict == Verdict::missing_physics || answer.beside) {
    d.where.depends_on = answer.depends_on;
    d.effects = found_effects(decision, trials, all);
  }
  if (answer.beside) {
    for (size_t i = 0; i < d.effects.size(); ++i) {
      d.effects[i].probability = decision.confidence;
      d.effects[i].indistinguishable_from = answer.beside->rivals[i];
    }
  } else if (d.verdict == Verdict::unexplained) {
    d.where.depends_on = of_unknown_law(answer.depends_on, chosen, all);
    d.empirical = empirical_torques(chosen, all, data.train);
    add_effects_beside_law(decision, trials, all, d);
  }
  d.alternatives = alternatives(decision, trials, all);
  try {
    d.manoeuvres = manoeuvres(d.effects, decision, trials, all, data.train, options.threads);
  } catch (const NumericalError&) {
    // A motion that cannot be propagated allows no proposal.
  }
  d.priors_refined = refined_priors(chosen);
  d.because = decision.because;
}

// Statistics and curves of the nominal and the chosen model, for fitted and held-out data.
void report_fit_quality(const Fit& before, const Answer& answer, const RecordedData& data,
                        const Thresholds& limits, Diagnosis& d) {
  const Trial& chosen = answer.chosen();
  // If the residual counted as noise, χ² is recomputed with the noise of the readings.
  const Fit after =
      answer.rest_is_noise ? propagate_model(chosen.fit, data.train, limits) : chosen.fit;
  d.chi2_per_sample_before = before.chi2_per_sample();
  d.chi2_per_sample_after = after.chi2_per_sample();
  d.samples = before.samples;
  try {
    d.channels_after = misfits(residuals_of(after, data.train));
  } catch (const NumericalError&) {
    // A model that cannot be propagated along these recordings has no residuals.
  }
  const Fit held_before = propagate_model(before, data.held, limits),
            held_after = propagate_model(after, data.held, limits);
  d.holdout = compare_holdout(held_before, held_after, data.held);
  d.holdout->predictive = chosen.predictive;
  d.holdout->explained_fraction = explained_fraction(
      held_before.chi2_per_sample(), held_after.chi2_per_sample(), held_before.samples);
  for (size_t run = 0; run < data.train.size(); ++run) {
    d.series.push_back(series_of(before, after, data.train[run], run));
  }
  for (size_t run = 0; run < data.held.size(); ++run) {
    d.series.push_back(series_of(held_before, held_after, data.held[run], run));
    d.series.back().held_out_s = {{data.held[run].time_s.front(), data.held[run].time_s.back()}};
    d.series.back().is_held_out = true;
  }
}

// Adds the gain in prediction of segments by each name, with model discrepancy.
void report_gains_over_segments(const Answer& answer, Diagnosis& d) {
  if (!answer.beside) return;
  for (size_t i = 0; i < d.effects.size(); ++i) {
    d.warnings.push_back(
        printed("%s: %zu segments, each predicted from the others, are predicted "
                "better with it than without it by %.1f standard errors",
                d.effects[i].kind.c_str(), answer.beside->segments, answer.beside->sigma[i]));
  }
  if (answer.beside->tied.empty()) return;
  d.warnings.push_back("the segments are predicted as well, within 1.6 standard errors, by " +
                       joined_text(answer.beside->tied, "; or "));
}

// Adds the meaning of forces and torques of a platform whose mass and inertia are one.
void explain_unit_inertia(const Platform& platform, Diagnosis& d) {
  const bool has_torque = std::ranges::any_of(d.effects, [](const FoundEffect& effect) {
    return std::ranges::any_of(effect.parameters, [](const FittedParameter& p) {
      return p.key.find("_N") != std::string::npos;
    });
  });
  if (!has_torque || !platform.turns_about_one_axis()) return;
  if (platform.slides() ? platform.mass_kg != 1.0 : platform.inertia_kg_m2 != Mat3::Identity()) {
    return;
  }
  d.warnings.emplace_back(
      platform.slides()
          ? "the mass is 1 kg: a force in N is also an acceleration in m/s²"
          : "the moment of inertia is 1 kg m²: a torque in N m is also an angular acceleration "
            "in rad/s²");
}

// Adds a warning if held-out data do not test the names or scatter less than the noise.
void warn_of_weak_holdout(Diagnosis& d) {
  constexpr double as_well = inference::GateLimits{}.max_untested_fraction, too_quiet_sigma = -5.0;
  const double before = d.holdout->chi2_per_sample_before, after = d.holdout->chi2_per_sample_after;
  if (!d.effects.empty() && after > as_well * before) {
    d.warnings.push_back(untested_names(*d.holdout));
  }
  const double sigma = (after - 1.0) * std::sqrt(0.5 * static_cast<double>(d.holdout->samples));
  if (sigma < too_quiet_sigma) {
    d.warnings.push_back(printed(
        "the held-out data scatter less than the noise used in the fit (χ² per sample %.3g, %.0f "
        "standard errors below 1): the stated noise is too large, or an effect was counted as "
        "noise",
        after, -sigma));
  }
}

// Omits the attitude from the state if no instrument measures it and no effect depends on it.
NominalModel as_seen(const NominalModel& stated, const RecordedData& data) {
  NominalModel nominal = stated;
  const bool is_seen = std::any_of(
      data.train.begin(), data.train.end(),
      [&](const Observation& seen) { return seen.measures_attitude(stated.model.platform); });
  const Platform& platform = nominal.model.platform;
  // A twisted line or a weight exerts a restoring torque that depends on the angle, so rates alone
  // determine the angle.
  const bool turns_alone = platform.turns_about_one_axis() && !platform.slides();
  const bool may_twist = turns_alone && std::abs(platform.axis.z()) > 0.5 &&
                         turns_less(data.train, platform.axis, most_turns_of_line);
  const bool may_swing =
      turns_alone && std::ranges::any_of(data.train, [&](const Observation& seen) {
        return !angles_from_rates(seen, platform.axis).row.empty();
      });
  nominal.model.holds_attitude =
      !is_seen && !may_twist && !may_swing && !depends_on_attitude(stated.model);
  return nominal;
}

// Whether the fitted inertia is physical: by their errors, fitted moments may violate a condition
// that every body obeys.
bool is_an_inertia(const Trial& chosen, size_t disturbance) {
  const AttitudeModel& model = chosen.fit.best.model;
  const Disturbance& d = model.disturbances[disturbance];
  const Mat3 fitted =
      model.platform.inertia_kg_m2 + find_kind(d.kind)->screening.inertia_change_kg_m2(d);
  try {
    check_inertia(fitted, {}, "inertia_kg_m2");
    return true;
  } catch (const InputError&) {
    return false;
  }
}

Replay replay_of(const Fit& fit, const Observation& seen) {
  Replay replay;
  replay.recording = seen.name;
  replay.has_commands = is_commanded(seen.schedule);
  replay.duration_s = seen.duration_s();
  replay.output_rate_Hz = static_cast<double>(seen.blocks() - 1) / seen.duration_s();
  const PlatformState& initial = fit.best.runs.front().initial;
  const Quat& q = initial.lab_from_body;
  replay.initial_attitude = {q.w(), q.x(), q.y(), q.z()};
  const auto counts_turns = [](const Disturbance& d) {
    return std::ranges::any_of(d.states, &ExtraState::is_turned_angle);
  };
  if (std::ranges::any_of(fit.best.model.disturbances, counts_turns)) {
    const double angle_rad = fit.best.model.platform.axis.dot(turn_vector(q));
    replay.initial_turns = std::round((fit.best.runs.front().turned_rad - angle_rad) / (2.0 * pi));
  }
  replay.initial_rate_rad_s = initial.rate_body_rad_s;
  replay.initial_time_s = initial.time_s;
  replay.initial_charge_C = initial.charge_drawn_C;
  const int place = Dynamics(fit.best.model).first_of_translation();
  if (place >= 0) {
    std::array<double, 4>& four = replay.initial_place_m_m_s.emplace();
    std::copy_n(initial.extra.begin() + (place - component::extra), 4, four.begin());
  }
  return replay;
}

}  // namespace

Diagnosis diagnose(const NominalModel& stated, const std::vector<NamedRecording>& recordings,
                   const std::vector<NamedRecording>& holdouts, const DiagnoseOptions& options) {
  if (recordings.empty()) throw InputError({}, "--recording", "none", "at least one recording");
  RecordedData data = read_data(stated, recordings, holdouts, options);
  const NominalModel nominal = as_seen(stated, data);
  report_step(options, "fitting the nominal model");
  Fit nominal_fit = settle(nominal, options.limits, data);
  Answer answer = explain(nominal, data, options, nominal_fit);
  if (!answer.rest_is_noise) {
    Trial& chosen = answer.trials[answer.decision.chosen];
    chosen = within_physics(chosen, answer.all, data.train);
  }
  Diagnosis d;
  report_explanation(answer, nominal_fit, data, options, d);
  if (nominal.uncertain_inertia && is_an_inertia(answer.chosen(), *nominal.uncertain_inertia)) {
    d.unnamed.push_back(as_fitted(answer.chosen(), *nominal.uncertain_inertia));
  }
  report_fit_quality(nominal_fit, answer, data, options.limits, d);
  d.warnings = data.warnings;
  for (const InstrumentFinding& finding : data.instruments) d.warnings.push_back(finding.text);
  if (answer.decision.undecided) d.warnings.emplace_back(undecided_effect);
  report_gains_over_segments(answer, d);
  warn_of_weak_holdout(d);
  explain_unit_inertia(stated.model.platform, d);
  // The parameters of a model that does not describe the recording have no meaning.
  if (d.verdict != Verdict::unexplained ||
      !inference::has_diverged(answer.chosen(), options.limits)) {
    std::ranges::copy(contradicted_priors(answer.chosen(), options.limits.decision),
                      std::back_inserter(d.warnings));
  }
  if (!answer.all.remark.empty() && !d.effects.empty()) d.warnings.push_back(answer.all.remark);
  d.instruments = data.instruments;
  for (InstrumentFinding& finding : clock_findings(stated.model.platform, data)) {
    d.warnings.insert(d.warnings.begin(), finding.text);
    d.instruments.push_back(std::move(finding));
  }
  d.bodies = different_bodies(stated.model.platform, data);
  if (!d.bodies.empty()) d.warnings.insert(d.warnings.begin(), sentence_of(d.bodies));
  d.data = quality_of(recordings, holdouts, data);
  d.replay = replay_of(answer.chosen().fit, data.train.front());
  d.sentence = sentence_of(d);
  if (!d.bodies.empty())
    d.sentence +=
        " The recordings are of " + std::to_string(d.bodies.size()) + " different bodies.";
  return d;
}

}  // namespace photorque
