#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "attitude/filtering/study.h"
#include "core/errors.h"
#include "core/transform.h"
#include "tests/attitude/disturbance_bench.h"

namespace photorque {
namespace {

Sensors instruments(double camera_rad, double gyro_rad_s, double drift) {
  Sensors sensors;
  sensors.camera.emplace().noise_rad = Vec3::Constant(camera_rad);
  sensors.gyro.emplace().noise_rad_s = gyro_rad_s;
  sensors.gyro->bias_drift_rad_s_1_s = drift;
  return sensors;
}

// Readings of a platform at rest without noise: every `camera_every`th row has an attitude.
Readings at_rest(double interval_s, size_t rows, size_t camera_every, bool has_gyro) {
  Readings readings;
  readings.rows = rows;
  readings.sees_axis = {true, true, true};
  readings.has_gyro = has_gyro;
  for (size_t i = 0; i < rows; ++i) {
    Reading reading;
    reading.time_s = interval_s * static_cast<double>(i);
    reading.row = i;
    if (i % camera_every == 0) reading.lab_from_body = Quat::Identity();
    if (has_gyro) reading.gyro_rad_s.setZero();
    readings.all.push_back(reading);
  }
  readings.last_s = readings.all.back().time_s;
  return readings;
}

AttitudeModel free_body() {
  AttitudeModel model;
  model.platform.inertia_kg_m2 = Vec3(0.11, 0.12, 0.19).asDiagonal();
  return model;
}

// A filter that a gyro drives, with an attitude once a second: the steady state of R. Farrenkopf,
// J. Guid. Control 1 (1978) 282, as printed in F. Markley, J. Crassidis, Fundamentals of Spacecraft
// Attitude Determination and Control (2014), sec. 6.2.5. With S_u = σ_u T^1.5/σ_n, S_v = σ_v
// T^0.5/σ_n, γ² = 1 + S_v²/4 + S_u²/48 and ζ = γ + S_u/4 + √(2γS_u + S_v² + S_u²/3)/2, the error is
// σ_n √(1 − 1/ζ²) after an attitude and σ_n √(ζ² − 1) before it.
TEST(GyroDrivenFilter, ReachesFarrenkopfsSteadyState) {
  const double n = 6e-5, v = 2e-5, u = 1e-6, interval_s = 0.01;
  const double su = u / n, sv = v / n;
  const double gamma = std::sqrt(1.0 + sv * sv / 4.0 + su * su / 48.0);
  const double zeta =
      gamma + su / 4.0 + 0.5 * std::sqrt(2.0 * gamma * su + sv * sv + su * su / 3.0);
  const Sensors sensors = instruments(n, v / std::sqrt(interval_s), u);
  FilterSettings settings;
  settings.motion = Motion::gyro_drives;
  settings.rate_sigma_rad_s = 1e-2;
  const Readings readings = at_rest(interval_s, 12001, 100, true);
  const MotionModel model(free_body(), sensors, settings, {});
  EstimationOptions options;
  options.smooths = false;
  const Estimation e = estimate_attitude(model, readings, options);
  for (int axis = 0; axis < 3; ++axis) {
    const double after = std::sqrt(e.filtered[12000].covariance(axis, axis));
    const double before = std::sqrt(e.filtered[11999].covariance(axis, axis));
    // Each reading of the gyro represents an interval of a hundredth of the time between attitudes.
    EXPECT_NEAR(after / (n * std::sqrt(1.0 - 1.0 / (zeta * zeta))), 1.0, 5e-3);
    EXPECT_NEAR(before / (n * std::sqrt(zeta * zeta - 1.0)), 1.0, 1e-2);
  }
}

// A random walk of the rate, measured by a camera alone: the discrete Riccati equation of angle and
// rate, solved by SciPy 1.10 (scipy.linalg.solve_discrete_are) for T = 0.1 s, 3e-4 rad/s/√s, 6e-5
// rad.
TEST(WalkingRateFilter, ReachesTheSteadyStateOfTheRiccatiEquation) {
  FilterSettings settings;
  settings.motion = Motion::rate_walks;
  settings.rate_walk_rad_s_rts = 3e-4;
  settings.rate_sigma_rad_s = 1e-2;
  settings.uses_gyro = false;
  const MotionModel model(free_body(), instruments(6e-5, 1e-3, 0.0), settings, {});
  EstimationOptions options;
  options.smooths = false;
  const Estimation e = estimate_attitude(model, at_rest(0.1, 2000, 1, false), options);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(std::sqrt(e.filtered[1999].covariance(axis, axis)), 3.93502979e-05, 1e-10);
    EXPECT_NEAR(std::sqrt(e.filtered[1999].covariance(3 + axis, 3 + axis)), 1.67129160e-04, 1e-9);
  }
}

// Steps of a tenth of a radian: 100 s at 1 rad/s need a thousand, a year needs 3e8.
TEST(WalkingRateFilter, GivesUpWhereTheMotionIsTooFastForTheGap) {
  FilterSettings settings;
  settings.motion = Motion::rate_walks;
  settings.uses_gyro = false;
  const MotionModel model(free_body(), instruments(6e-5, 1e-3, 0.0), settings, {});
  FilterState state = model.start(0.0, Quat::Identity(), Mat3::Identity());
  state.mean.rate_body_rad_s = {1, 0, 0};
  const Vec3 no_gyro = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  model.advance(state, 100.0, no_gyro);
  EXPECT_EQ(state.mean.time_s, 100.0);
  EXPECT_THROW(model.advance(state, 3.2e7, no_gyro), NumericalError);
}

// The smoother compared with an estimate from all readings at once: angle and rate of one axis at N
// instants are one Gaussian, whose information is the sum of that of the start, all steps and all
// readings.
TEST(Smoother, EqualsTheJointEstimate) {
  constexpr int count = 12;
  const double h = 0.05, q = 3e-4 * 3e-4, n = 6e-5, rate_sigma = 2e-3, wide = 0.05;
  Readings readings = at_rest(h, count, 1, false);
  MatX information = MatX::Zero(2 * count, 2 * count);
  VecX vector = VecX::Zero(2 * count);
  information(0, 0) += 1.0 / (wide * wide);
  information(1, 1) += 1.0 / (rate_sigma * rate_sigma);
  Eigen::Matrix2d noise;
  noise << h * h * h / 3, h * h / 2, h * h / 2, h;
  for (int i = 0; i < count; ++i) {
    const double angle = 2e-4 * std::sin(1.7 * i) + 1e-3;
    readings.all[static_cast<size_t>(i)].lab_from_body = turn_by({0, 0, angle});
    if (i == 0) vector[0] += angle / (wide * wide);
    information(2 * i, 2 * i) += 1.0 / (n * n);
    vector[2 * i] += angle / (n * n);
    if (i == 0) continue;
    Eigen::Matrix<double, 2, 4> step;  // x_i − Φ x_{i−1}
    step << -1, -h, 1, 0, 0, -1, 0, 1;
    information.block<4, 4>(2 * i - 2, 2 * i - 2) +=
        step.transpose() * (q * noise).inverse() * step;
  }
  const MatX covariance = information.inverse();
  const VecX mean = covariance * vector;
  FilterSettings settings;
  settings.motion = Motion::rate_walks;
  settings.rate_walk_rad_s_rts = std::sqrt(q);
  settings.rate_sigma_rad_s = rate_sigma;
  settings.uses_gyro = false;
  const MotionModel model(free_body(), instruments(n, 1e-3, 0.0), settings, {});
  const Estimation e = estimate_attitude(model, readings);
  for (int i = 0; i < count; ++i) {
    const AttitudeEstimate& one = e.smoothed[static_cast<size_t>(i)];
    EXPECT_NEAR(turn_vector(one.lab_from_body).z(), mean[2 * i], 1e-9) << i;
    EXPECT_NEAR(one.rate_body_rad_s.z(), mean[2 * i + 1], 1e-8) << i;
    EXPECT_NEAR(one.covariance(2, 2) / covariance(2 * i, 2 * i), 1.0, 1e-5) << i;
    EXPECT_NEAR(one.covariance(5, 5) / covariance(2 * i + 1, 2 * i + 1), 1.0, 1e-5) << i;
  }
}

AttitudeModel disturbed_body() {
  AttitudeModel model = with(bench_model(), "static_unbalance", "offset_m = [3e-6, -2e-6, -2e-5]");
  for (Parameter& p : model.disturbances.back().parameters) p.sigma = 1e-6;
  model = with(model, "bearing_drag", "coefficient_N_m_s = 2e-5");
  model.disturbances.back().parameters[0].sigma = 5e-6;
  model = with(model, "earth_rotation");
  model = with(model, "gyro_bias", "bias_rad_s = [1e-4, -2e-4, 3e-4]");
  for (Parameter& p : model.disturbances.back().parameters) p.sigma = 1e-3;
  return model;
}

FilterState somewhere(const MotionModel& model) {
  FilterState state =
      model.start(0.0, lab_from_body_at(0.2, 0.7).rotation, 1e-8 * Mat3::Identity());
  state.mean.rate_body_rad_s = {0.05, -0.03, 0.2};
  return state;
}

// The transition of the error state compared with differences of the motion.
TEST(MotionOfAFilter, HasTheTransitionOfItsMean) {
  const Sensors sensors = instruments(6e-5, 2e-4, 0.0);
  for (const Motion motion : {Motion::disturbances, Motion::rate_walks, Motion::gyro_drives}) {
    FilterSettings settings;
    settings.motion = motion;
    const MotionModel model(disturbed_body(), sensors, settings, {});
    const Vec3 gyro_rad_s(0.051, -0.032, 0.199);
    FilterState nominal = somewhere(model);
    const Transition way = model.advance(nominal, 0.04, gyro_rad_s);
    for (int k = 0; k < model.size(); ++k) {
      const double step =
          k < MotionModel::extra ? 1e-5 : 1e-2 * model.prior_sigma()[k - MotionModel::extra];
      VecX column[2];
      for (const int side : {0, 1}) {
        FilterState moved = somewhere(model);
        // Rebuilds the dynamics at the parameter.
        moved.covariance *= 1e-20;
        model.add(moved, (side == 0 ? step : -step) * VecX::Unit(model.size(), k));
        model.advance(moved, 0.04, gyro_rad_s);
        column[side] = model.difference(moved, nominal);
      }
      const VecX slope = (column[0] - column[1]) / (2.0 * step);
      EXPECT_LT((slope - way.phi.col(k)).norm(), 2e-4 * slope.norm())
          << k << " of motion " << static_cast<int>(motion);
    }
  }
}

// A run with noise and drawn parameters, which study_of() estimates.
PropagationRun drawn_run() {
  PropagationRun run;
  run.model = disturbed_body();
  run.sensors = instruments(1e-4, 2e-4, 0.0);
  run.sensors.camera->noise_rad = {1.8e-4, 1.8e-4, 6e-5};
  run.initial = Dynamics(run.model).initial_state({0.02, -0.01, 0.1});
  run.initial.lab_from_body = lab_from_body_at(0.1, 0.5).rotation;
  run.duration_s = 20.0;
  run.output_rate_Hz = 4.0;
  run.seed = 11;
  return run;
}

EstimateStudy study_of(const PropagationRun& run, int runs) {
  EstimateStudy study;
  study.nominal = {run.model, run.sensors, {}};
  study.filter.rate_walk_rad_s_rts = 1e-9;
  study.runs = runs;
  return study;
}

// The mean of e P⁻¹ e over 100 runs is 6 ± √(12/100). The tested rows must be within four standard
// errors and most rows within the 95 % band. The same holds for the innovations.
TEST(Consistency, OfTheFilterOver100Runs) {
  const PropagationRun run = drawn_run();
  const EstimateStudy study = study_of(run, 100);
  const ConsistencyResult result = consistency_of(study, run, study.filter);
  const std::vector<double> filtered = result.ensemble.filtered.nees;
  const std::vector<double> smoothed = result.ensemble.smoothed.nees;
  const double error = std::sqrt(12.0 / 100.0);
  for (size_t row = 8; row < filtered.size(); row += 8) {
    EXPECT_NEAR(filtered[row], 6.0, 4.0 * error) << row;
    EXPECT_NEAR(smoothed[row], 6.0, 4.0 * error) << row;
  }
  EXPECT_GE(result.part_filtered, 0.85);
  for (const InnovationSum* sum : {&result.ensemble.attitude, &result.ensemble.gyro}) {
    EXPECT_NEAR(sum->per_number(), 1.0, 4.0 * std::sqrt(2.0 / sum->numbers));
  }
  // The smoother is better than the filter except at the end, where both are equal.
  EXPECT_LT(result.worst_gain, 1.0);
}

// A deliberately wrong filter, which assumes 25 % less noise than the sensors have.
TEST(Consistency, IsLostWithTheWrongNoise) {
  const PropagationRun run = drawn_run();
  EstimateStudy study = study_of(run, 25);
  study.nominal.sensors.camera->noise_rad *= 0.75;
  study.nominal.sensors.gyro->noise_rad_s *= 0.75;
  const ConsistencyResult result = consistency_of(study, run, study.filter);
  EXPECT_LT(result.part_filtered, 0.3);
  const InnovationSum& camera = result.ensemble.attitude;
  EXPECT_GT(camera.per_number(), 1.0 + 10.0 * std::sqrt(2.0 / camera.numbers));
}

// The smoother's covariance is not above the filter's in any direction.
TEST(Smoother, IsNowhereLessCertainThanTheFilter) {
  const PropagationRun run = drawn_run();
  const SimulatedRun simulated = simulate_run(run, 3);
  for (const Motion motion : {Motion::disturbances, Motion::rate_walks, Motion::gyro_drives}) {
    FilterSettings settings;
    settings.motion = motion;
    settings.rate_walk_rad_s_rts = 1e-3;
    const Readings readings = readings_of(simulated.recording, "run", run.model.platform, 0.0);
    const MotionModel model(run.model, run.sensors, settings, readings.schedule);
    const Estimation e = estimate_attitude(model, readings);
    for (size_t i = 0; i < e.filtered.size(); ++i) {
      const VecX scale = e.filtered[i].covariance.diagonal().cwiseSqrt().cwiseInverse();
      const MatX gain = scale.asDiagonal() * (e.filtered[i].covariance - e.smoothed[i].covariance) *
                        scale.asDiagonal();
      EXPECT_GT(Eigen::SelfAdjointEigenSolver<MatX>(gain).eigenvalues()[0], -1e-6) << i;
    }
  }
}

// 20 s without attitudes: the filter's error grows during the gap, that of the smoother less. After
// the gap both are as before.
TEST(Estimates, BridgeGaps) {
  PropagationRun run = drawn_run();
  run.duration_s = 60.0;
  SimulatedRun simulated = simulate_run(run, 4);
  for (Channel& channel : simulated.recording.channels) {
    if (!channel.name.starts_with("q_")) continue;
    for (size_t i = 80; i < 160; ++i) channel.values[i] = empty_cell;
  }
  FilterSettings settings;
  settings.motion = Motion::gyro_drives;
  settings.rate_walk_rad_s_rts = 1e-3;
  const Readings readings = readings_of(simulated.recording, "run", run.model.platform, 0.0);
  EXPECT_NEAR(readings.longest_gap_s, 20.25, 1e-9);
  const MotionModel model(run.model, run.sensors, settings, readings.schedule);
  const Estimation e = estimate_attitude(model, readings);
  EXPECT_GT(e.filtered[159].attitude_sigma_rad(), 2.0 * e.filtered[79].attitude_sigma_rad());
  EXPECT_LT(e.smoothed[120].attitude_sigma_rad(), 0.9 * e.filtered[120].attitude_sigma_rad());
  EXPECT_LT(e.filtered[200].attitude_sigma_rad(), 1.2 * e.filtered[79].attitude_sigma_rad());
  const RunErrors errors = run_errors(e.smoothed, simulated.truth, 10);
  EXPECT_LT(errors.rms_attitude_rad, 5.0 * e.smoothed[120].attitude_sigma_rad());
}

// An encoder instead of a camera, on a level table: its steps of 20 arcsec determine the yaw, which
// the gyro alone loses because of its bias.
TEST(Estimates, TakeTheHeadingOfAnEncoder) {
  PropagationRun run = drawn_run();
  std::erase_if(run.model.disturbances,
                [](const Disturbance& d) { return d.kind == "static_unbalance"; });
  run.initial = Dynamics(run.model).initial_state({0.0, 0.0, 0.1});
  run.sensors.camera.reset();
  run.sensors.encoder.emplace().resolution_rad = 20 * arcsecond_rad;
  const SimulatedRun simulated = simulate_run(run, 6);
  FilterSettings settings;
  settings.motion = Motion::gyro_drives;
  const auto heading_error_rad = [&](bool uses_encoder) {
    settings.uses_attitude = uses_encoder;
    const Readings readings = readings_of(simulated.recording, "run", run.model.platform, 0.0);
    EXPECT_TRUE(readings.has_yaw);
    EXPECT_FALSE(readings.sees_attitude());
    const MotionModel model(run.model, run.sensors, settings, readings.schedule);
    EstimationOptions options;
    options.unread_attitude_rad2 = Vec3(1e-8, 1e-8, 1e-2).asDiagonal();
    const AttitudeEstimate end = estimate_attitude(model, readings, options).filtered.back();
    return std::abs(
        turn_vector(end.lab_from_body * simulated.truth.back()->lab_from_body.conjugate()).z());
  };
  EXPECT_LT(heading_error_rad(true), 20 * arcsecond_rad);
  EXPECT_GT(heading_error_rad(false), 200 * arcsecond_rad);
}

// The scale of the gyro is estimated for axes with rotation. For an axis without rotation it is
// not, and the estimate reports this.
TEST(Estimates, FindTheScaleOfAGyroThatTurns) {
  PropagationRun run;
  run.model.platform.inertia_kg_m2 = 0.1 * Mat3::Identity();
  run.model = with(run.model, "gyro_scale", "scale = [0, 0, 0]");
  for (Parameter& p : run.model.disturbances.back().parameters) p.sigma = 0.01;
  // With constant rates, only the prior of the bias separates scale from bias.
  run.model = with(run.model, "gyro_bias", "bias_rad_s = [0, 0, 0]");
  for (Parameter& p : run.model.disturbances.back().parameters) p.sigma = 1e-5;
  run.sensors = instruments(1e-4, 2e-4, 0.0);
  run.initial = Dynamics(run.model).initial_state({0.3, -0.2, 0.0});
  run.duration_s = 30.0;
  run.output_rate_Hz = 4.0;
  const SimulatedRun simulated = simulate_run(run, 21);
  const EstimateStudy study = study_of(run, 0);
  const Readings readings = readings_of(simulated.recording, "run", run.model.platform, 0.0);
  const EstimateResult result = estimate_by_all_methods(study, readings, simulated.truth);
  const Estimation& e = result.methods[result.chosen].estimation;
  ASSERT_EQ(e.parameter_names[0], "gyro_scale.scale[0]");
  for (int axis = 0; axis < 3; ++axis) {
    // The arguments with which simulate_run() draws the parameters: the seed, its stream and an
    // index.
    const double truth = 0.01 * gaussian(21, 1000, static_cast<uint64_t>(axis), 0);
    EXPECT_LT(std::abs(e.parameters[axis] - truth), 4.0 * e.sigma[axis]);
    EXPECT_LT(e.sigma[axis], axis < 2 ? 0.003 : 0.011);
  }
  EXPECT_GT(e.sigma[2], 0.009);
  EXPECT_THAT(result.unseen,
              testing::Contains("gyro_scale.scale[2] is not determined by the readings"));
  EXPECT_THAT(result.unseen,
              testing::Not(testing::Contains(testing::StartsWith("gyro_scale.scale[0]"))));
}

// With attitudes of a late camera dated back, the filter is as good as without latency.
TEST(Estimates, DateLateAttitudesBack) {
  PropagationRun run = drawn_run();
  run.model = with(run.model, "attitude_latency", "latency_s = 0.1");
  const SimulatedRun simulated = simulate_run(run, 5);
  FilterSettings settings;
  const MotionModel model(run.model, run.sensors, settings, {});
  EXPECT_DOUBLE_EQ(model.camera_delay_s(), 0.1);
  const auto rms = [&](double delay_s) {
    const Readings readings = readings_of(simulated.recording, "run", run.model.platform, delay_s);
    const MotionModel own(run.model, run.sensors, settings, readings.schedule);
    return run_errors(estimate_attitude(own, readings).filtered, simulated.truth, 10)
        .rms_attitude_rad;
  };
  // The platform rotates at 0.1 rad/s: 0.01 rad during the latency of 0.1 s.
  EXPECT_LT(rms(0.1), 4e-4);
  EXPECT_GT(rms(0.0), 5e-3);
}

// The quantiles 2.5 % and 97.5 % of tables (Abramowitz and Stegun, table 26.8): 3.2470 and 20.4832
// for 10, 74.2219 and 129.5612 for 100 degrees of freedom.
TEST(Bands, AreThoseOfTables) {
  EXPECT_NEAR(chi2_band_95(10).low / 3.24697, 1.0, 1e-2);
  EXPECT_NEAR(chi2_band_95(10).high / 20.48318, 1.0, 2e-3);
  EXPECT_NEAR(chi2_band_95(100).low / 74.22193, 1.0, 5e-4);
  EXPECT_NEAR(chi2_band_95(100).high / 129.5612, 1.0, 5e-4);
}

TEST(SmallTurns, UndoEachOther) {
  for (const double size : {1e-12, 1e-6, 0.3, 3.1}) {
    const Vec3 v = size * Vec3(0.6, -0.48, 0.64);
    EXPECT_LT((turn_vector(turn_by(v)) - v).norm(), 1e-14 + 1e-13 * size);
    // turn_by(θ + δ) = turn_by(J δ) turn_by(θ).
    const Vec3 small = 1e-6 * Vec3(0.2, 0.9, -0.3);
    const Vec3 found = turn_vector(turn_by(v + small) * turn_by(v).conjugate());
    EXPECT_LT((found - turn_jacobian(v) * small).norm(), 1e-11);
  }
}

}  // namespace
}  // namespace photorque
