#include "diagnosis/light/module/diagnose.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/constants.h"
#include "core/errors.h"
#include "core/parallel.h"
#include "diagnosis/light/module/fit.h"
#include "diagnosis/verdict.h"
#include "inference/whiteness.h"

namespace photorque {
namespace {

using Eigen::Index, Eigen::VectorXd;

struct ModuleData {
  std::vector<ModuleRun> train, held;
  DataQuality quality;
};

// The light of a curve over the reference's, as currents at low voltage say.
double light_of(const ModuleSweep& sweep, const ModuleNominal& nominal) {
  double best = 0.0, nearest = 1e300;
  for (size_t i = 0; i < sweep.voltage_V.size(); ++i) {
    if (std::abs(sweep.voltage_V[i]) > nearest) continue;
    nearest = std::abs(sweep.voltage_V[i]);
    best = sweep.current_A[i];
  }
  return std::max(best / nominal.cell.photocurrent_A, 1e-3);
}

// What no light and no temperature does to a module: the columns are not what their header says.
void require_plausible(const ModuleSweep& sweep, const ModuleDesign& design,
                       const ModuleNominal& nominal) {
  const ModuleCell& cell = nominal.cell;
  const double thermal_V = boltzmann_J_K * cell.temperature_K / elementary_charge_C;
  const double open_V = design.cells * cell.ideality * thermal_V *
                        std::log1p(cell.photocurrent_A / cell.saturation_A);
  const double light = light_of(sweep, nominal);
  double seen_V = 0.0;  // the largest voltage at which it still gives current
  for (size_t i = 0; i < sweep.voltage_V.size(); ++i) {
    if (sweep.current_A[i] >= 0.0) seen_V = std::max(seen_V, sweep.voltage_V[i]);
  }
  char found[160];
  constexpr double most_suns = 20.0, most_V = 1.25;
  if (light > most_suns) {
    std::snprintf(found, sizeof found, "%.3g times the current of the module as it was", light);
    throw InputError({sweep.name}, "current_A", found,
                     "amperes (a column in milliamperes is named current_mA)");
  }
  if (seen_V > most_V * open_V) {
    std::snprintf(found, sizeof found,
                  "%.3g V at a current, where the module as it was gives %.3g V at none", seen_V,
                  open_V);
    const double exchanged = light * cell.photocurrent_A / open_V;
    constexpr double alike = 0.15;
    throw InputError({sweep.name}, "voltage_V", found,
                     std::abs(exchanged - 1.0) < alike
                         ? "the voltage: the columns of voltage and current look exchanged"
                         : "volts of the module of the experiment (a column in millivolts is named "
                           "voltage_mV)");
  }
}

void require_current_forward(const LightRecording& r) {
  double nearest_V = INFINITY, short_A = 0.0;
  for (size_t i = 0; i < r.rows(); ++i) {
    if (std::abs(r.voltage_V[i]) > nearest_V) continue;
    nearest_V = std::abs(r.voltage_V[i]);
    short_A = r.current_A[i];
  }
  double largest_A = 0.0;
  for (const double current_A : r.current_A) largest_A = std::max(largest_A, std::abs(current_A));
  if (short_A > -0.5 * largest_A) return;
  throw InputError(
      {r.name}, "current_A", "a negative current at the smallest voltage",
      "currents that a lit module gives as positive numbers: the sign of the column is "
      "reversed");
}

ModuleRun run_of(const LightRecording& r, const ModuleDesign& design, const ModuleNominal& nominal,
                 const ModuleDiagnoseOptions& options, DataQuality& quality) {
  if (r.kind != LightRecording::Kind::sweep) {
    throw InputError({r.name}, "header", "no columns voltage_V,current_A",
                     "a current-voltage curve, for an experiment with [module]");
  }
  int64_t dropped = 0;
  require_current_forward(r);
  ModuleRun run{module_sweep(r, design, options.max_points, &dropped)};
  require_plausible(run.sweep, design, nominal);
  run.sweep.light = light_of(run.sweep, nominal);
  run.sigma_A = point_sigma_A(nominal, run.sweep);
  quality.rows += r.rows_read;
  for (const auto& [reason, count] : r.rejected) quality.rejected[reason] += count;
  if (dropped > 0) quality.rejected["outlier"] += dropped;
  quality.used += static_cast<int64_t>(run.sweep.voltage_V.size());
  const auto left =
      static_cast<int64_t>(r.rows()) - dropped - static_cast<int64_t>(run.sweep.voltage_V.size());
  if (left > 0) quality.rejected["left out of a long recording"] += left;
  return run;
}

// Every fourth stretch of a curve, each a fortieth of it.
std::pair<ModuleRun, ModuleRun> split_curve(const ModuleRun& run) {
  ModuleRun train = run, held = run;
  for (ModuleRun* r : {&train, &held}) {
    r->sweep.voltage_V.clear();
    r->sweep.current_A.clear();
  }
  const size_t rows = run.sweep.voltage_V.size(), stretch = std::max<size_t>(1, rows / 40);
  for (size_t i = 0; i < rows; ++i) {
    ModuleRun& to = (i / stretch) % 4 == 2 ? held : train;
    to.sweep.voltage_V.push_back(run.sweep.voltage_V[i]);
    to.sweep.current_A.push_back(run.sweep.current_A[i]);
  }
  return {std::move(train), std::move(held)};
}

struct ModuleAnswer {
  std::vector<ModuleHypothesis> hypotheses;
  std::vector<ModuleTrial> trials, joint;
  inference::Decision decision;
};

ModuleAnswer explain_module(const ModuleDesign& design, const ModuleNominal& nominal,
                            const ModuleData& data, const ModuleDiagnoseOptions& options) {
  ModuleAnswer answer;
  answer.hypotheses = module_hypotheses(design, nominal);
  const ModuleFitter fitter(design, nominal, options.limits);
  std::vector<ModuleRun> everything = data.train;
  everything.insert(everything.end(), data.held.begin(), data.held.end());
  const size_t count = answer.hypotheses.size();
  answer.trials.resize(count);
  answer.joint.resize(count);
  parallel_for(count, options.threads, [&](size_t i) {
    answer.trials[i] = fitter.fit(answer.hypotheses[i], data.train);
    answer.joint[i] = fitter.fit(answer.hypotheses[i], everything, &answer.trials[i].shared);
  });
  std::vector<inference::CandidateTraits> traits(count);
  for (size_t i = 0; i < count; ++i) {
    const ModuleHypothesis& h = answer.hypotheses[i];
    traits[i].name = h.kind.empty() ? h.label : h.kind;
    traits[i].is_empirical = h.is_empirical;
    traits[i].parameters = h.parameters.size();
    if (i > 0) answer.trials[i].candidates = {i};
  }
  const inference::Fit &own = answer.trials.front().fit, &all = answer.joint.front().fit;
  for (size_t i = 0; i < count; ++i) {
    ModuleTrial &train = answer.trials[i], &joint = answer.joint[i];
    const double held = static_cast<double>(joint.fit.samples - train.fit.samples);
    inference::Predictive p;
    p.chi2_per_sample = (joint.fit.chi2 - train.fit.chi2) / held;
    p.log_score = joint.log_evidence - train.log_evidence;
    p.expected_chi2_per_sample = inference::expected_chi2_per_sample(train.fit, joint.fit);
    p.sigma = (p.chi2_per_sample - 1.0) /
              std::sqrt(2.0 / held + 2.0 / static_cast<double>(train.fit.samples));
    if (i > 0) {
      train.significance = {std::sqrt(std::max(0.0, own.chi2 - train.fit.chi2))};
      train.joint_significance = {std::sqrt(std::max(0.0, all.chi2 - joint.fit.chi2))};
    }
    train.holdout_chi2_per_sample = p.chi2_per_sample;
    train.predictive = p;
    train.log_evidence = joint.log_evidence;
  }
  const auto excess = [&](size_t trial) {
    std::vector<inference::ChannelResiduals> channels;
    for (size_t run = 0; run < data.train.size(); ++run) {
      const VectorXd r =
          fitter.residuals(answer.hypotheses[trial],
                           ModuleFitter::numbers_of(answer.trials[trial], run), data.train[run]);
      channels.push_back({{r.data(), r.data() + r.size()}});
    }
    const inference::Fit& fit = answer.trials[trial].fit;
    const double samples = static_cast<double>(fit.samples);
    return std::max(inference::whiteness(channels, options.limits.noise).excess_sigma,
                    (fit.data_chi2 / samples - 1.0) / std::sqrt(2.0 / samples));
  };
  answer.decision = inference::decide({answer.trials.begin(), answer.trials.end()}, traits, excess,
                                      options.limits.decision);
  return answer;
}

// Standard errors of the hypothesis' own parameters.
std::vector<double> own_errors(const ModuleTrial& trial, size_t own) {
  const Eigen::MatrixXd C = trial.fit.shared_posterior();
  std::vector<double> errors;
  for (size_t k = 0; k < own; ++k) {
    const Index at = C.rows() - static_cast<Index>(own) + static_cast<Index>(k);
    errors.push_back(std::sqrt(std::max(0.0, C(at, at))));
  }
  return errors;
}

FoundEffect found_in_module(const ModuleAnswer& answer, size_t chosen, const Thresholds& limits) {
  const ModuleHypothesis& h = answer.hypotheses[chosen];
  const ModuleTrial& joint = answer.joint[chosen];
  FoundEffect effect;
  effect.kind = h.kind;
  effect.explanation = h.explanation;
  if (h.count > 0) effect.parameters.push_back({"count", {static_cast<double>(h.count)}, {}});
  const size_t own = h.parameters.size();
  std::vector<double> x(joint.shared.data() + joint.shared.size() - own,
                        joint.shared.data() + joint.shared.size());
  const std::vector<double> errors = own_errors(joint, own);
  for (const ModuleHypothesis::Number& number : h.numbers) {
    double variance = 0.0;
    for (size_t k = 0; k < own; ++k) {
      std::vector<double> by = x;
      const double step = 1e-4;
      by[k] += step;
      variance += std::pow((number.value(by) - number.value(x)) / step * errors[k], 2);
    }
    effect.parameters.push_back({number.key, {number.value(x)}, {std::sqrt(variance)}});
  }
  double sum = 0.0, same = 0.0;
  int fewest = h.count, most = h.count;
  for (size_t i = 0; i < answer.trials.size(); ++i) {
    sum += answer.decision.probability[i];
    if (answer.hypotheses[i].kind == h.kind) same += answer.decision.probability[i];
    const bool as_likely = answer.trials[i].log_evidence >
                           answer.trials[chosen].log_evidence - limits.search.min_log_evidence_gain;
    if (!as_likely || i == chosen || answer.hypotheses[i].kind.empty()) continue;
    if (answer.hypotheses[i].kind == h.kind) {
      fewest = std::min(fewest, answer.hypotheses[i].count);
      most = std::max(most, answer.hypotheses[i].count);
      continue;
    }
    effect.indistinguishable_from.push_back(answer.hypotheses[i].kind);
  }
  if (most > fewest) {
    effect.texts.emplace_back("count_between",
                              std::to_string(fewest) + " and " + std::to_string(most));
  }
  effect.probability = sum > 0.0 ? same / sum : 0.0;
  return effect;
}

std::string module_sentence(const Diagnosis& d) {
  if (d.verdict == Verdict::consistent) {
    return "Nothing is missing: what differs is noise or lies within what one diode can describe.";
  }
  if (d.verdict == Verdict::unexplained) {
    return "Something acts that no effect of the catalogue explains (" + d.because + ").";
  }
  std::string name = d.effects.front().kind;
  std::ranges::replace(name, '_', ' ');
  return "Missing: " + name + " (" + d.effects.front().explanation + ").";
}

double squares_of(const ModuleFitter& fitter, const ModuleAnswer& answer, size_t trial,
                  const ModuleData& data) {
  double squares = 0.0, points = 0.0;
  for (size_t run = 0; run < data.held.size(); ++run) {
    const ModuleSweep& sweep = data.held[run].sweep;
    // Parts of curves that were fitted have their light and temperature.
    const bool of_train =
        data.held.size() == data.train.size() && data.train[run].sweep.name == sweep.name;
    const auto curve = fitter.curve(answer.hypotheses[trial],
                                    of_train ? answer.trials[trial] : answer.joint[trial],
                                    of_train ? run : data.train.size() + run, sweep.voltage_V);
    for (size_t i = 0; i < curve.size(); ++i, ++points) {
      squares += std::pow(curve[i].current_A - sweep.current_A[i], 2);
    }
  }
  return std::sqrt(squares / std::max(1.0, points));
}

// One diode describes modules in even light to 0.1 to 0.5 % of their short-circuit current (curves
// of docs/real_light.md and of measured modules of others), with a cell in the shade or a step to
// 0.8 % and more.
constexpr double even_misfit = 7e-3;

// A curve that is given as the module as it was and as a recording at once: what one diode cannot
// describe counts as noise, so nothing would be found.
bool is_its_own_reference(const ModuleDesign& design,
                          const std::vector<LightRecording>& recordings) {
  return std::ranges::any_of(recordings, [&](const LightRecording& r) {
    return std::ranges::any_of(design.references, [&](const LightRecording& reference) {
      return r.voltage_V == reference.voltage_V && r.current_A == reference.current_A;
    });
  });
}

void judge_references(const ModuleDesign& design, const ModuleNominal& nominal,
                      const std::vector<LightRecording>& recordings, Diagnosis& d) {
  const bool own = is_its_own_reference(design, recordings);
  const bool uneven = !design.references.empty() && nominal.misfit > even_misfit;
  char percent[40];
  std::snprintf(percent, sizeof percent, "%.2g %%", 100.0 * nominal.misfit);
  if (uneven) {
    d.warnings.push_back(std::string("one diode leaves ") + percent +
                         " of the short-circuit current of the reference itself, where even light "
                         "on like cells leaves 0.1 to 0.5 %: part of it may be shaded or damaged, "
                         "and what the recordings share with it cannot be found");
  }
  if (own) {
    d.warnings.push_back(
        "a recording is its own reference: what one diode cannot describe counts as noise, so that "
        "only another curve or a datasheet can show what is missing");
  }
  if (!own || !uneven || d.verdict != Verdict::consistent) return;
  d.verdict = Verdict::unexplained;
  d.because = std::string("the curve is its own reference, and one diode describes it only to ") +
              percent + " of its short-circuit current";
}

}  // namespace

Diagnosis diagnose_module(const ModuleDesign& design, const std::vector<LightRecording>& recordings,
                          const std::vector<LightRecording>& holdouts,
                          const ModuleDiagnoseOptions& options) {
  if (recordings.empty()) throw InputError({}, "--recording", "none", "at least one recording");
  const ModuleNominal nominal = nominal_module(design);
  ModuleData data;
  for (const LightRecording& r : recordings) {
    data.train.push_back(run_of(r, design, nominal, options, data.quality));
  }
  for (const LightRecording& r : holdouts) {
    data.held.push_back(run_of(r, design, nominal, options, data.quality));
  }
  if (data.held.empty()) {
    for (ModuleRun& run : data.train) {
      auto [train, held] = split_curve(run);
      run = std::move(train);
      data.held.push_back(std::move(held));
    }
  }
  const ModuleAnswer answer = explain_module(design, nominal, data, options);
  const ModuleFitter fitter(design, nominal, options.limits);
  Diagnosis d;
  d.effect_table = "effect";
  d.verdict = verdict_of(answer.decision.finding);
  d.confidence = answer.decision.confidence;
  d.because = answer.decision.because;
  const size_t chosen = answer.decision.chosen;
  if (d.verdict == Verdict::missing_physics) {
    d.effects.push_back(found_in_module(answer, chosen, options.limits));
  }
  const double least = answer.trials.front().log_evidence;
  for (size_t i = 0; i < answer.trials.size(); ++i) {
    const ModuleHypothesis& h = answer.hypotheses[i];
    Alternative a;
    if (!h.kind.empty()) a.kinds = {h.kind};
    a.label = h.label;
    a.log_evidence_relative = answer.trials[i].log_evidence - least;
    a.holdout_chi2_per_sample = answer.trials[i].holdout_chi2_per_sample;
    a.remark = answer.trials[i].objection;
    a.chosen = i == chosen;
    d.alternatives.push_back(std::move(a));
  }
  std::ranges::stable_sort(d.alternatives, [](const Alternative& a, const Alternative& b) {
    return a.log_evidence_relative > b.log_evidence_relative;
  });
  d.chi2_per_sample_before = answer.trials.front().fit.chi2_per_sample();
  d.chi2_per_sample_after = answer.trials[chosen].fit.chi2_per_sample();
  d.samples = answer.trials.front().fit.samples;
  d.where.channels.push_back({"current_A", d.chi2_per_sample_before});
  Holdout held;
  held.samples = answer.joint.front().fit.samples - d.samples;
  held.chi2_per_sample_before = answer.trials.front().predictive->chi2_per_sample;
  held.chi2_per_sample_after = answer.trials[chosen].predictive->chi2_per_sample;
  held.predictive = answer.trials[chosen].predictive;
  held.rms_before["current_A"] = squares_of(fitter, answer, 0, data);
  held.rms_after["current_A"] = squares_of(fitter, answer, chosen, data);
  held.explained_fraction =
      explained_fraction(held.chi2_per_sample_before, held.chi2_per_sample_after, held.samples);
  d.holdout = held;
  d.data = data.quality;
  if (answer.decision.undecided) {
    d.warnings.push_back("something is missing, but not which effect it is: see the alternatives");
  }
  judge_references(design, nominal, recordings, d);
  d.sentence = module_sentence(d);
  return d;
}

}  // namespace photorque
