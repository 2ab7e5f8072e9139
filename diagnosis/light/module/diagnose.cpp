#include "diagnosis/light/module/diagnose.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/errors.h"
#include "diagnosis/light/module/explain.h"
#include "diagnosis/light/module/plausible.h"
#include "diagnosis/light/module/report.h"

namespace photorque {
namespace {

ModuleRun run_of(const LightRecording& r, const ModuleDesign& design, const ModuleNominal& nominal,
                 DataQuality& quality) {
  constexpr size_t max_points = 160;  // longer curves are thinned
  int64_t dropped = 0;
  require_current_forward(r);
  ModuleRun run{module_sweep(r, design, max_points, &dropped)};
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
  if (left > 0) quality.rejected["thinning"] += left;
  return run;
}

// Data of a single curve.
ModuleData of_one_curve(const ModuleRun& whole) {
  ModuleData data;
  auto [train, held] = split_curve(whole);
  data.train.push_back(std::move(train));
  data.held.push_back(std::move(held));
  data.whole.push_back(whole);
  return data;
}

// Diagnoses every curve separately. The nominal model is fitted first. If it leaves a residual, all
// hypotheses are fitted. `light` returns the light of each curve relative to the reference, as
// fitted with the nominal model.
std::vector<Diagnosis> each_curve(const ModuleDesign& design, const ModuleNominal& nominal,
                                  const ModuleData& all, int threads, const Thresholds& limits,
                                  std::vector<double>& light) {
  const std::vector<ModuleHypothesis> hypotheses = module_hypotheses(design, nominal);
  std::vector<Diagnosis> each;
  for (const ModuleRun& curve : all.whole) {
    const ModuleData data = of_one_curve(curve);
    const ModuleAnswer answer = explain_module(design, nominal, hypotheses, data, threads, limits);
    light.push_back(std::exp(answer.trials.front().fit.at[0]));
    each.push_back(described(design, nominal, answer, data, limits));
    Diagnosis& d = each.back();
    const std::string name = std::filesystem::path(curve.sweep.name).filename().string();
    for (FoundEffect& effect : d.effects) effect.texts.emplace_back("curve", name);
    for (Alternative& alternative : d.alternatives) alternative.of = name;
    d.sentence = name + ": " + module_sentence(d);
  }
  return each;
}

}  // namespace

Diagnosis diagnose_module(const ModuleDesign& design, const std::vector<LightRecording>& recordings,
                          const std::vector<LightRecording>& holdouts, int threads) {
  if (recordings.empty()) throw InputError({}, "--recording", "none", "at least one recording");
  const Thresholds limits;
  const ModuleNominal nominal = nominal_module(design);
  ModuleData data;
  DataQuality quality;
  const auto read = [&](const std::vector<LightRecording>& files, std::vector<ModuleRun>& runs) {
    for (const LightRecording& file : files) {
      require_curve(file);
      for (const LightRecording& curve : sweeps_of(file)) {
        runs.push_back(run_of(curve, design, nominal, quality));
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
  // If only some of the curves differ, or there are too many for a joint fit, they are explained
  // one by one.
  constexpr size_t few = 4;
  Diagnosis d;
  bool is_done = false;
  if (holdouts.empty() && data.whole.size() > 1) {
    std::vector<double> light;
    std::vector<Diagnosis> each = each_curve(design, nominal, data, threads, limits, light);
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
        explain_module(design, nominal, module_hypotheses(design, nominal), data, threads, limits);
    d = described(design, nominal, answer, data, limits);
    d.sentence = module_sentence(d);
    const inference::Fit& fit = answer.joint[answer.decision.chosen].fit;
    std::vector<double> light;
    for (size_t run = 0; run < data.train.size(); ++run) {
      light.push_back(std::exp(fit.at[2 * static_cast<Eigen::Index>(run)]));
    }
    compare_with_sensor(design, data.train, light, d);
  }
  d.data = quality;
  const Verdict before = d.verdict;
  judge_references(design, nominal, recordings, d);
  if (d.verdict != before) d.sentence = module_sentence(d);
  return d;
}

}  // namespace photorque
