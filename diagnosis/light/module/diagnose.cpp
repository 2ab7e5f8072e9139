#include "diagnosis/light/module/diagnose.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/constants.h"
#include "core/errors.h"
#include "core/text/format.h"
#include "diagnosis/light/module/explain.h"

namespace photorque {
namespace {

// The current at the voltage nearest to zero; 0 without points.
double short_circuit_A(const std::vector<double>& voltage_V, const std::vector<double>& current_A) {
  double found_A = 0.0, nearest_V = INFINITY;
  for (size_t i = 0; i < voltage_V.size(); ++i) {
    if (std::abs(voltage_V[i]) > nearest_V) continue;
    nearest_V = std::abs(voltage_V[i]);
    found_A = current_A[i];
  }
  return found_A;
}

// Light of a curve relative to the reference, from the current at the lowest voltage; ≥ 1e-3.
double light_of(const ModuleSweep& sweep, const ModuleNominal& nominal) {
  return std::max(short_circuit_A(sweep.voltage_V, sweep.current_A) / nominal.cell.photocurrent_A,
                  1e-3);
}

// Throws InputError for currents and voltages that are impossible in any light at any temperature:
// a wrong unit, or exchanged columns.
void require_plausible(const ModuleSweep& sweep, const ModuleDesign& design,
                       const ModuleNominal& nominal) {
  const ModuleCell& cell = nominal.cell;
  const double thermal_V = boltzmann_J_K * cell.temperature_K / elementary_charge_C;
  const double open_V = design.cells * cell.ideality * thermal_V *
                        std::log1p(cell.photocurrent_A / cell.saturation_A);
  const double light = light_of(sweep, nominal);
  double seen_V = 0.0;  // the largest voltage with a forward current
  for (size_t i = 0; i < sweep.voltage_V.size(); ++i) {
    if (sweep.current_A[i] >= 0.0) seen_V = std::max(seen_V, sweep.voltage_V[i]);
  }
  constexpr double most_suns = 20.0, most_V = 1.25;
  if (light > most_suns) {
    throw InputError({sweep.name}, "current_A",
                     printed("%.3g times the current of the reference module", light),
                     "amperes (a column in milliamperes is named current_mA)");
  }
  if (seen_V > most_V * open_V) {
    const double exchanged = light * cell.photocurrent_A / open_V;
    constexpr double alike = 0.15;
    throw InputError({sweep.name}, "voltage_V",
                     printed("%.3g V at a current, where the reference module gives %.3g V at none",
                             seen_V, open_V),
                     std::abs(exchanged - 1.0) < alike
                         ? "the voltage: the columns of voltage and current look exchanged"
                         : "volts of the module of the experiment (a column in millivolts is named "
                           "voltage_mV)");
  }
}

// Throws InputError if the current is positive into the module.
void require_current_forward(const LightRecording& recording) {
  const double short_A = short_circuit_A(recording.voltage_V, recording.current_A);
  double largest_A = 0.0;
  for (const double current_A : recording.current_A)
    largest_A = std::max(largest_A, std::abs(current_A));
  if (short_A > -0.5 * largest_A) return;
  throw InputError(
      {recording.name}, "current_A", "a negative current at the smallest voltage",
      "positive currents of an illuminated module: the sign of the column is reversed");
}

ModuleRun run_of(const LightRecording& r, const ModuleDesign& design, const ModuleNominal& nominal,
                 DataQuality& quality) {
  constexpr size_t max_points = 160;  // longer curves are thinned
  std::map<std::string, int64_t> rejected;
  require_current_forward(r);
  ModuleRun run{module_sweep(r, design, max_points, &rejected)};
  run.sweep.temperature_K = r.has_temperatures ? median_of(r.temperature_K) : design.temperature_K;
  run.irradiance_W_m2 = median_of(r.irradiance_W_m2);
  require_plausible(run.sweep, design, nominal);
  run.sweep.light = light_of(run.sweep, nominal);
  run.sigma_A = point_sigma_A(nominal, run.sweep);
  quality.rows += r.rows_read;
  for (const auto& [reason, count] : r.rejected) quality.rejected[reason] += count;
  const auto used = static_cast<int64_t>(run.sweep.voltage_V.size());
  int64_t left = static_cast<int64_t>(r.rows()) - used;
  for (const auto& [reason, count] : rejected) {
    quality.rejected[reason] += count;
    left -= count;
  }
  quality.used += used;
  if (left > 0) quality.rejected["thinning"] += left;
  return run;
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
    auto [train, held] = split_curve(curve);
    const ModuleData data{{std::move(train)}, {std::move(held)}, {curve}};
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
  std::vector<std::string> warnings = design.notes;
  const auto read = [&](const std::vector<LightRecording>& files, std::vector<ModuleRun>& runs) {
    for (const LightRecording& file : files) {
      if (file.kind != LightRecording::Kind::sweep) {
        throw InputError({file.name}, "header", "no columns voltage_V,current_A",
                         "a current-voltage curve, for an experiment with [module]");
      }
      for (const LightRecording& curve : sweeps_of(file)) {
        runs.push_back(run_of(curve, design, nominal, quality));
        data.whole.push_back(runs.back());
      }
    }
  };
  read(recordings, data.train);
  read(holdouts, data.held);
  for (const auto* files : {&recordings, &holdouts}) {
    for (std::string& note : reading_notes(*files)) {
      // A recording may be its own reference.
      if (std::ranges::find(warnings, note) == warnings.end()) warnings.push_back(std::move(note));
    }
  }
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
  d.warnings.insert(d.warnings.end(), warnings.begin(), warnings.end());
  const Verdict before = d.verdict;
  judge_references(design, nominal, recordings, d);
  if (d.verdict != before) d.sentence = module_sentence(d);
  return d;
}

}  // namespace photorque
