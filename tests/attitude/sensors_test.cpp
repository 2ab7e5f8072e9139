#include "attitude/recordings/sensors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "attitude/propagation/run.h"
#include "core/constants.h"
#include "tests/attitude/disturbance_bench.h"

namespace photorque {
namespace {

// A platform that rotates at a constant rate about lab z and body z.
PropagationRun spinning(double rate_rad_s, double duration_s, double rows_per_s) {
  PropagationRun run;
  run.model.platform.inertia_kg_m2 = 0.1 * Mat3::Identity();
  run.sensors = perfect_sensors();
  run.initial = Dynamics(run.model).initial_state({0, 0, rate_rad_s});
  run.duration_s = duration_s;
  run.output_rate_Hz = rows_per_s;
  return run;
}

const std::vector<double>& values(const Recording& recording, std::string_view name) {
  return recording.find(name)->values;
}

Quat attitude(const Recording& r, size_t row) {
  return {values(r, "q_w")[row], values(r, "q_x")[row], values(r, "q_y")[row],
          values(r, "q_z")[row]};
}

double heading(const Quat& q) {
  return 2.0 * std::atan2(q.z(), q.w());
}

TEST(Gaussian, HasTheMomentsOfTheNormalDistribution) {
  constexpr int count = 200000;
  double sum = 0, square = 0, fourth = 0, neighbours = 0, before = 0;
  for (int i = 0; i < count; ++i) {
    const double x = gaussian(42, 1, static_cast<uint64_t>(i), 0);
    sum += x;
    square += x * x;
    fourth += x * x * x * x;
    neighbours += x * before;
    before = x;
  }
  // Four standard errors: variances of x, x², x⁴ and x y are 1, 2, 96 and 1.
  const double standard_error = 1 / std::sqrt(count);
  EXPECT_NEAR(sum / count, 0.0, 4 * standard_error);
  EXPECT_NEAR(square / count, 1.0, 4 * std::sqrt(2.0) * standard_error);
  EXPECT_NEAR(fourth / count, 3.0, 4 * std::sqrt(96.0) * standard_error);
  EXPECT_NEAR(neighbours / count, 0.0, 4 * standard_error);
}

TEST(Camera, NoiseIsAboutLabAxesAndOfTheSizeAsked) {
  PropagationRun run = spinning(0.2, 2000.0, 10.0);
  run.sensors.camera->noise_rad = Vec3(37, 20, 12) * arcsecond_rad;
  const PropagationResult result = propagate(run);
  Vec3 squares = Vec3::Zero(), mean = Vec3::Zero();
  const size_t n = result.recording.rows();
  for (size_t i = 0; i < n; ++i) {
    const Quat error = attitude(result.recording, i) * result.states[i].lab_from_body.conjugate();
    const Vec3 rotation = 2.0 * error.vec() * std::copysign(1.0, error.w());
    squares += rotation.cwiseAbs2();
    mean += rotation;
  }
  for (int k = 0; k < 3; ++k) {
    const double sigma = run.sensors.camera->noise_rad[k];
    const double standard_error = sigma / std::sqrt(static_cast<double>(n));
    EXPECT_NEAR(mean[k] / static_cast<double>(n), 0.0, 4 * standard_error);
    EXPECT_NEAR(std::sqrt(squares[k] / static_cast<double>(n)), sigma,
                4 * standard_error / std::sqrt(2.0));
  }
}

// Before the start, the platform is assumed to rotate at its initial rate.
TEST(Camera, WithLatencyReportsThePast) {
  PropagationRun run = spinning(0.2, 20.0, 10.0);
  run.model = with(run.model, "attitude_latency", "latency_s = 0.37");
  const Recording recording = propagate(run).recording;
  for (size_t i = 0; i < recording.rows(); ++i) {
    const double seen_s = recording.time_s[i] - 0.37;
    EXPECT_NEAR(std::remainder(heading(attitude(recording, i)) - 0.2 * seen_s, 2 * pi), 0.0, 1e-9);
  }
}

TEST(Camera, MisalignmentTurnsWithTheBody) {
  PropagationRun run = spinning(0.2, 20.0, 10.0);
  run.model = with(run.model, "camera_misalignment", "misalignment_rad = [0.01, 0, 0]");
  const PropagationResult result = propagate(run);
  for (size_t i = 0; i < result.states.size(); ++i) {
    const Quat expected = result.states[i].lab_from_body * turned(0.01, {1, 0, 0});
    EXPECT_LT(attitude(result.recording, i).angularDistance(expected), 1e-12);
  }
}

TEST(Gyro, BiasScaleAndMisalignmentAddUp) {
  PropagationRun run = spinning(0.2, 1.0, 10.0);
  run.model = with(run.model, "gyro_bias", "bias_rad_s = [1e-3, 2e-3, -3e-3]");
  run.model = with(run.model, "gyro_scale", "scale = [0.5, 0.5, 0.01]");
  run.model = with(run.model, "gyro_misalignment", "misalignment_rad = [0.002, 0.001, 0.3]");
  const Recording recording = propagate(run).recording;
  // m × ω of m = (0.002, 0.001, 0.3) and ω = (0, 0, 0.2).
  EXPECT_NEAR(values(recording, "gyro_x_rad_s")[5], 1e-3 + 0.001 * 0.2, 1e-15);
  EXPECT_NEAR(values(recording, "gyro_y_rad_s")[5], 2e-3 - 0.002 * 0.2, 1e-15);
  EXPECT_NEAR(values(recording, "gyro_z_rad_s")[5], 0.2 * 1.01 - 3e-3, 1e-15);
}

TEST(Gyro, NoiseIsWhiteAndDriftWalks) {
  PropagationRun run = spinning(0.0, 4000.0, 10.0);
  run.sensors.gyro->noise_rad_s = 2e-4;
  const Recording noisy = propagate(run).recording;
  double square = 0.0;
  for (const double x : values(noisy, "gyro_x_rad_s")) square += x * x;
  const double n = static_cast<double>(noisy.rows());
  EXPECT_NEAR(std::sqrt(square / n), 2e-4, 4 * 2e-4 / std::sqrt(2 * n));

  run.sensors.gyro->noise_rad_s = 0.0;
  run.sensors.gyro->bias_drift_rad_s_1_s = 1e-5;
  const Recording drifting = propagate(run).recording;
  // Increments over 0.1 s are independent, of standard deviation 1e-5 √0.1.
  double steps = 0.0;
  for (const char* name : {"gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s"}) {
    const std::vector<double>& x = values(drifting, name);
    for (size_t i = 1; i < x.size(); ++i) steps += (x[i] - x[i - 1]) * (x[i] - x[i - 1]);
  }
  const double expected = 1e-5 * std::sqrt(0.1);
  EXPECT_NEAR(std::sqrt(steps / (3 * n)), expected, 4 * expected / std::sqrt(6 * n));
}

TEST(Instruments, ReadAtTheirOwnRate) {
  PropagationRun run = spinning(0.1, 10.0, 160.0);
  run.sensors.gyro->rate_Hz = 20.0;
  run.sensors.camera->rate_Hz = 7.0;
  const Recording recording = propagate(run).recording;
  size_t gyro = 0, camera = 0;
  for (size_t i = 0; i < recording.rows(); ++i) {
    gyro += std::isnan(values(recording, "gyro_z_rad_s")[i]) ? 0 : 1;
    camera += std::isnan(values(recording, "q_z")[i]) ? 0 : 1;
    EXPECT_EQ(std::isnan(values(recording, "gyro_z_rad_s")[i]), i % 8 != 0);
  }
  EXPECT_EQ(gyro, 201u);
  EXPECT_EQ(camera, 71u);
}

TEST(Encoder, CountsWholeSteps) {
  PropagationRun run = spinning(0.1, 10.0, 10.0);
  run.sensors.encoder = Sensors::Encoder{2 * pi / 4096};
  const PropagationResult result = propagate(run);
  for (size_t i = 0; i < result.states.size(); ++i) {
    const double reading = values(result.recording, "yaw_rad")[i];
    EXPECT_NEAR(reading, 0.1 * result.recording.time_s[i], pi / 4096 + 1e-12);
    EXPECT_NEAR(std::remainder(reading, 2 * pi / 4096), 0.0, 1e-12);
  }
}

TEST(Recordings, DependOnTheSeedAndOnNothingElse) {
  PropagationRun run = spinning(0.1, 10.0, 10.0);
  run.sensors.camera->noise_rad = Vec3::Constant(1e-4);
  run.sensors.gyro->noise_rad_s = 1e-4;
  const Recording first = propagate(run).recording, again = propagate(run).recording;
  run.sensors.gyro.reset();
  const Recording without_gyro = propagate(run).recording;
  run.seed = 2;
  const Recording other = propagate(run).recording;
  EXPECT_EQ(values(first, "q_x"), values(again, "q_x"));
  EXPECT_EQ(values(first, "gyro_x_rad_s"), values(again, "gyro_x_rad_s"));
  EXPECT_EQ(values(first, "q_x"), values(without_gyro, "q_x"));
  EXPECT_NE(values(first, "q_x"), values(other, "q_x"));
}

}  // namespace
}  // namespace photorque
