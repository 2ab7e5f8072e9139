#include "diagnosis/light/module/diagnose.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

#include "core/errors.h"
#include "core/parallel.h"
#include "diagnosis/light/module/fit.h"
#include "diagnosis/light/module/plausible.h"
#include "diagnosis/verdict.h"
#include "inference/whiteness.h"

namespace photorque {
namespace {

using Eigen::Index, Eigen::VectorXd;

struct ModuleData {
  std::vector<ModuleRun> train, held;
  std::vector<ModuleRun> whole;  // every curve with all its points
  DataQuality quality;
};

ModuleRun run_of(const LightRecording& r, const ModuleDesign& design, const ModuleNominal& nominal,
                 const ModuleDiagnoseOptions& options, DataQuality& quality) {
  int64_t dropped = 0;
  require_current_forward(r);
  ModuleRun run{module_sweep(r, design, options.max_points, &dropped)};
  run.sweep.temperature_K = r.has_temperatures ? median_of(r.temperature_K) : design.temperature_K;
  run.irradiance_W_m2 = median_of(r.irradiance_W_m2);
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

// The points of a curve in segments of `block` of them for which `is_held` says no, and the others.
std::pair<ModuleRun, ModuleRun> split_curve(const ModuleRun& run, size_t block,
                                            const std::function<bool(size_t segment)>& is_held) {
  ModuleRun train = run, held = run;
  for (ModuleRun* r : {&train, &held}) {
    r->sweep.voltage_V.clear();
    r->sweep.current_A.clear();
  }
  for (size_t i = 0; i < run.sweep.voltage_V.size(); ++i) {
    ModuleRun& to = is_held(i / block) ? held : train;
    to.sweep.voltage_V.push_back(run.sweep.voltage_V[i]);
    to.sweep.current_A.push_back(run.sweep.current_A[i]);
  }
  return {std::move(train), std::move(held)};
}

// Every fourth segment, each a fortieth of the curve.
std::pair<ModuleRun, ModuleRun> split_curve(const ModuleRun& run) {
  return split_curve(run, std::max<size_t>(1, run.sweep.voltage_V.size() / 40),
                     [](size_t segment) { return segment % 4 == 2; });
}

// χ² of segments of the curves, each predicted from a fit that left out a fifth of the segments.
// A segment holds several parts of every curve, because damage changes a part of a curve.
std::vector<double> chi2_of_segments(const ModuleFitter& fitter, const ModuleHypothesis& h,
                                     const ModuleTrial& trial, const std::vector<ModuleRun>& runs,
                                     const Thresholds& limits) {
  constexpr size_t folds = 5, parts = 3;
  const size_t count = limits.discrepancy.stretches;
  std::vector<double> chi2(count, 0.0);
  const auto block_of = [&](const ModuleRun& run) {
    return std::max<size_t>(1, run.sweep.voltage_V.size() / (count * parts));
  };
  for (size_t fold = 0; fold < folds; ++fold) {
    std::vector<ModuleRun> rest;
    for (const ModuleRun& run : runs) {
      rest.push_back(split_curve(run, block_of(run), [&](size_t segment) {
                       return segment % count % folds == fold;
                     }).first);
    }
    const ModuleTrial others = fitter.fit(h, rest, &trial.shared);
    for (size_t run = 0; run < runs.size(); ++run) {
      const VectorXd r = fitter.residuals(h, ModuleFitter::numbers_of(others, run), runs[run]);
      for (Index i = 0; i < r.size(); ++i) {
        const size_t segment = static_cast<size_t>(i) / block_of(runs[run]) % count;
        if (segment % folds == fold) chi2[segment] += r[i] * r[i];
      }
    }
  }
  return chi2;
}

struct ModuleAnswer {
  std::vector<ModuleHypothesis> hypotheses;
  std::vector<ModuleTrial> trials, joint;
  inference::Decision decision;
};

// Excess of the residuals of a fit over noise [sigma].
double excess_of(const ModuleFitter& fitter, const ModuleHypothesis& h, const ModuleTrial& trial,
                 const std::vector<ModuleRun>& runs, const Thresholds& limits) {
  std::vector<inference::ChannelResiduals> channels;
  for (size_t run = 0; run < runs.size(); ++run) {
    const VectorXd r = fitter.residuals(h, ModuleFitter::numbers_of(trial, run), runs[run]);
    channels.push_back({{r.data(), r.data() + r.size()}});
  }
  const double samples = static_cast<double>(trial.fit.samples);
  return std::max(inference::whiteness(channels, limits.noise).excess_sigma,
                  (trial.fit.data_chi2 / samples - 1.0) / std::sqrt(2.0 / samples));
}

// The χ² of what one diode and its translation leave of healthy curves: their errors, which the
// standard deviations of the points count once in a length of correlation.
double chi2_of_healthy(const ModuleNominal& nominal, const std::vector<ModuleRun>& runs) {
  double chi2 = 0.0;
  for (const ModuleRun& run : runs) {
    chi2 += static_cast<double>(run.sweep.voltage_V.size()) *
            std::pow(point_rms_A(nominal, run.sweep) / run.sigma_A, 2);
  }
  return chi2;
}

// Whether the largest number of cells of a kind that was tried is beyond doubt more likely than
// fewer: then the effect spreads over the module in a way that this kind only imitates.
bool is_at_largest_count(const ModuleAnswer& answer, const std::string& kind,
                         double min_log_evidence_gain) {
  double largest = -INFINITY, fewer = -INFINITY;
  int most = 0;
  for (size_t i = 0; i < answer.hypotheses.size(); ++i) {
    const ModuleHypothesis& h = answer.hypotheses[i];
    if (h.kind != kind || h.count == 0) continue;
    most = h.largest_count;
    double& best = h.count == h.largest_count ? largest : fewer;
    best = std::max(best, answer.joint[i].log_evidence);
  }
  return most > 1 && largest > fewer + min_log_evidence_gain;
}

// The hypotheses of one kind, which differ in their number of cells, fitted to curves.
struct Family {
  std::vector<ModuleHypothesis> hypotheses;
  std::vector<ModuleTrial> trials;
};

std::vector<Family> families_of(const std::vector<ModuleHypothesis>& hypotheses) {
  std::vector<Family> families;
  for (const ModuleHypothesis& h : hypotheses) {
    const bool is_next =
        !families.empty() && h.count > 0 && families.back().hypotheses.back().kind == h.kind;
    if (!is_next) families.emplace_back();
    families.back().hypotheses.push_back(h);
  }
  return families;
}

// Log evidence behind the best from which a number of cells is hopeless.
constexpr double hopeless = 60.0;

// By rising numbers of cells, until two in turn are hopeless beside the best.
void fit_family(const ModuleFitter& fitter, const std::vector<ModuleRun>& runs, Family& family) {
  double best = -INFINITY;
  int behind = 0;
  for (const ModuleHypothesis& h : family.hypotheses) {
    family.trials.push_back(fitter.fit(h, runs));
    const double evidence = family.trials.back().log_evidence;
    best = std::max(best, evidence);
    behind = evidence < best - hopeless ? behind + 1 : 0;
    if (behind == 2) break;
  }
}

const ModuleTrial& best_of(const Family& family) {
  return *std::ranges::max_element(family.trials, {}, &ModuleTrial::log_evidence);
}

// Where shaded cells are no worse than `least`, cracked ones that look like them.
void add_crack_like_shade(const ModuleFitter& fitter, const ModuleDesign& design,
                          const ModuleNominal& nominal, const std::vector<ModuleRun>& runs,
                          double least, std::vector<Family>& families) {
  const auto of = [&](const std::string& kind) {
    return std::ranges::find_if(families,
                                [&](const Family& f) { return f.hypotheses.front().kind == kind; });
  };
  const auto shaded = of("cell_shaded"), cracked = of("cell_cracked");
  if (shaded == families.end() || cracked == families.end()) return;
  const ModuleTrial& trial = best_of(*shaded);
  if (!(trial.log_evidence > least)) return;
  const ModuleHypothesis& h =
      shaded->hypotheses[static_cast<size_t>(&trial - shaded->trials.data())];
  const size_t own = h.parameters.size();
  const double* first = trial.shared.data() + trial.shared.size() - own;
  Family like{{cracked_like(design, nominal, h, {first, own}, cracked->hypotheses.front())}, {}};
  like.trials.push_back(fitter.fit(like.hypotheses.front(), runs));
  families.push_back(std::move(like));
}

// Fits all hypotheses but the first, which is fitted, to the curves for training; the best of each
// kind and those that are not hopeless beside the best of all then to all.
void fit_effects(const ModuleFitter& fitter, const ModuleDesign& design,
                 const ModuleNominal& nominal, const std::vector<ModuleHypothesis>& hypotheses,
                 const std::vector<ModuleRun>& train, const std::vector<ModuleRun>& everything,
                 int threads, ModuleAnswer& answer) {
  std::vector<Family> families = families_of({hypotheses.begin() + 1, hypotheses.end()});
  parallel_for(families.size(), threads, [&](size_t i) { fit_family(fitter, train, families[i]); });
  double best = -INFINITY;
  for (const Family& family : families) best = std::max(best, best_of(family).log_evidence);
  add_crack_like_shade(fitter, design, nominal, train, best - hopeless, families);
  for (Family& family : families) {
    const double of_kind = best_of(family).log_evidence;
    for (size_t i = 0; i < family.trials.size(); ++i) {
      const double own = family.trials[i].log_evidence;
      if (own < of_kind && own < best - hopeless) continue;
      answer.hypotheses.push_back(std::move(family.hypotheses[i]));
      answer.trials.push_back(std::move(family.trials[i]));
    }
  }
  answer.joint.resize(answer.trials.size());
  parallel_for(answer.trials.size() - 1, threads, [&](size_t i) {
    answer.joint[i + 1] =
        fitter.fit(answer.hypotheses[i + 1], everything, &answer.trials[i + 1].shared);
  });
}

// `hypotheses`: the first is that nothing is missing.
ModuleAnswer explain_module(const ModuleDesign& design, const ModuleNominal& nominal,
                            const std::vector<ModuleHypothesis>& hypotheses, const ModuleData& data,
                            const ModuleDiagnoseOptions& options) {
  ModuleAnswer answer;
  const ModuleFitter fitter(design, nominal, options.limits);
  std::vector<ModuleRun> everything = data.train;
  everything.insert(everything.end(), data.held.begin(), data.held.end());
  answer.hypotheses = {hypotheses.front()};
  answer.trials = {fitter.fit(hypotheses.front(), data.train)};
  answer.joint = {fitter.fit(hypotheses.front(), everything, &answer.trials.front().shared)};
  // Within the error of one diode and of its translation nothing can be said to act: χ² up to one
  // per point, or to four times what healthy curves leave.
  constexpr double of_healthy = 4.0;
  const inference::Fit& as_it_was = answer.joint.front().fit;
  const bool leaves_more =
      !(as_it_was.data_chi2 <= std::min(static_cast<double>(as_it_was.samples),
                                        of_healthy * chi2_of_healthy(nominal, everything)));
  if (leaves_more) {
    fit_effects(fitter, design, nominal, hypotheses, data.train, everything, options.threads,
                answer);
  }
  const size_t count = answer.hypotheses.size();
  std::vector<inference::CandidateTraits> traits(count);
  for (size_t i = 0; i < count; ++i) {
    const ModuleHypothesis& h = answer.hypotheses[i];
    traits[i].name = h.kind.empty() ? h.label : h.kind;
    traits[i].is_empirical =
        h.is_empirical ||
        is_at_largest_count(answer, h.kind, options.limits.search.min_log_evidence_gain);
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
  const auto gain = [&](size_t trial, size_t) -> std::optional<double> {
    const auto chi2 = [&](size_t of) {
      return chi2_of_segments(fitter, answer.hypotheses[of], answer.joint[of], data.whole,
                              options.limits);
    };
    return inference::gain_sigma(chi2(0), chi2(trial));
  };
  const auto excess = [&](size_t trial) {
    return excess_of(fitter, answer.hypotheses[trial], answer.trials[trial], data.train,
                     options.limits);
  };
  answer.decision = inference::decide({answer.trials.begin(), answer.trials.end()}, traits,
                                      {excess, gain}, options.limits.decision);
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
    if (effect.parameters.empty() || effect.parameters.back().key != number.key) {
      effect.parameters.push_back({number.key, {}, {}});
    }
    effect.parameters.back().value.push_back(number.value(x));
    effect.parameters.back().sigma.push_back(std::sqrt(variance));
  }
  int fewest = h.count, most = h.count;
  // A model of damage describes what the damage does to about 1 %, χ² to a ten-thousandth.
  constexpr double model_error = 1e-4;
  const double likely = answer.trials[chosen].log_evidence;
  // A residual above the noise that all models leave widens the limit.
  const double beyond_noise =
      std::max(1.0, joint.fit.data_chi2 / static_cast<double>(joint.fit.samples));
  const double within = std::max(limits.search.min_log_evidence_gain * beyond_noise,
                                 model_error * (likely - answer.trials.front().log_evidence));
  // A cell in the shade and one with a part cut off differ by some hundredths of a volt, which the
  // model of the other cells does not describe.
  constexpr double cut_off_or_dark = 5e-3;
  const double between_them = std::max(
      within, std::min(hopeless, cut_off_or_dark * (likely - answer.trials.front().log_evidence)));
  const auto is_dim = [](const std::string& kind) {
    return kind == "cell_shaded" || kind == "cell_cracked";
  };
  for (size_t i = 0; i < answer.trials.size(); ++i) {
    const double behind = likely - answer.trials[i].log_evidence;
    const bool are_dim = is_dim(h.kind) && is_dim(answer.hypotheses[i].kind);
    if (behind > (are_dim ? between_them : within)) continue;
    if (i == chosen || answer.hypotheses[i].kind.empty()) continue;
    if (answer.hypotheses[i].kind == h.kind) {
      if (behind > limits.search.min_log_evidence_gain) continue;
      fewest = std::min(fewest, answer.hypotheses[i].count);
      most = std::max(most, answer.hypotheses[i].count);
      continue;
    }
    std::vector<std::string>& rivals = effect.indistinguishable_from;
    const std::string& kind = answer.hypotheses[i].kind;
    if (std::ranges::find(rivals, kind) == rivals.end()) rivals.push_back(kind);
  }
  if (most > fewest) {
    effect.texts.emplace_back("count_between",
                              std::to_string(fewest) + " and " + std::to_string(most));
  }
  effect.probability = answer.decision.names.front().probability;
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
                                    of_train ? run : data.train.size() + run, data.held[run]);
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

// Whether a curve is both a reference and a recording. Its deviation from one diode would then
// count as noise, so that no effect would be found.
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
        "only another curve or a datasheet can show missing effects");
  }
  if (!own || !uneven || d.verdict != Verdict::consistent) return;
  d.verdict = Verdict::unexplained;
  d.because = std::string("the curve is its own reference, and one diode describes it only to ") +
              percent + " of its short-circuit current";
}

