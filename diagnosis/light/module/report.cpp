#include "diagnosis/light/module/explain.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <iterator>
#include <numeric>

#include "core/numerics/median.h"
#include "core/text/format.h"

namespace photorque {
namespace {

// Root mean square difference [A] of the held-out points from the curves of a trial.
double held_out_rms_A(const ModuleFitter& fitter, const ModuleAnswer& answer, size_t trial,
                      const ModuleData& data) {
  double squares = 0.0, points = 0.0;
  for (size_t run = 0; run < data.held.size(); ++run) {
    const ModuleSweep& sweep = data.held[run].sweep;
    // Held-out parts of fitted curves use the light and temperature from the fit of their curve.
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

// Fitted values and standard errors of some parameters of a hypothesis. `which`: their indices;
// `all`: the number of its parameters.
std::pair<std::vector<double>, std::vector<double>> own_numbers(const ModuleTrial& trial,
                                                                const std::vector<size_t>& which,
                                                                size_t all) {
  const Eigen::MatrixXd C = trial.fit.shared_posterior();
  std::vector<double> values, errors;
  for (const size_t k : which) {
    const auto from_end = static_cast<Eigen::Index>(all - k), at = C.rows() - from_end;
    values.push_back(trial.shared[trial.shared.size() - from_end]);
    errors.push_back(std::sqrt(std::max(0.0, C(at, at))));
  }
  return {std::move(values), std::move(errors)};
}

// Limit of the deficit in log evidence up to which one kind explains a curve as well as another:
// this part of the gain counts as an error of the model of the other cells.
struct Similarity {
  double part_of_gain = 0.0;
  double max_deficit = hopeless_log_evidence;
};

Similarity similarity_of(const std::string& kind, const std::string& other) {
  const auto are_among = [&](std::initializer_list<const char*> kinds) {
    return std::ranges::find(kinds, kind) != kinds.end() &&
           std::ranges::find(kinds, other) != kinds.end();
  };
  // Shaded cells and partly disconnected cells differ by some hundredths of a volt, and so does one
  // cell more or less. This is below the accuracy of the model of the other cells.
  if (are_among({"cell_shaded", "cell_cracked", "bypass_open"})) {
    return {5e-3, kind == other ? 0.5 * hopeless_log_evidence : hopeless_log_evidence};
  }
  if (kind == other) return {};
  // A leak and a disconnected part both lower the knee of a cell's curve. They differ by little
  // more than the scatter between cells.
  if (are_among({"cell_cracked", "cell_shunted"})) return {0.1};
  // Leaks, and light that falls while the voltage rises, both tilt the curve up to its knee. Beyond
  // the knee they differ by little more than the scatter of leaks.
  if (are_among({"shunt", "cell_shunted", "unsteady_light"})) return {0.25};
  return {};
}

// Other kinds that explain the curves as well in the place of candidate `which` of the chosen
// trial, and other numbers of its cells.
void add_equals(const ModuleAnswer& answer, size_t which, const Thresholds& limits,
                FoundEffect& effect) {
  const size_t chosen = answer.decision.chosen;
  const std::vector<size_t>& named = answer.trials[chosen].candidates;
  const ModuleHypothesis& h = answer.hypotheses[named[which]];
  int fewest = h.count, most = h.count;
  // Models of damage are accurate to about 1 %, which is a ten-thousandth of χ².
  constexpr double model_error = 1e-4;
  const ModuleTrial& joint = answer.joint[chosen];
  const double gain = joint.log_evidence - answer.joint.front().log_evidence;
  // A residual above the noise that all models leave widens the limit.
  const double beyond_noise =
      std::max(1.0, joint.fit.data_chi2 / static_cast<double>(joint.fit.samples));
  const double within =
      std::max(limits.search.min_log_evidence_gain * beyond_noise, model_error * gain);
  for (size_t i = 1; i < answer.trials.size(); ++i) {
    const std::vector<size_t>& others = answer.trials[i].candidates;
    if (i == chosen || others.size() != named.size()) continue;
    // All other candidates are those of the chosen trial.
    std::vector<size_t> rest = others;
    for (size_t k = 0; k < named.size(); ++k) {
      const auto same = k == which ? rest.end() : std::ranges::find(rest, named[k]);
      if (same != rest.end()) rest.erase(same);
    }
    if (rest.size() != 1) continue;
    const ModuleHypothesis& other = answer.hypotheses[rest.front()];
    const double behind = joint.log_evidence - answer.joint[i].log_evidence;
    const Similarity s = similarity_of(h.kind, other.kind);
    const double limit = std::max(within, std::min(s.max_deficit, s.part_of_gain * gain));
    if (behind > limit || other.kind.empty()) continue;
    if (other.kind == h.kind) {
      fewest = std::min(fewest, other.count);
      most = std::max(most, other.count);
      continue;
    }
    std::vector<std::string>& rivals = effect.indistinguishable_from;
    if (std::ranges::find(rivals, other.kind) == rivals.end()) rivals.push_back(other.kind);
  }
  // Two effects of one kind only approximate cells in many states, so the number of cells is
  // uncertain.
  if (named.size() == 2 && answer.hypotheses[named[1 - which]].kind == h.kind) {
    fewest = 1;
    most = h.largest_count;
  }
  if (most > fewest) {
    effect.texts.emplace_back("count_between",
                              std::to_string(fewest) + " and " + std::to_string(most));
  }
}

FoundEffect found_in_module(const ModuleAnswer& answer, size_t which, const Thresholds& limits) {
  const size_t chosen = answer.decision.chosen;
  const ModuleHypothesis& all = answer.hypotheses[chosen];
  const ModuleTrial& joint = answer.joint[chosen];
  const ModuleHypothesis& h = answer.hypotheses[answer.trials[chosen].candidates[which]];
  FoundEffect effect;
  effect.kind = h.kind;
  effect.explanation = h.explanation;
  if (h.count > 0) effect.parameters.push_back({"count", {static_cast<double>(h.count)}, {}});
  const size_t own = h.parameters.size();
  std::vector<size_t> at(own);
  std::iota(at.begin(), at.end(), size_t{0});
  if (!all.members.empty()) at = all.members[which].at;
  const auto [x, errors] = own_numbers(joint, at, all.parameters.size());
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
  add_equals(answer, which, limits, effect);
  effect.probability = answer.decision.names[which].probability;
  return effect;
}

// A curve with the nominal and the chosen model, each with its fitted light and temperature of the
// run.
RecordingSeries curve_of(const ModuleFitter& fitter, const ModuleAnswer& answer, size_t chosen,
                         const ModuleRun& whole, size_t run) {
  const auto currents = [&](size_t trial) {
    std::vector<double> current_A;
    for (const auto& point :
         fitter.curve(answer.hypotheses[trial], answer.joint[trial], run, whole)) {
      current_A.push_back(point.current_A);
    }
    return current_A;
  };
  LightSeries light;
  light.name = "current_A";
  light.voltage_V = whole.sweep.voltage_V;
  light.measured = whole.sweep.current_A;
  light.before = currents(0);
  light.after = currents(chosen);
  light.noise.assign(light.measured.size(), whole.sigma_A);
  RecordingSeries series;
  series.recording = std::filesystem::path(whole.sweep.name).filename().string();
  series.light = std::move(light);
  return series;
}

// One diode describes modules in uniform light to 0.1 to 0.5 % of their short-circuit current
// (curves of docs/real_light.md and published measurements). With a shaded cell or a step the
// misfit is 0.8 % and more.
constexpr double even_misfit = 7e-3;
// Limit of the misfit of a reference against which a recording counts as unchanged.
constexpr double unusable_misfit = 2e-2;

// Adds held-out data of another curve.
void add_curve(const Holdout& more, Holdout& all) {
  for (const auto member : {&Holdout::rms_before, &Holdout::rms_after}) {
    double& rms = (all.*member)["current_A"];
    rms = std::sqrt(weighted_mean(rms * rms, all.samples,
                                  std::pow((more.*member).at("current_A"), 2), more.samples));
  }
  add_held_out(more, all);
}

// All fitted hypotheses, the most likely first.
std::vector<Alternative> alternatives_of(const ModuleAnswer& answer) {
  std::vector<Alternative> all;
  for (size_t i = 0; i < answer.trials.size(); ++i) {
    const ModuleHypothesis& h = answer.hypotheses[i];
    Alternative a;
    for (const size_t c : answer.trials[i].candidates) {
      if (!answer.hypotheses[c].kind.empty()) a.kinds.push_back(answer.hypotheses[c].kind);
    }
    a.label = h.label;
    a.log_evidence_relative = answer.joint[i].log_evidence - answer.joint.front().log_evidence;
    a.holdout_chi2_per_sample = answer.trials[i].holdout_chi2_per_sample;
    a.remark = answer.trials[i].objection;
    a.chosen = i == answer.decision.chosen;
    all.push_back(std::move(a));
  }
  std::ranges::stable_sort(all, std::greater(), &Alternative::log_evidence_relative);
  return all;
}

Holdout holdout_of(const ModuleFitter& fitter, const ModuleAnswer& answer, const ModuleData& data) {
  const size_t chosen = answer.decision.chosen;
  Holdout held;
  held.samples = answer.joint.front().fit.samples - answer.trials.front().fit.samples;
  held.chi2_per_sample_before = answer.trials.front().predictive->chi2_per_sample;
  held.chi2_per_sample_after = answer.trials[chosen].predictive->chi2_per_sample;
  held.predictive = answer.trials[chosen].predictive;
  held.rms_before["current_A"] = held_out_rms_A(fitter, answer, 0, data);
  held.rms_after["current_A"] = held_out_rms_A(fitter, answer, chosen, data);
  held.explained_fraction =
      explained_fraction(held.chi2_per_sample_before, held.chi2_per_sample_after, held.samples);
  return held;
}

}  // namespace

std::string module_sentence(const Diagnosis& d) {
  if (d.verdict == Verdict::consistent) {
    return "Nothing is missing: the differences are noise or deviations from the single-diode "
           "model.";
  }
  if (d.verdict == Verdict::unexplained) {
    return "Not explained: no effect of the catalogue explains the recording (" + d.because + ").";
  }
  std::string names;
  for (const FoundEffect& effect : d.effects) {
    names += (names.empty() ? "" : "; ") + in_words(effect.kind) + " (" + effect.explanation + ")";
  }
  return "Missing: " + names + ".";
}

Diagnosis described(const ModuleDesign& design, const ModuleNominal& nominal,
                    const ModuleAnswer& answer, const ModuleData& data, const Thresholds& limits) {
  const ModuleFitter fitter(design, nominal, limits);
  Diagnosis d;
  d.effect_table = "effect";
  d.verdict = answer.decision.verdict;
  d.confidence = answer.decision.confidence;
  d.because = answer.decision.because;
  const size_t chosen = answer.decision.chosen;
  for (const size_t c : answer.trials[chosen].candidates) {
    const ModuleHypothesis& h = answer.hypotheses[c];
    const bool is_best = std::ranges::none_of(answer.joint, [&](const ModuleTrial& other) {
      return other.log_evidence > answer.joint[chosen].log_evidence;
    });
    if (d.verdict != Verdict::unexplained || !is_best) continue;
    if (h.count < 2 || h.count < h.largest_count) continue;
    d.because = "the largest tested number of cells of " + h.kind +
                " fits best: the fault is spread over more cells, unequally";
  }
  if (d.verdict == Verdict::missing_physics) {
    for (size_t which = 0; which < answer.decision.names.size(); ++which) {
      d.effects.push_back(found_in_module(answer, which, limits));
    }
  }
  d.alternatives = alternatives_of(answer);
  d.chi2_per_sample_before = answer.trials.front().fit.chi2_per_sample();
  d.chi2_per_sample_after = answer.trials[chosen].fit.chi2_per_sample();
  d.samples = answer.trials.front().fit.samples;
  d.where.channels.push_back({"current_A", d.chi2_per_sample_before});
  d.holdout = holdout_of(fitter, answer, data);
  for (size_t run = 0; run < data.whole.size(); ++run) {
    d.series.push_back(curve_of(fitter, answer, chosen, data.whole[run], run));
  }
  if (!answer.decision.held_out_tests_names) d.warnings.push_back(untested_names(*d.holdout));
  if (answer.decision.undecided) {
    d.warnings.push_back(
        "an effect is missing, but the recordings do not determine which one: see the "
        "alternatives");
  }
  return d;
}

Diagnosis of_all_curves(std::vector<Diagnosis> each) {
  Diagnosis all;
  all.effect_table = "effect";
  all.confidence = 1.0;
  all.holdout.emplace();
  size_t differing = 0;
  constexpr size_t most_drawn = 12;  // maximum number of plotted curves
  for (Diagnosis& d : each) {
    all.chi2_per_sample_before =
        weighted_mean(all.chi2_per_sample_before, all.samples, d.chi2_per_sample_before, d.samples);
    all.chi2_per_sample_after =
        weighted_mean(all.chi2_per_sample_after, all.samples, d.chi2_per_sample_after, d.samples);
    all.samples += d.samples;
    add_curve(*d.holdout, *all.holdout);
    all.confidence = std::min(all.confidence, d.confidence);
    if (d.verdict == Verdict::consistent) continue;
    ++differing;
    if (all.series.size() < most_drawn) {
      std::ranges::move(d.series, std::back_inserter(all.series));
    }
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
  if (differing == 0) all.series = std::move(each.front().series);
  all.where.channels.push_back({"current_A", all.chi2_per_sample_before});
  all.holdout->explained_fraction =
      explained_fraction(all.holdout->chi2_per_sample_before, all.holdout->chi2_per_sample_after,
                         all.holdout->samples);
  const std::string count = std::to_string(each.size());
  all.sentence = differing == 0
                     ? "Nothing is missing in any of " + count +
                           " curves: the differences are noise or deviations from the single-diode "
                           "model and its translation to other light and temperature."
                     : std::to_string(differing) + " of " + count +
                           " curves differ from the module before the fault. " + all.sentence;
  return all;
}

void compare_with_sensor(const ModuleDesign& design, const std::vector<ModuleRun>& curves,
                         const std::vector<double>& light, Diagnosis& d) {
  std::vector<double> order, ratio;
  for (size_t i = 0; i < curves.size(); ++i) {
    if (!(curves[i].irradiance_W_m2 > 0.0)) continue;
    order.push_back(static_cast<double>(i));
    ratio.push_back(std::log(light[i] / curves[i].irradiance_W_m2));
  }
  constexpr size_t fewest = 5;
  const std::vector<double>& stated = design.reference_irradiances_W_m2;
  const bool is_absolute = !stated.empty() && stated.front() > 0.0;
  if (ratio.empty() || (ratio.size() < fewest && !is_absolute)) return;
  const double unit = is_absolute ? -std::log(stated.front()) : median_of(ratio);
  if (ratio.size() < fewest) {
    constexpr double usual_error = 0.04;  // two standard errors of a sensor
    const double off = median_of(ratio) - unit;
    if (std::abs(off) < usual_error) return;
    d.warnings.push_back(
        printed("light over irradiance_W_m2 is %.3f of that of the reference: angle of incidence, "
                "dirt, spectrum or the sensor, not single cells",
                std::exp(off)));
    return;
  }
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
  const double scatter = median_of(off) / normal_median;
  const auto at = [&](double i) { return std::exp(level + slope * i - unit); };
  // Standard error of the slope of a line through n points with unit spacing: scatter √(12/n³).
  const auto n = static_cast<double>(ratio.size());
  const double sigma = std::abs(slope) / std::max(1e-9, scatter * std::sqrt(12.0 / (n * n * n)));
  d.warnings.push_back(
      printed("light over irradiance_W_m2%s goes from %.3f at the first curve to %.3f at the last "
              "(a line over their order, %.1f standard errors), and scatters by %.2g %%: angle of "
              "incidence, dirt, spectrum or the sensor, not the cells",
              is_absolute ? "" : ", over its median,", at(order.front()), at(order.back()), sigma,
              100.0 * scatter));
  constexpr double beyond_doubt = 4.0, far = 6.0;
  if (sigma > beyond_doubt) {
    const double moved = std::abs(slope) * (order.back() - order.front());
    d.where.depends_on.push_back({"time", moved / (moved + scatter)});
  }
  for (size_t i = 0; i < ratio.size(); ++i) {
    if (off[i] < far * scatter) continue;
    const ModuleRun& curve = curves[static_cast<size_t>(order[i])];
    d.warnings.push_back(printed("%s: light over irradiance_W_m2 is %.3f, off that line",
                                 std::filesystem::path(curve.sweep.name).filename().c_str(),
                                 std::exp(ratio[i] - unit)));
  }
}

void judge_references(const ModuleDesign& design, const ModuleNominal& nominal,
                      const std::vector<LightRecording>& recordings, Diagnosis& d) {
  // If a curve is both a reference and a recording, its deviation from one diode counts as noise,
  // so that no effect is found.
  const bool own = std::ranges::any_of(recordings, [&](const LightRecording& r) {
    return std::ranges::any_of(design.references, [&](const LightRecording& reference) {
      return r.voltage_V == reference.voltage_V && r.current_A == reference.current_A;
    });
  });
  const bool uneven = !design.references.empty() && nominal.misfit > even_misfit;
  if (uneven) {
    d.warnings.push_back(printed(
        "one diode leaves %.2g %% of the short-circuit current of the reference itself, where even "
        "light on like cells leaves 0.1 to 0.5 %%: part of it may be shaded or damaged, and what "
        "the recordings share with it cannot be found",
        100.0 * nominal.misfit));
  }
  if (own) {
    d.warnings.push_back(
        "a recording is its own reference: what one diode cannot describe counts as noise, so that "
        "only another curve or a datasheet can show missing effects");
  }
  const double limit = own ? even_misfit : unusable_misfit;
  const bool is_described = design.references.empty() || nominal.misfit <= limit;
  if (is_described || d.verdict != Verdict::consistent) return;
  d.verdict = Verdict::unexplained;
  d.because = own ? "the curve is its own reference, and one diode" : "one diode";
  d.because += nominal.misfit < 1.0
                   ? printed(" describes %s only to %.2g %% of its short-circuit current",
                             own ? "it" : "the reference", 100.0 * nominal.misfit)
                   : printed(" does not describe %s", own ? "it" : "the reference");
}

}  // namespace photorque
