#include "diagnosis/light/diagnose.h"

#include <algorithm>
#include <cmath>

#include "core/errors.h"
#include "core/parallel.h"
#include "diagnosis/light/findings.h"
#include "inference/decide.h"
#include "inference/search.h"
#include "inference/weigh.h"

namespace photorque {
namespace {

// All recordings, fitted and held out.
struct LightData {
  std::vector<FittedRun> train, held;
  DataQuality quality;

  std::vector<FittedRun> all() const {
    std::vector<FittedRun> runs = train;
    runs.insert(runs.end(), held.begin(), held.end());
    return runs;
  }
};

// There is a candidate for every lamp and cell, and light is nearly linear in the effects, so few
// steps suffice. (Circuits are not linear: the right candidate may have a small forecast.)
Thresholds light_thresholds() {
  Thresholds limits;
  limits.held_out.max_leaders = 6;
  limits.leaders.max_leaders = 4;
  limits.fitting.slow_blocks = 400;
  limits.fitting.trial_iterations = 10;
  limits.fitting.leader_iterations = 20;
  limits.search.max_effects = 3;
  return limits;
}

void tell(const LightDiagnoseOptions& options, const std::string& what) {
  if (options.progress) options.progress(what);
}

// Thins a long recording and removes outliers.
FittedRun observed(const LightLab& lab, const NominalLight& nominal, LightRecording recording,
                   int number, DataQuality& quality) {
  // Longer recordings are thinned to every n-th row.
  constexpr size_t max_rows = 5000, max_scan_rows = 12000;
  quality.rows += recording.rows_read;
  for (const auto& [reason, count] : recording.rejected) quality.rejected[reason] += count;
  const bool is_scan = recording.kind == LightRecording::Kind::scan;
  const size_t rows = recording.rows(), most = is_scan ? max_scan_rows : max_rows;
  if (rows > most) {
    const size_t every = (rows + most - 1) / most;
    std::vector<size_t> some;
    for (size_t i = 0; i < rows; i += every) some.push_back(i);
    quality.rejected["thinning"] += static_cast<int64_t>(rows - some.size());
    recording = recording.part(some);
  }
  LightRun whole(lab, std::move(recording));
  whole.set_number(number);
  FittedRun run = prepared_run(std::move(whole), nominal);
  const std::vector<double> signals = run.run->signals(nominal.state, *run.nominal);
  const std::vector<size_t> good = rows_without_outliers(
      *run.run, run.run->residuals(nominal.state, signals, nullptr), light_thresholds().noise);
  if (good.size() < run.run->rows()) {
    quality.rejected["outlier"] += static_cast<int64_t>(run.run->rows() - good.size());
    run = part_of(run, good, nominal);
  }
  quality.used += static_cast<int64_t>(run.run->rows());
  return run;
}

// Rows to fit and rows to hold out if no holdout is given. Of a recording over time or of sweeps,
// the last quarter is held out. Of a scan every fourth row is held out, because its last part is
// only a corner of the receiver.
std::pair<std::vector<size_t>, std::vector<size_t>> split(const LightRun& run) {
  std::vector<size_t> fitted, held;
  const size_t rows = run.rows();
  const bool scan = run.recording().kind == LightRecording::Kind::scan;
  for (size_t i = 0; i < rows; ++i) {
    const bool is_held =
        scan ? i % 4 == 3 : static_cast<double>(i) >= 0.75 * static_cast<double>(rows);
    (is_held ? held : fitted).push_back(i);
  }
  return {fitted, held};
}

// Requires several readings in the fitted and in the held-out data: any model explains a single
// one.
void require_enough(const LightData& data, const std::string& first) {
  constexpr size_t fewest_fitted = 8, fewest_held = 2;
  size_t fitted = 0, held = 0;
  for (const FittedRun& run : data.train) fitted += run.run->rows();
  for (const FittedRun& run : data.held) held += run.run->rows();
  if (fitted >= fewest_fitted && held >= fewest_held) return;
  throw InputError(
      {first}, "",
      std::to_string(fitted + held) + " usable reading" + (fitted + held == 1 ? "" : "s"),
      "at least 8 to fit and 2 to hold out");
}

LightData read_light_data(const LightLab& lab, const NominalLight& nominal,
                          std::vector<LightRecording> recordings,
                          std::vector<LightRecording> holdouts) {
  LightData data;
  int number = 0;
  for (LightRecording& r : recordings) {
    data.train.push_back(observed(lab, nominal, std::move(r), number++, data.quality));
  }
  for (LightRecording& r : holdouts) {
    data.held.push_back(observed(lab, nominal, std::move(r), number++, data.quality));
  }
  if (data.held.empty()) {
    for (FittedRun& run : data.train) {
      const auto [fitted, held] = split(*run.run);
      if (held.empty() || fitted.empty()) continue;
      data.held.push_back(part_of(run, held, nominal));
      run = part_of(run, fitted, nominal);
    }
  }
  return data;
}

// Removes outliers under a fit; returns whether any exist. In held-out data, and without an
// explanation, only gross outliers are removed: a small shadow looks like a stray reading.
bool drop_light_outliers(const LightTrial& about, const LightCandidates& all, LightData& data) {
  int64_t dropped = 0;
  for (std::vector<FittedRun>* runs : {&data.train, &data.held}) {
    for (FittedRun& run : *runs) {
      const Eigen::VectorXd residuals = residuals_of(about, all, run);
      const std::vector<size_t> good =
          about.candidates.empty() || runs == &data.held
              ? rows_without_outliers(*run.run, residuals, all.limits.noise)
              : rows_within_noise(*run.run, residuals);
      if (good.size() == run.run->rows() || good.empty()) continue;
      dropped += static_cast<int64_t>(run.run->rows() - good.size());
      run = part_of(run, good, all.nominal);
    }
  }
  if (dropped == 0) return false;
  data.quality.rejected["outlier"] += dropped;
  data.quality.used -= dropped;
  return true;
}

LightAnswer explain_light(const LightLab& lab, const NominalLight& nominal, LightData& data,
                          const LightDiagnoseOptions& options) {
  LightAnswer answer{light_candidates(lab, nominal, data.train, light_thresholds()), {}, {}};
  const LightCandidates& all = answer.all;
  tell(options, "fitting every effect of the catalogue");
  answer.trials =
      inference::search(all, nominal_light_trial(all, data.train), data.train, options.threads);
  // Near a missing effect an outlier looks like a part of it. It stands out once the best
  // explanation is known, and the search continues from there.
  const LightTrial best = answer.trials[inference::by_evidence(answer.trials).front()];
  if (drop_light_outliers(best, all, data)) {
    const LightTrial base = nominal_light_trial(all, data.train);
    const LightTrial from =
        all.refit(best, data.train, {}, inference::until_convergence(all.limits));
    answer.trials = inference::Rounds<LightCandidates>(
                        all, {data.train}, base, all.limits.search.max_effects, options.threads)
                        .run(from);
  }
  tell(options, "comparing with the held-out data");
  inference::weigh_with_held_out(all, data.train, data.held, options.threads, answer.trials);
  const std::vector<FittedRun> everything = data.all();
  const inference::Checks checks{
      .excess_sigma =
          [&](size_t trial) { return all.excess_sigma(answer.trials[trial], data.train); },
      .gain_sigma =
          [&](size_t trial, size_t which) {
            return gain_over_segments(answer.trials[trial], which, all, everything,
                                      options.threads);
          },
      .other_places =
          [&](size_t trial, size_t which) {
            return other_light_places(answer.trials[trial], which, all, everything,
                                      options.threads);
          }};
  answer.decision =
      inference::decide({answer.trials.begin(), answer.trials.end()},
                        {all.list.begin(), all.list.end()}, checks, all.limits.decision);
  return answer;
}

std::map<std::string, double> rms_of(const LightTrial& trial, const LightCandidates& all,
                                     const std::vector<FittedRun>& runs) {
  std::map<std::string, std::pair<double, int64_t>> sums;
  const LightState state = state_of(trial, all);
  for (const FittedRun& run : runs) {
    const LightRecording& r = run.run->recording();
    const auto expected = run.run->expected(state);
    for (const LightRun::Channel& channel : run.run->channels()) {
      auto& [squares, count] = sums[channel.name];
      for (size_t i = 0; i < r.rows(); ++i, ++count) {
        const double off = (r.*channel.measured)[i] - expected[i].*channel.expected;
        squares += off * off;
      }
    }
  }
  std::map<std::string, double> result;
  for (const auto& [channel, sum] : sums) {
    result[channel] = std::sqrt(sum.first / static_cast<double>(sum.second));
  }
  return result;
}

Holdout light_holdout(const LightAnswer& answer, const std::vector<FittedRun>& held) {
  const LightTrial before = answer.all.predict(answer.trials.front(), held),
                   after = answer.all.predict(answer.chosen(), held);
  Holdout result;
  result.samples = after.fit.samples;
  result.chi2_per_sample_before = before.fit.chi2_per_sample();
  result.chi2_per_sample_after = after.fit.chi2_per_sample();
  result.rms_before = rms_of(before, answer.all, held);
  result.rms_after = rms_of(after, answer.all, held);
  result.predictive = answer.chosen().predictive;
  result.explained_fraction = explained_fraction(result.chi2_per_sample_before,
                                                 result.chi2_per_sample_after, result.samples);
  return result;
}

// Puts the variable of the chosen law first, with the fraction of the residual above noise that the
// law explains.
void lead_with_chosen_law(const LightAnswer& answer, const LightTrial& about,
                          std::vector<Where::Dependence>& depends_on) {
  for (const size_t c : answer.chosen().candidates) {
    const std::string& variable = answer.all[c].variable;
    if (variable.empty()) continue;
    std::erase_if(depends_on, [&](const auto& d) { return d.variable == variable; });
    const auto samples = static_cast<double>(about.fit.samples);
    const double beyond = std::max(1.0, about.fit.data_chi2 - samples);
    const double taken = about.fit.data_chi2 - answer.chosen().fit.data_chi2;
    depends_on.insert(depends_on.begin(), {variable, std::clamp(taken / beyond, 0.0, 1.0)});
  }
}

std::vector<Where::ChannelMisfit> misfits(const LightAnswer& answer,
                                          const std::vector<FittedRun>& runs) {
  std::map<std::string, std::pair<double, int64_t>> sums;
  for (const FittedRun& run : runs) {
    const Eigen::VectorXd r = residuals_of(answer.trials.front(), answer.all, run);
    for (Eigen::Index i = 0; i < r.size(); ++i) {
      const int channel = run.run->sample_channel()[static_cast<size_t>(i)];
      auto& [chi2, count] = sums[run.run->channels()[static_cast<size_t>(channel)].name];
      chi2 += r[i] * r[i];
      ++count;
    }
  }
  std::vector<Where::ChannelMisfit> result;
  for (const auto& [name, sum] : sums) {
    result.push_back({name, sum.first / static_cast<double>(sum.second)});
  }
  std::ranges::stable_sort(result, std::greater(), &Where::ChannelMisfit::chi2_per_sample);
  return result;
}

}  // namespace

Diagnosis diagnose_light(const LightLab& lab, const NominalLight& nominal,
                         std::vector<LightRecording> recordings,
                         std::vector<LightRecording> holdouts,
                         const LightDiagnoseOptions& options) {
  if (recordings.empty()) throw InputError({}, "--recording", "none", "at least one recording");
  const std::string first = recordings.front().name;
  Diagnosis d;
  for (const auto* files : {&recordings, &holdouts}) {
    for (std::string& note : reading_notes(*files)) d.warnings.push_back(std::move(note));
  }
  LightData data = read_light_data(lab, nominal, std::move(recordings), std::move(holdouts));
  require_enough(data, first);
  const LightAnswer answer = explain_light(lab, nominal, data, options);
  d.effect_table = "effect";
  d.verdict = answer.decision.verdict;
  d.confidence = answer.decision.confidence;
  d.because = answer.decision.because;
  d.where.channels = misfits(answer, data.train);
  if (d.verdict == Verdict::missing_physics) d.effects = found_light_effects(answer, data.all());
  if (d.verdict != Verdict::consistent) {
    const LightTrial& about = d.verdict == Verdict::unexplained
                                  ? answer.trials[answer.decision.best_named]
                                  : answer.trials.front();
    d.where.depends_on = light_dependences(about, answer.all, data.train);
    lead_with_chosen_law(answer, about, d.where.depends_on);
  }
  d.alternatives = light_alternatives(answer);
  d.priors_refined = refined_light_priors(answer);
  d.chi2_per_sample_before = answer.trials.front().fit.chi2_per_sample();
  d.chi2_per_sample_after = answer.chosen().fit.chi2_per_sample();
  d.samples = answer.trials.front().fit.samples;
  d.holdout = light_holdout(answer, data.held);
  for (const FittedRun& run : data.train) d.series.push_back(light_series(answer, run, false));
  for (const FittedRun& run : data.held) d.series.push_back(light_series(answer, run, true));
  d.array = drawn_array(lab, d.effects);
  d.data = data.quality;
  if (answer.decision.undecided) d.warnings.emplace_back(undecided_effect);
  if (!answer.decision.held_out_tests_names) d.warnings.push_back(untested_names(*d.holdout));
  if (lab.has_array()) {
    std::vector<WeighedSpectrum> spectra;
    for (const Beam& beam : lab.experiment().beams) spectra.push_back({beam.spectrum, 1.0});
    for (std::string& line : light_outside(lab.design().efficiency, spectra)) {
      d.warnings.push_back(std::move(line));
    }
  }
  d.sentence = light_sentence(d);
  return d;
}

}  // namespace photorque