// The answer to curves in words and numbers.
Diagnosis described(const ModuleDesign& design, const ModuleNominal& nominal,
                    const ModuleAnswer& answer, const ModuleData& data, const Thresholds& limits) {
  const ModuleFitter fitter(design, nominal, limits);
  Diagnosis d;
  d.effect_table = "effect";
  d.verdict = verdict_of(answer.decision.finding);
  d.confidence = answer.decision.confidence;
  d.because = answer.decision.because;
  const size_t chosen = answer.decision.chosen;
  if (d.verdict == Verdict::missing_physics) {
    d.effects.push_back(found_in_module(answer, chosen, limits));
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
  if (!answer.decision.held_out_tests_names) d.warnings.push_back(untested_names(held));
  if (answer.decision.undecided) {
    d.warnings.push_back("something is missing, but not which effect it is: see the alternatives");
  }
  return d;
}

// A curve alone.
ModuleData of_one_curve(const ModuleRun& whole) {
  ModuleData data;
  auto [train, held] = split_curve(whole);
  data.train.push_back(std::move(train));
  data.held.push_back(std::move(held));
  data.whole.push_back(whole);
  return data;
}

// Every curve alone: the nominal model first, and all hypotheses where that leaves something.
// `light`: of each over the reference, by the nominal model.
std::vector<Diagnosis> each_curve(const ModuleDesign& design, const ModuleNominal& nominal,
                                  const ModuleData& all, const ModuleDiagnoseOptions& options,
                                  std::vector<double>& light) {
  const std::vector<ModuleHypothesis> hypotheses = module_hypotheses(design, nominal);
  std::vector<Diagnosis> each;
  for (const ModuleRun& curve : all.whole) {
    const ModuleData data = of_one_curve(curve);
    ModuleAnswer answer = explain_module(design, nominal, {hypotheses.front()}, data, options);
    light.push_back(std::exp(answer.trials.front().fit.at[0]));
    const bool is_odd = answer.decision.finding != inference::Finding::nothing_missing;
    if (is_odd) answer = explain_module(design, nominal, hypotheses, data, options);
    each.push_back(described(design, nominal, answer, data, options.limits));
    Diagnosis& d = each.back();
    const std::string name = std::filesystem::path(curve.sweep.name).filename().string();
    for (FoundEffect& effect : d.effects) effect.texts.emplace_back("curve", name);
    for (Alternative& alternative : d.alternatives) alternative.of = name;
    d.sentence = name + ": " + module_sentence(d);
  }
  return each;
}

// Root of the mean square of two, of so many samples each.
void add_rms(const Holdout& more, Holdout& all) {
  const auto mean = [&](double a, double b) {
    const auto m = static_cast<double>(all.samples), n = static_cast<double>(more.samples);
    return (m * a + n * b) / (m + n);
  };
  for (const auto member : {&Holdout::rms_before, &Holdout::rms_after}) {
    double& rms = (all.*member)["current_A"];
    rms = std::sqrt(mean(rms * rms, std::pow((more.*member).at("current_A"), 2)));
  }
  all.chi2_per_sample_before = mean(all.chi2_per_sample_before, more.chi2_per_sample_before);
  all.chi2_per_sample_after = mean(all.chi2_per_sample_after, more.chi2_per_sample_after);
  const bool is_worse =
      more.predictive && (!all.predictive || more.predictive->sigma > all.predictive->sigma);
  if (is_worse) all.predictive = more.predictive;
  all.samples += more.samples;
}

// Curves that were diagnosed one by one, as one answer.
Diagnosis of_all_curves(std::vector<Diagnosis> each) {
  Diagnosis all;
  all.effect_table = "effect";
  all.confidence = 1.0;
  all.holdout.emplace();
  int64_t samples = 0;
  size_t differing = 0;
  for (Diagnosis& d : each) {
    const auto n = static_cast<double>(d.samples), m = static_cast<double>(samples);
    all.chi2_per_sample_before =
        (m * all.chi2_per_sample_before + n * d.chi2_per_sample_before) / (m + n);
    all.chi2_per_sample_after =
        (m * all.chi2_per_sample_after + n * d.chi2_per_sample_after) / (m + n);
    samples += d.samples;
    add_rms(*d.holdout, *all.holdout);
    all.confidence = std::min(all.confidence, d.confidence);
    if (d.verdict == Verdict::consistent) continue;
    ++differing;
    all.sentence += (all.sentence.empty() ? "" : " ") + d.sentence;
    if (d.verdict == Verdict::unexplained) {
      all.verdict = Verdict::unexplained;
      all.because = "of one curve or more: " + d.because;
    } else if (all.verdict == Verdict::consistent) {
      all.verdict = Verdict::missing_physics;
    }
    for (FoundEffect& effect : d.effects) all.effects.push_back(std::move(effect));
    constexpr size_t most = 6;
    d.alternatives.resize(std::min(most, d.alternatives.size()));
    for (Alternative& a : d.alternatives) all.alternatives.push_back(std::move(a));
    for (std::string& warning : d.warnings) all.warnings.push_back(std::move(warning));
  }
  all.samples = samples;
  all.where.channels.push_back({"current_A", all.chi2_per_sample_before});
  all.holdout->explained_fraction =
      explained_fraction(all.holdout->chi2_per_sample_before, all.holdout->chi2_per_sample_after,
                         all.holdout->samples);
  const std::string count = std::to_string(each.size());
  all.sentence = differing == 0
                     ? "Nothing is missing in any of " + count +
                           " curves: what differs is noise, or lies within what one diode and its "
                           "translation to other light and temperature can describe."
                     : std::to_string(differing) + " of " + count +
                           " curves differ from the module as it was. " + all.sentence;
  return all;
}

// Adds how the light of the curves goes with what a sensor saw: a line through the logarithm of
// their ratio over the order of the curves, by Theil and Sen, which a few curves under a cloud do
// not move. Without the irradiance of the reference the ratio counts from its median.
void compare_with_sensor(const ModuleDesign& design, const std::vector<ModuleRun>& curves,
                         const std::vector<double>& light, Diagnosis& d) {
  std::vector<double> order, ratio;
  for (size_t i = 0; i < curves.size(); ++i) {
    if (!(curves[i].irradiance_W_m2 > 0.0)) continue;
    order.push_back(static_cast<double>(i));
    ratio.push_back(std::log(light[i] / curves[i].irradiance_W_m2));
  }
  constexpr size_t fewest = 5;
  if (ratio.size() < fewest) return;
  const std::vector<double>& stated = design.reference_irradiances_W_m2;
  const bool is_absolute = !stated.empty() && stated.front() > 0.0;
  const double unit = is_absolute ? -std::log(stated.front()) : median_of(ratio);
  std::vector<double> slopes, off;
  for (size_t i = 0; i < ratio.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      slopes.push_back((ratio[i] - ratio[j]) / (order[i] - order[j]));
    }
  }
  const double slope = median_of(slopes);
  for (size_t i = 0; i < ratio.size(); ++i) off.push_back(ratio[i] - slope * order[i]);
  const double level = median_of(off);
  for (double& x : off) x = std::abs(x - level);
  constexpr double of_median = 0.6745;  // of a normal variable's standard deviation
  const double scatter = median_of(off) / of_median;
  const auto at = [&](double i) { return std::exp(level + slope * i - unit); };
  // The error of the slope of a line through n points, one apart: scatter √(12/n³).
  const auto n = static_cast<double>(ratio.size());
  const double sigma = std::abs(slope) / std::max(1e-9, scatter * std::sqrt(12.0 / (n * n * n)));
  char text[400];
  std::snprintf(
      text, sizeof text,
      "light over irradiance_W_m2%s goes from %.3f at the first curve to %.3f at the last "
      "(a line over their order, %.1f standard errors), and scatters by %.2g %%: angle of "
      "incidence, dirt, spectrum or the sensor, not the cells",
      is_absolute ? "" : ", over its median,", at(order.front()), at(order.back()), sigma,
      100.0 * scatter);
  d.warnings.emplace_back(text);
  constexpr double beyond_doubt = 4.0, far = 6.0;
  if (sigma > beyond_doubt) {
    const double moved = std::abs(slope) * (order.back() - order.front());
    d.where.depends_on.push_back({"time", moved / (moved + scatter)});
  }
  for (size_t i = 0; i < ratio.size(); ++i) {
    if (off[i] < far * scatter) continue;
    const ModuleRun& curve = curves[static_cast<size_t>(order[i])];
    std::snprintf(text, sizeof text, "%s: light over irradiance_W_m2 is %.3f, off that line",
                  std::filesystem::path(curve.sweep.name).filename().string().c_str(),
                  std::exp(ratio[i] - unit));
    d.warnings.emplace_back(text);
  }
}

}  // namespace

