#include "diagnosis/attitude/settle.h"

#include <cmath>

#include "attitude/estimation/fit.h"
#include "attitude/observation/heavy_tails.h"
#include "attitude/observation/noise_search.h"
#include "core/constants.h"
#include "diagnosis/attitude/gyro_bias.h"
#include "diagnosis/attitude/holdout.h"
#include "diagnosis/attitude/sentences.h"

namespace photorque {
namespace {

InstrumentFinding level_finding(int k, const FoundNoise& found, double stated) {
  const double unit = k < 3 ? arcsecond_rad : 1.0;
  const double value = found.noise.level / unit;
  return {channel_traits(k).name, "noise_level", value, found.level_sigma * value,
          written("the noise of %s is not what the experiment states: %.3g %s were found in the "
                  "recording and used, %.3g are stated",
                  channel_traits(k).spoken, value, k < 3 ? "arcsec" : "rad/s", stated / unit)};
}

InstrumentFinding colour_finding(int k, const FoundNoise& found) {
  const bool all = !(found.noise.coloured < 1.0);
  return {
      channel_traits(k).name, "noise_correlation_time_s", found.noise.time_s, found.time_sigma_s,
      written(
          "the noise of %s is correlated over %.3g s%s: neighbouring readings count for "
          "less",
          channel_traits(k).spoken, found.noise.time_s,
          all ? "" : written(" (%.0f %% of its variance)", 100.0 * found.noise.coloured).c_str())};
}

InstrumentFinding tail_finding(int k, const HeavyTail& tail) {
  const double unit = k < 3 ? arcsecond_rad : 1.0;
  return {
      channel_traits(k).name, "noise_degrees_of_freedom", tail.degrees, tail.degrees_sigma,
      written("the noise of %s has heavy tails (Student's t with %.2g degrees of freedom, scale "
              "%.3g %s): readings far from their neighbours count for less",
              channel_traits(k).spoken, tail.degrees, tail.scale / unit,
              k < 3 ? "arcsec" : "rad/s")};
}

// Gives the runs the noise that was found, and tells of it. Returns whether any changed.
bool use_noise(const NoiseFindings& findings, RecordedData& data) {
  bool changed = false;
  const NoiseLevels stated = data.train.front().noise;
  for (int k = 0; k < 6; ++k) {
    const FoundNoise& found = findings.channel[static_cast<size_t>(k)];
    if (found.level_found) data.instruments.push_back(level_finding(k, found, stated.of(k).level));
    if (found.colour_found) data.instruments.push_back(colour_finding(k, found));
    if (!found.level_found && !found.colour_found) continue;
    changed = true;
    for (auto* runs : {&data.train, &data.held}) {
      for (Observation& seen : *runs) seen.noise.set(k, found.noise);
    }
  }
  return changed;
}

// Takes the edge off what no normal distribution has: bursts are dropped, heavy tails tamed, in
// what is fitted and in what is held out. `near` is near the readings. Returns whether any changed.
bool tame_noise(const Fit& near, const Thresholds& limits, RecordedData& data) {
  const int64_t in_bursts = drop_bursts(residuals_of(near, data.train), limits.noise, data.train);
  const std::vector<Prediction> residuals = residuals_of(near, data.train);
  const HeavyTails tails = heavy_tails(residuals, data.train, limits.noise);
  tame(tails, residuals, data.train);
  const std::vector<Prediction> tamed = residuals_of(near, data.train);
  bool changed = in_bursts > 0;
  for (int k = 0; k < 6; ++k) {
    const std::optional<HeavyTail>& tail = tails[static_cast<size_t>(k)];
    if (!tail) continue;
    changed = true;
    data.instruments.push_back(tail_finding(k, *tail));
    const ChannelNoise now{deviation_level(tamed, data.train, k), 0.0, 0.0};
    for (auto* runs : {&data.train, &data.held}) {
      for (Observation& seen : *runs) seen.noise.set(k, now);
    }
  }
  int64_t held_in_bursts = 0;
  const Fit held = propagate_model(near, data.held, limits);
  if (std::isfinite(held.chi2)) {
    held_in_bursts = drop_bursts(residuals_of(held, data.held), limits.noise, data.held);
    tame(tails, residuals_of(held, data.held), data.held);
  }
  if (const long long all = in_bursts + held_in_bursts; all > 0) {
    data.outliers += all;
    data.warnings.push_back(written("%lld readings in bursts of large errors are left out", all));
  }
  return changed;
}

// What the readings say of their own noise about a fit that is near them, put to use. Returns
// whether anything changed.
bool find_and_use_noise(const Fit& near, const Thresholds& limits, RecordedData& data) {
  NoiseFindings findings = find_noise(data.train, residuals_of(near, data.train), limits.noise);
  data.noise_is_open = findings.is_open;
  if (findings.is_open) return false;
  const bool tamed = tame_noise(near, limits, data);
  if (tamed) findings = find_noise(data.train, residuals_of(near, data.train), limits.noise);
  return use_noise(findings, data) || tamed;
}

}  // namespace

Fit settle(const NominalModel& nominal, const Thresholds& limits, RecordedData& data) {
  take_out_bias_drift(data);
  Fit fitted = fit_nominal(nominal, data.train, limits);
  // One that cannot be propagated along the recording says nothing of its readings.
  if (!std::isfinite(fitted.chi2)) return fitted;
  const std::vector<Prediction> residuals = residuals_of(fitted, data.train);
  data.outliers = drop_outliers(residuals, limits.noise, data.train);
  bool changed = data.outliers > 0;
  // Without an attitude nothing tells noise from motion.
  if (!nominal.sensors.noise_is_stated && data.train.front().sees_attitude()) {
    changed = find_and_use_noise(fitted, limits, data) || changed;
  }
  if (changed) fitted = fit(fitted.best, data.train);
  const Fit held = propagate_model(fitted, data.held, limits);
  if (!std::isfinite(held.chi2)) return fitted;
  data.outliers += drop_outliers(residuals_of(held, data.held), limits.noise, data.held);
  return fitted;
}

bool settle_again(const Fit& explained, const Thresholds& limits, RecordedData& data) {
  if (!data.noise_is_open) return false;
  if (!(explained.chi2_per_sample() < limits.diverged_chi2_per_sample)) return false;
  const bool changed = find_and_use_noise(explained, limits, data);
  data.noise_is_open = false;
  return changed;
}

}  // namespace photorque
