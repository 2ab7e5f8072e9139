// Simulated runs, and what a filter makes of many of them.
#include <algorithm>
#include <atomic>
#include <cmath>

#include "attitude/filtering/report.h"
#include "attitude/filtering/study.h"
#include "core/errors.h"
#include "core/parallel.h"

namespace photorque {

SimulatedRun simulate_run(const PropagationRun& nominal, uint64_t seed) {
  PropagationRun run = nominal;
  run.seed = seed;
  uint64_t number = 0;
  constexpr uint64_t stream = 1000;  // beyond those of the instruments
  for (Disturbance& disturbance : run.model.disturbances) {
    for (Parameter& parameter : disturbance.parameters) {
      parameter.value += parameter.sigma * gaussian(seed, stream, number++, 0);
    }
  }
  const PropagationResult result = propagate(run);
  SimulatedRun simulated{result.recording, {}};
  for (const PlatformState& state : result.states) {
    simulated.truth.push_back(TruthAtRow{state.lab_from_body, state.rate_body_rad_s});
  }
  return simulated;
}

TruthTrack truth_from(const Recording& known, const Recording& rows) {
  const Channel* channels[7];
  const char* names[] = {"q_w",          "q_x",          "q_y",         "q_z",
                         "rate_x_rad_s", "rate_y_rad_s", "rate_z_rad_s"};
  for (size_t k = 0; k < 7; ++k) {
    channels[k] = known.find(names[k]);
    if (channels[k] == nullptr && k < 4) {
      throw InputError({}, "--truth", std::string("no channel ") + names[k],
                       "q_w, q_x, q_y, q_z, such as time_history.csv of propagate");
    }
  }
  constexpr double near_s = 1e-3;
  TruthTrack truth(rows.rows());
  size_t at = 0;
  for (size_t i = 0; i < rows.rows(); ++i) {
    while (at + 1 < known.rows() && std::abs(known.time_s[at + 1] - rows.time_s[i]) <=
                                        std::abs(known.time_s[at] - rows.time_s[i])) {
      ++at;
    }
    if (std::abs(known.time_s[at] - rows.time_s[i]) > near_s) continue;
    const auto value = [&](size_t k) { return channels[k]->values[at]; };
    TruthAtRow one{Quat(value(0), value(1), value(2), value(3)).normalized(), {}};
    if (!std::isfinite(one.lab_from_body.coeffs().sum())) continue;
    if (channels[4] && channels[5] && channels[6]) {
      one.rate_body_rad_s = Vec3(value(4), value(5), value(6));
    }
    truth[i] = one;
  }
  return truth;
}

ConsistencyResult consistency_of(const EstimateStudy& study, const PropagationRun& run,
                                 const FilterSettings& settings,
                                 const std::function<void(double)>& progress) {
  ConsistencyResult result;
  const auto runs = static_cast<size_t>(study.runs);
  std::vector<std::pair<Estimation, TruthTrack>> all(runs);
  std::atomic<int> done{0};
  parallel_for(runs, study.threads, [&](size_t i) {
    SimulatedRun simulated = simulate_run(run, run.seed + 1 + i);
    const Platform& platform = study.nominal.model.platform;
    const MotionModel probe(study.nominal.model, study.nominal.sensors, settings, {});
    const Readings readings =
        readings_of(simulated.recording, "simulated", platform, probe.camera_delay_s());
    const MotionModel model(study.nominal.model, study.nominal.sensors, settings,
                            readings.schedule);
    all[i] = {estimate_attitude(model, readings), std::move(simulated.truth)};
    if (progress) progress(++done / static_cast<double>(runs));
  });
  for (const auto& [estimation, truth] : all) result.ensemble.add(estimation, truth);
  const RunEnsemble& ensemble = result.ensemble;
  const std::vector<double> filtered = ensemble.nees_filtered(),
                            smoothed = ensemble.nees_smoothed();
  const size_t from = settled_row(filtered.size());
  result.part_filtered = ensemble.part_in_band(filtered, from);
  result.part_smoothed = ensemble.part_in_band(smoothed, from);
  const std::vector<double> rms_f = ensemble.rms_filtered_rad(),
                            rms_s = ensemble.rms_smoothed_rad();
  Plot plot;
  plot.name = "normalised_errors";
  plot.title = "Normalised errors squared, mean of " + std::to_string(study.runs) +
               " runs, and their 95 % band";
  plot.x_label = "Time [s]";
  plot.y_label = "NEES of attitude and rate";
  plot.levels = {ensemble.band().low, ensemble.band().high};
  Plot::Curve f, s, ef, es;
  f.label = ef.label = "filter";
  s.label = es.label = "smoother";
  for (size_t i = 0; i < filtered.size(); ++i) {
    if (rms_f[i] > 0.0 && i + 1 < filtered.size()) {
      result.worst_gain = std::max(result.worst_gain, rms_s[i] / rms_f[i]);
    }
    if (i % thinning(filtered.size()) != 0) continue;
    const double t_s = all.front().first.filtered[i].time_s;
    for (Plot::Curve* curve : {&f, &s, &ef, &es}) curve->x.push_back(t_s);
    f.y.push_back(filtered[i]);
    s.y.push_back(smoothed[i]);
    ef.y.push_back(in_arcsec(rms_f[i]));
    es.y.push_back(in_arcsec(rms_s[i]));
  }
  plot.curves = {f, s};
  Plot::Panel below;
  below.y_label = "rms attitude error [arcsec]";
  below.y_log = true;
  below.curves = {ef, es};
  plot.below.push_back(below);
  result.product.plots.push_back(plot);
  return result;
}

}  // namespace photorque
