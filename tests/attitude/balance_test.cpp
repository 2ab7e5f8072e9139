#include "attitude/studies/balance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "attitude/propagation/run.h"
#include "core/errors.h"
#include "tests/attitude/disturbance_bench.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

constexpr double true_offset_m[3] = {2e-5, -1e-5, -3e-4};

std::vector<MovingMass> masses() {
  MovingMass mass;
  mass.mass_kg = 0.25;
  mass.lead_m = 2e-3;
  mass.step_angle_rad = 1.8 * degree_rad;
  return eight_masses(mass);
}

// The model with a load of 30 W, whose battery displaces the centre of mass.
AttitudeModel draining(const AttitudeModel& model) {
  const AttitudeModel loaded = with(model, "power_balance", "load_W = 30.0");
  return with(loaded, "battery_discharge", "shift_m_per_Ah = [1e-5, 0, 0]");
}

// Ten minutes of an unbalanced tabletop with drag and a biased gyro, measured by the contract's
// sensors, and its nominal model: no unbalance; drag and bias within their uncertainty.
BalanceRun unbalanced(bool with_gyro, uint64_t seed, bool drains = false) {
  PropagationRun truth;
  truth.model = with(bench_model(), "static_unbalance", "offset_m = " + toml(true_offset_m));
  truth.model = with(truth.model, "bearing_drag", "coefficient_N_m_s = 1.5e-5");
  truth.model = with(truth.model, "gyro_bias", "bias_rad_s = [1e-3, -5e-4, 2e-4]");
  if (drains) truth.model = draining(truth.model);
  truth.model.schedule.append(100.0, {.command_body_N_m = {2e-4, 0, 1e-4}});
  truth.model.schedule.append(110.0, {});
  truth.sensors = perfect_sensors();
  truth.sensors.camera = Sensors::Camera{};
  truth.sensors.gyro->noise_rad_s = 2e-4;
  if (!with_gyro) truth.sensors.gyro.reset();
  truth.duration_s = 600.0;
  truth.output_rate_Hz = 5.0;
  truth.seed = seed;
  truth.initial = state_of(truth.model, turned(0.2, {1, 1, 0}), {0.01, -0.01, 0.1});

  BalanceRun run;
  run.model =
      with(bench_model(), "bearing_drag", "coefficient_N_m_s = {value = 1e-5, sigma = 1e-5}");
  run.model =
      with(run.model, "gyro_bias", "bias_rad_s = {value = [0, 0, 0], sigma = [1e-3, 1e-3, 1e-3]}");
  if (drains) run.model = draining(run.model);
  run.sensors = truth.sensors;
  run.masses = masses();
  run.recording = propagate(truth).recording;
  run.model.schedule = run.recording.schedule();
  return run;
}

void expect_offset(const BalanceResult& result, double within_sigma = 4.0) {
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(result.offset_body_m[k], true_offset_m[k], within_sigma * result.sigma_m[k]) << k;
  }
}

// The recorded current of the battery is the total current. If the model added its load to it, the
// shift by a third of an ampere hour would be wrong by 3e-6 m.
TEST(Balance, TheMeasuredCurrentCountsOnce) {
  const BalanceRun run = unbalanced(true, 6, true);
  ASSERT_NE(run.recording.find("battery_current_A"), nullptr);
  expect_offset(balance(run));
}

TEST(Balance, ACameraAloneSuffices) {
  expect_offset(balance(unbalanced(false, 4)));
}

// A dipole that is missing in the model biases the fit: the offset is wrong, with a warning. The
// standard errors are increased by the misfit, so that the true offset is within 8 of them; without
// the increase it would be 50 away.
TEST(Balance, AMissingEffectIsReportedAndIncreasesTheErrors) {
  BalanceRun run = unbalanced(true, 7);
  EXPECT_FALSE(balance(run).exceeds_noise());
  PropagationRun truth;
  truth.model = with(bench_model(), "static_unbalance", "offset_m = " + toml(true_offset_m));
  truth.model = with(truth.model, "magnetic_dipole", "dipole_A_m2 = [0.2, 0, 0.1]");
  truth.sensors = run.sensors;
  truth.duration_s = 600.0;
  truth.output_rate_Hz = 10.0;
  truth.initial = state_of(truth.model, turned(0.2, {1, 1, 0}), {0.01, -0.01, 0.1});
  run.recording = propagate(truth).recording;
  run.model.schedule = run.recording.schedule();
  const BalanceResult result = balance(run);
  EXPECT_TRUE(result.exceeds_noise());
  EXPECT_NE(result.warning(), "");
  EXPECT_GT(result.chi2_per_sample, 2.0);
  expect_offset(result, 8.0);
}