Diagnosis diagnose_module(const ModuleDesign& design, const std::vector<LightRecording>& recordings,
                          const std::vector<LightRecording>& holdouts,
                          const ModuleDiagnoseOptions& options) {
  if (recordings.empty()) throw InputError({}, "--recording", "none", "at least one recording");
  const ModuleNominal nominal = nominal_module(design);
  ModuleData data;
  const auto read = [&](const std::vector<LightRecording>& files, std::vector<ModuleRun>& runs) {
    for (const LightRecording& file : files) {
      require_curve(file);
      for (const LightRecording& curve : sweeps_of(file)) {
        runs.push_back(run_of(curve, design, nominal, options, data.quality));
        data.whole.push_back(runs.back());
      }
    }
  };
  read(recordings, data.train);
  read(holdouts, data.held);
  if (data.held.empty()) {
    for (ModuleRun& run : data.train) {
      auto [train, held] = split_curve(run);
      run = std::move(train);
      data.held.push_back(std::move(held));
    }
  }
  // Curves of which some differ and others do not, or more than a joint fit is made for, are
  // explained one by one.
  constexpr size_t few = 4;
  Diagnosis d;
  bool is_done = false;
  if (holdouts.empty() && data.whole.size() > 1) {
    std::vector<double> light;
    std::vector<Diagnosis> each = each_curve(design, nominal, data, options, light);
    const auto differing = static_cast<size_t>(std::ranges::count_if(
        each, [](const Diagnosis& one) { return one.verdict != Verdict::consistent; }));
    const bool is_even = differing == 0 || differing == each.size();
    is_done = !is_even || each.size() > few;
    if (is_done) {
      d = of_all_curves(std::move(each));
      compare_with_sensor(design, data.whole, light, d);
    }
  }
  if (!is_done) {
    const ModuleAnswer answer =
        explain_module(design, nominal, module_hypotheses(design, nominal), data, options);
    d = described(design, nominal, answer, data, options.limits);
    d.sentence = module_sentence(d);
  }
  d.data = data.quality;
  const Verdict before = d.verdict;
  judge_references(design, nominal, recordings, d);
  if (d.verdict != before) d.sentence = module_sentence(d);
  return d;
}

}  // namespace photorque
