// Predicted readings of instruments compared with those that `propagate` records.
#include "attitude/observation/prediction.h"

#include <gtest/gtest.h>

#include "attitude/propagation/run.h"
#include "tests/attitude/disturbance_bench.h"

namespace photorque {
namespace {

// A pendulum of 0.3 rad/s that is measured with a latency of 0.2 s. The recorder computes the
// attitude at the earlier instant. The prediction extrapolates the motion backwards with rate and
// acceleration, with an error of a sixth of the third derivative times 0.2³: 2e-6 rad. With the
// rate alone the error would be 2e-4 rad, five standard deviations of a camera.
TEST(Prediction, OfALateCameraIsThePastAttitude) {
  PropagationRun run;
  run.model = with(with(bench_model(), "static_unbalance", "offset_m = [0, 0, -1.5e-4]"),
                   "attitude_latency", "latency_s = 0.2");
  run.sensors = {};
  run.sensors.camera.emplace();
  run.sensors.camera->noise_rad = Vec3::Zero();
  run.initial = state_of(run.model, turned(0.1, {0, 1, 0}));
  run.duration_s = 60.0;
  run.output_rate_Hz = 10.0;
  const Recording recording = propagate(run).recording;

  Observation seen;
  seen.schedule = run.model.schedule;
  const auto q = [&](const char* name) -> const std::vector<double>& {
    return recording.find(name)->values;
  };
  for (size_t i = 3; i < recording.rows(); ++i) {  // the first rows are of times before the start
    seen.time_s.push_back(recording.time_s[i]);
    seen.attitude.emplace_back(q("q_w")[i], q("q_x")[i], q("q_y")[i], q("q_z")[i]);
    seen.attitude_rows.push_back(1.0);
    seen.gyro_rad_s.push_back(Vec3::Zero());
    seen.gyro_rows.push_back(Vec3::Zero());
  }
  PredictionOptions options;
  options.keep_residuals = true;
  options.propagation.tolerance = 1e-10;
  const Dynamics dynamics(run.model);
  const Prediction predicted = predict(dynamics, run.initial, seen, {}, options);
  double largest_rad = 0.0;
  for (const auto& off : predicted.off) {
    largest_rad = std::max(largest_rad, off.head<3>().cwiseAbs().maxCoeff());
  }
  EXPECT_LT(largest_rad, 1e-5);
  EXPECT_GT(largest_rad, 0.0);
}

// A zero misalignment of the gyro does not change the readings, but makes them depend on the
// motion, so that the effect of offsets is not known in advance. The sums must agree with those of
// the model without it.
TEST(Prediction, SlopesOfOffsetsAreThoseOfInstrumentsThatDependOnTheMotion) {
  AttitudeModel plain =
      with(with(bench_model(), "static_unbalance", "offset_m = [1e-5, 0, -1.5e-4]"), "gyro_bias",
           "bias_rad_s = [1e-3, -2e-3, 5e-4]");
  plain = with(plain, "camera_misalignment", "misalignment_rad = [2e-3, 0, -1e-3]");
  const AttitudeModel turned_gyro =
      with(plain, "gyro_misalignment", "misalignment_rad = [0, 0, 0]");
  AttitudeModel turning_lab = with(plain, "earth_rotation");
  turning_lab.environment.earth_rate_lab_rad_s = Vec3(0.0, 5e-5, 5e-5);
  EXPECT_TRUE(Dynamics(plain).offsets().has_value());
  EXPECT_FALSE(Dynamics(turned_gyro).offsets().has_value());
  EXPECT_FALSE(Dynamics(turning_lab).offsets().has_value());

  Observation seen;
  for (size_t i = 0; i < 100; ++i) {
    seen.time_s.push_back(0.2 * static_cast<double>(i));
    seen.attitude.push_back(turned(0.1, {0, 1, 0}));
    seen.attitude_rows.push_back(1.0);
    seen.gyro_rad_s.push_back(Vec3::Zero());
    seen.gyro_rows.push_back(Vec3::Ones());
  }
  seen.has_gyro = true;
  std::vector<Variable> variables;
  for (int k = 0; k < 6; ++k) variables.push_back({k, 0, -1});
  for (size_t d = 0; d < 3; ++d) {
    for (int k = 0; k < 3; ++k) variables.push_back(Variable::of(d, k));
  }
  const auto sums = [&](const AttitudeModel& model) {
    const Dynamics dynamics(model);
    return predict(dynamics, state_of(model, turned(0.1, {0, 1, 0}), {0.01, 0.02, 0.3}), seen,
                   variables, {})
        .sums;
  };
  const inference::NormalSums a = sums(plain), b = sums(turned_gyro);
  EXPECT_GT(a.matrix.diagonal().minCoeff(), 0.0);
  EXPECT_NEAR(a.chi2, b.chi2, 1e-10 * b.chi2);
  const Eigen::VectorXd scale = b.matrix.diagonal().cwiseSqrt();
  const Eigen::MatrixXd off = (a.matrix - b.matrix).cwiseQuotient(scale * scale.transpose());
  EXPECT_LT(off.cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((a.gradient - b.gradient).cwiseQuotient(scale).norm(), 1e-9 * std::sqrt(b.chi2));
}

}  // namespace
}  // namespace photorque