// The motion is not predictable over three hours without readings, so both segments have separate
// initial states.
TEST(Balance, AGapCutsTheRecording) {
  BalanceRun run = unbalanced(true, 8);
  const size_t half = run.recording.rows() / 2;
  run.model.schedule = {};
  for (size_t i = half; i < run.recording.rows(); ++i) run.recording.time_s[i] += 1e4;
  run.recording.report.gaps = {{run.recording.time_s[half - 1], run.recording.time_s[half]}};
  std::erase_if(run.recording.channels,
                [](const Channel& c) { return c.name.starts_with("command"); });
  // The first segment has readings only after the end of its commands.
  for (size_t i = 0; i < half; ++i) {
    if (run.recording.time_s[i] > 115.0) continue;
    for (Channel& c : run.recording.channels) c.values[i] = NAN;
  }
  const BalanceResult result = balance(run);
  EXPECT_EQ(result.segments, 2u);
  expect_offset(result);
  EXPECT_LT(result.sigma_m.maxCoeff(), 1e-8);
  EXPECT_GT(result.sigma_m.minCoeff(), 0.0);
}

TEST(Balance, MomentumGivesAStartWithoutOne) {
  const BalanceRun run = unbalanced(true, 5);
  const Vec3 offset_m = offset_from_momentum_m(
      run.model.platform, run.model.environment.gravity_lab_m_s2, run.recording);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(offset_m[k], true_offset_m[k], 1e-6);
}

// After the masses moved, an offset of up to half a step may remain on each axis. The paper's
// 1.79e-7 m is such a half step.
TEST(Balance, LeavesNoMoreThanTheStepsMust) {
  const BalanceRun run = unbalanced(true, 6);
  const BalanceResult result = balance(run);
  EXPECT_NEAR(result.resolution_m, 1.79e-7, 0.01e-7);
  for (int k = 0; k < 3; ++k) {
    EXPECT_LE(std::abs(result.command.left_over_m[k]), result.resolution_m * 1.0001);
  }
  Vec3 moved_m = Vec3::Zero();
  for (size_t i = 0; i < run.masses.size(); ++i) {
    moved_m += static_cast<double>(result.command.steps[i]) *
               run.masses[i].com_step_m(run.model.platform.mass_kg);
  }
  EXPECT_LT((result.offset_body_m + moved_m - result.command.left_over_m).norm(), 1e-12);
  const Product product = balance_product(run, result);
  EXPECT_EQ(product.tables[0].columns[1].values[2], result.offset_body_m.z());
  EXPECT_EQ(product.tables[1].columns[4].values.size(), 8u);
}

TEST(Balance, RefusesRecordingsWithoutAttitude) {
  BalanceRun run = unbalanced(true, 7);
  std::erase_if(run.recording.channels, [](const Channel& c) { return c.name == "q_w"; });
  EXPECT_THROW(balance(run), InputError);
  EXPECT_THROW(observe(run.recording, "recording"), InputError);
}

TEST(Balance, AttitudesOfNoLengthAreNone) {
  BalanceRun run = unbalanced(true, 8);
  for (Channel& c : run.recording.channels) {
    if (c.name.starts_with("q_")) std::ranges::fill(c.values, 0.0);
  }
  EXPECT_THAT(refusal_of([&] {
                offset_from_momentum_m(run.model.platform, run.model.environment.gravity_lab_m_s2,
                                       run.recording);
              }),
              testing::HasSubstr("found 0 rows with an attitude and a rate"));
}

// The estimates of many recordings scatter by their standard errors.
TEST(Balance, StandardErrorsAreTheScatterOfTheEstimates) {
  constexpr int runs = 16;
  double squares = 0.0;
  for (int i = 0; i < runs; ++i) {
    const BalanceResult result = balance(unbalanced(true, 100 + static_cast<uint64_t>(i)));
    EXPECT_LT(result.sigma_m.maxCoeff(), 5e-9);
    EXPECT_NEAR(result.fit.chi2_per_sample(), 1.0, 0.03);
    for (int k = 0; k < 3; ++k) {
      const double pull = (result.offset_body_m[k] - true_offset_m[k]) / result.sigma_m[k];
      squares += pull * pull;
    }
  }
  // 48 squared pulls, nearly independent: mean 1, standard error √(2/48) = 0.20.
  EXPECT_NEAR(squares / (3 * runs), 1.0, 0.6);
}

}  // namespace
}  // namespace photorque
