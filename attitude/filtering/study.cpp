#include "attitude/filtering/study.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "attitude/filtering/report.h"
#include "attitude/observation/noise_levels.h"
#include "attitude/observation/observation.h"
#include "core/constants.h"
#include "core/errors.h"
#include "core/parallel.h"
#include "core/settings/typed_keys.h"
#include "core/text/format.h"

namespace photorque {

namespace {

namespace estimate_key {
constexpr ChoiceKey model("model",
                          {{"disturbances", "the modelled torques"},
                           {"gyro", "the gyro"},
                           {"walk", "a random walk of the rate"}},
                          0, "motion model between the readings of the written estimate");
constexpr NumberKey rate_walk("rate_walk", Range::positive(),
                              "random walk of the rate without torques, rad/s per √s",
                              {.usually = "of maximum likelihood"});
constexpr NumberKey disturbed_rate_walk(
    "disturbed_rate_walk", Range::positive(),
    "random walk of the rate in addition to the modelled torques, rad/s per √s",
    {.usually = "of maximum likelihood"});
constexpr NumberKey rate_sigma("rate_sigma_rad_s", FilterSettings{}.rate_sigma_rad_s,
                               Range::positive(),
                               "standard deviation of the rate before the first reading");
constexpr IntegerKey search_readings("search_readings", 2000, 50, 100'000'000,
                                     "number of readings for the maximum-likelihood search");
constexpr IntegerKey runs(
    "runs", 20, 0, 100'000,
    "number of simulated runs for the consistency test, if no recording is given");
constexpr TableKey estimate("estimate", "how the attitude is estimated");
}  // namespace estimate_key

// Variance of the initial tilt if only an encoder measures the attitude: (0.01 rad)².
constexpr double level_rad2 = 1e-4;

// The methods that the channels permit, the simplest first.
std::vector<Ingredients> possible_methods(const EstimateStudy& study, const Readings& readings) {
  struct Method {
    const char* name;
    Motion motion;
    bool attitude, gyro;
  };
  const Method all[] = {{"gyro alone", Motion::gyro_drives, false, true},
                        {"camera alone", Motion::rate_walks, true, false},
                        {"camera, disturbances", Motion::disturbances, true, false},
                        {"camera and gyro, gyro drives", Motion::gyro_drives, true, true},
                        {"camera and gyro, rate walks", Motion::rate_walks, true, true},
                        {"camera and gyro, disturbances", Motion::disturbances, true, true},
                        {"gyro, disturbances", Motion::disturbances, false, true}};
  const bool sees = readings.sees_attitude() || readings.has_yaw;
  const bool whole_gyro =
      std::ranges::any_of(readings.all, [](const Reading& r) { return r.gyro_rad_s.allFinite(); });
  std::vector<Ingredients> methods;
  for (const Method& method : all) {
    if ((method.attitude && !sees) || (method.gyro && !readings.has_gyro)) continue;
    if (method.motion == Motion::gyro_drives && !whole_gyro) continue;
    if (method.motion == Motion::disturbances && !method.attitude && sees) continue;
    FilterSettings settings = study.filter;
    settings.motion = method.motion;
    settings.uses_attitude = method.attitude;
    settings.uses_gyro = method.gyro;
    methods.push_back({method.name, settings, {}});
  }
  return methods;
}

// The method with the most instruments for the requested motion model.
size_t choose(const std::vector<Ingredients>& methods, Motion motion) {
  size_t best = methods.size() - 1;
  for (size_t i = 0; i < methods.size(); ++i) {
    const FilterSettings& s = methods[i].settings;
    if (s.motion == motion && (s.uses_attitude || s.uses_gyro)) best = i;
  }
  return best;
}

void set_walk(const EstimateStudy& study, const Readings& readings, FilterSettings& settings) {
  const bool by_torques = settings.motion == Motion::disturbances;
  const auto& stated = by_torques ? study.disturbed_rate_walk : study.rate_walk;
  // A method driven by the gyro needs the random walk only in gaps of the gyro.
  FilterSettings searched = settings;
  if (settings.motion == Motion::gyro_drives) {
    searched.motion = Motion::rate_walks;
    searched.uses_attitude = true;
  }
  settings.rate_walk_rad_s_rts =
      stated ? *stated
             : max_likelihood_rate_walk(study.nominal.model, study.nominal.sensors, searched,
                                        readings, study.search_readings);
}

std::vector<std::string> unseen_by(const Platform& platform, const Readings& readings,
                                   const Estimation& e) {
  std::vector<std::string> lines;
  if (!readings.sees_attitude() && !readings.has_yaw) {
    lines.push_back(
        "no attitude was measured: it is relative to the start, and its error increases");
  } else if (!readings.sees_attitude()) {
    lines.push_back(
        "only the yaw of the attitude was measured; the tilt at the start is assumed to be 0 ± "
        "0.01 rad");
  } else if (!platform.turns_about_one_axis() &&
             !(readings.sees_axis[0] && readings.sees_axis[1] && readings.sees_axis[2])) {
    std::string axes;
    for (size_t k = 0; k < 3; ++k) {
      if (!readings.sees_axis[k]) axes += std::string(axes.empty() ? "" : ", ") + "xyz"[k];
    }
    lines.push_back("the attitude about lab " + axes + " was not read");
  }
  if (!readings.has_gyro) lines.push_back("no gyro: rates follow from attitudes and the model");
  if (readings.has_gyro && !platform.turns_about_one_axis()) {
    Vec3 seen = Vec3::Zero();
    for (const Reading& r : readings.all) {
      for (int k = 0; k < 3; ++k) seen[k] += std::isfinite(r.gyro_rad_s[k]) ? 1.0 : 0.0;
    }
    for (int k = 0; k < 3; ++k) {
      if (seen[k] == 0.0) lines.push_back(std::string("no gyro about body ") + "xyz"[k]);
    }
  }
  // Six standard deviations, because recordings have many readings.
  const auto odd = [](const InnovationSum& sum) {
    return sum.numbers > 0.0 &&
           std::abs(sum.per_number() - 1.0) > 6.0 * std::sqrt(2.0 / sum.numbers);
  };
  if (odd(e.attitude) || odd(e.gyro)) {
    lines.push_back(
        "the innovations differ from their prediction: noise or physics differs from the "
        "experiment (diagnose finds the cause)");
  }
  const Table parameters = parameter_table(e);
  for (size_t i = 0; i < parameters.columns[0].texts.size(); ++i) {
    const std::string& how = parameters.column("seen").texts[i];
    const auto at = static_cast<Eigen::Index>(i);
    const double moved = std::abs(e.parameters[at] - e.prior_mean[at]) / e.prior_sigma[at];
    constexpr double far = 3.0;
    if (moved > far) {
      lines.push_back(parameters.columns[0].texts[i] +
                      printed(" changed by %.1f of its sigmas: the estimate may be wrong", moved));
    }
    if (how != "yes") {
      lines.push_back(
          parameters.columns[0].texts[i] +
          (how == "no" ? " is not determined by the readings"
                       : " is partly determined: its error is more than 0.3 of the prior error"));
    }
  }
  return lines;
}

}  // namespace

void require_noise(const Sensors& sensors) {
  if (sensors.camera && !(sensors.camera->noise_rad.minCoeff() > 0.0)) {
    throw InputError({}, "sensors.camera.noise_arcsec", "no noise",
                     "numbers > 0, by which the filter weights the readings");
  }
  if (sensors.gyro && !(sensors.gyro->noise_rad_s > 0.0)) {
    throw InputError({}, "sensors.gyro.noise_rad_s", "no noise",
                     "a number > 0, by which the filter weights the readings");
  }
}

RecordingNoise with_noise_of(const Sensors& sensors, const Recording& recording,
                             const std::string& name, const Platform& platform) {
  RecordingNoise result{sensors, {}};
  const bool knows_camera = states_noise(sensors, 0), knows_gyro = states_noise(sensors, 3);
  if (knows_camera && knows_gyro) return result;
  const std::vector<Observation> seen = {observe(recording, name, platform)};
  const NoiseLevels usual;
  if (!knows_camera && seen[0].has_some_attitude()) {
    if (!result.sensors.camera) result.sensors.camera.emplace();
    Vec3& noise_rad = result.sensors.camera->noise_rad;
    for (int k = 0; k < 3; ++k) {
      const bool sees = seen[0].sees_axis[static_cast<size_t>(k)];
      noise_rad[k] = sees ? reading_level(seen, k).value_or(usual.of(k).level) : noise_rad[k];
      if (!(noise_rad[k] > 0.0)) noise_rad[k] = usual.of(k).level;
    }
    result.found.push_back(printed("noise of attitudes, from neighbours: %.3g, %.3g, %.3g arcsec",
                                   in_arcsec(noise_rad[0]), in_arcsec(noise_rad[1]),
                                   in_arcsec(noise_rad[2])));
  }
  if (!knows_gyro && seen[0].has_gyro) {
    double square = 0.0, axes = 0.0;
    for (int k = 3; k < 6; ++k) {
      const std::optional<double> level = reading_level(seen, k);
      square += level ? *level * *level : 0.0;
      axes += level ? 1.0 : 0.0;
    }
    if (!result.sensors.gyro) result.sensors.gyro.emplace();
    result.sensors.gyro->noise_rad_s =
        axes > 0.0 ? std::sqrt(square / axes) : usual.levels(3).maxCoeff();
    result.found.push_back(
        printed("noise of rates, from neighbours: %.3g rad/s", result.sensors.gyro->noise_rad_s));
  }
  return result;
}

EstimateStudy read_estimate(const Settings& root) {
  EstimateStudy study;
  study.nominal = read_attitude_model(root);
  const Settings own = own_table(root, "estimate", false);
  constexpr Motion motions[] = {Motion::disturbances, Motion::gyro_drives, Motion::rate_walks};
  study.filter.motion = motions[own.get(estimate_key::model)];
  if (own.has(estimate_key::rate_walk)) study.rate_walk = own.get(estimate_key::rate_walk);
  if (own.has(estimate_key::disturbed_rate_walk)) {
    study.disturbed_rate_walk = own.get(estimate_key::disturbed_rate_walk);
  }
  study.filter.rate_sigma_rad_s = own.get(estimate_key::rate_sigma);
  study.search_readings = static_cast<size_t>(own.get(estimate_key::search_readings));
  study.runs = static_cast<int>(own.get(estimate_key::runs));
  own.finish();
  return study;
}

EstimateResult estimate_by_all_methods(const EstimateStudy& study, const Readings& readings,
                                       const TruthTrack& truth,
                                       const std::function<void(double)>& progress) {
  EstimateResult result;
  result.methods = possible_methods(study, readings);
  result.chosen = choose(result.methods, study.filter.motion);
  const auto count = static_cast<double>(result.methods.size());
  for (size_t i = 0; i < result.methods.size(); ++i) {
    Ingredients& method = result.methods[i];
    set_walk(study, readings, method.settings);
    const MotionModel model(study.nominal.model, study.nominal.sensors, method.settings,
                            readings.schedule);
    EstimationOptions options;
    if (!readings.sees_attitude() && readings.has_yaw) {
      options.unread_attitude_rad2 = Vec3(level_rad2, level_rad2, pi * pi).asDiagonal();
    }
    if (progress) {
      options.progress = [&](double part) { progress((static_cast<double>(i) + part) / count); };
    }
    method.estimation = estimate_attitude(model, readings, options);
  }
  const Estimation& chosen = result.methods[result.chosen].estimation;
  Product& product = result.product;
  product.tables = {methods_table(result.methods, truth), parameter_table(chosen),
                    estimate_table(chosen)};
  product.plots = {methods_plot(result.methods, truth)};
  result.unseen = unseen_by(study.nominal.model.platform, readings, chosen);
  const auto exact = [&](const std::string& name, double value) {
    if (std::isfinite(value)) product.quantities.push_back({name, {value, 0.0}});
  };
  exact("predicted_filter_error_arcsec", in_arcsec(rms_sigma_rad(chosen.filtered)));
  exact("predicted_smoother_error_arcsec", in_arcsec(rms_sigma_rad(chosen.smoothed)));
  if (!truth.empty()) {
    const size_t from = settled_row(truth.size());
    exact("filter_error_arcsec",
          in_arcsec(run_errors(chosen.filtered, truth, from).rms_attitude_rad));
    exact("smoother_error_arcsec",
          in_arcsec(run_errors(chosen.smoothed, truth, from).rms_attitude_rad));
  }
  return result;
}

Recording recording_of(const std::vector<AttitudeEstimate>& estimates, const Recording& source) {
  Recording out;
  out.time_s = source.time_s;
  for (const char* name : quaternion_names) out.channels.push_back({name, {}});
  for (const char* name : gyro_names) out.channels.push_back({name, {}});
  for (const AttitudeEstimate& e : estimates) {
    const Quat& q = e.lab_from_body;
    const Vec3& w = e.inertial_rate_rad_s;
    const double row[] = {q.w(), q.x(), q.y(), q.z(), w.x(), w.y(), w.z()};
    for (size_t k = 0; k < std::size(row); ++k) out.channels[k].values.push_back(row[k]);
  }
  for (const Channel& channel : source.channels) {
    if (out.find(channel.name) == nullptr) out.channels.push_back(channel);
  }
  return out;
}

// Simulated runs, and the results of a filter on many of them.

SimulatedRun simulate_run(const PropagationRun& nominal, uint64_t seed) {
  PropagationRun run = nominal;
  run.seed = seed;
  uint64_t number = 0;
  constexpr uint64_t stream = 1000;  // different from those of the instruments
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
  result.ensemble = ensemble_of(all);
  const RunEnsemble& ensemble = result.ensemble;
  const std::vector<double>&filtered = ensemble.filtered.nees, &smoothed = ensemble.smoothed.nees,
        &rms_f = ensemble.filtered.rms_rad, &rms_s = ensemble.smoothed.rms_rad;
  const size_t from = settled_row(filtered.size());
  result.part_filtered = ensemble.part_in_band(ensemble.filtered, from);
  result.part_smoothed = ensemble.part_in_band(ensemble.smoothed, from);
  Plot plot{"normalised_errors",
            "Normalised errors squared, mean of " + std::to_string(study.runs) +
                " runs, and their 95 % band",
            "time [s]", "NEES of attitude and rate"};
  plot.levels = {ensemble.band.low, ensemble.band.high};
  Plot::Curve f{"filter"}, s{"smoother"}, ef{"filter"}, es{"smoother"};
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
  plot.below.push_back({"rms attitude error [arcsec]", {ef, es}, true});
  result.product.plots.push_back(plot);
  return result;
}

Key estimate_table() {
  using namespace estimate_key;
  return estimate.of({model, rate_walk, disturbed_rate_walk, rate_sigma, search_readings, runs});
}

}  // namespace photorque
