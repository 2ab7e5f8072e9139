// What instruments should have read, from the model, against what `propagate` records.
#include "attitude/estimation/prediction.h"

#include <gtest/gtest.h>

#include "attitude/propagation/run.h"
#include "tests/attitude/disturbance_bench.h"

namespace photorque {
namespace {

// A pendulum of 0.3 rad/s seen 0.2 s late. The recorder asks for the attitude at the earlier
// instant; the prediction continues the motion backwards from the present with its acceleration,
// which leaves a sixth of the third derivative times 0.2³: 2e-6 rad. The rate alone would leave
// 2e-4 rad, five standard deviations of a camera.
TEST(Prediction, OfALateCameraIsWhatWasSeenThen) {
  PropagationRun run;
  run.model =
      with(with(bench_model(), "static_unbalance", {{"offset_m", numbers({0, 0, -1.5e-4})}}),
           "attitude_latency", {{"latency_s", node(0.2)}});
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
  for (size_t i = 3; i < recording.rows(); ++i) {  // before 0.2 s nothing was seen
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

}  // namespace
}  // namespace photorque
