// Means over blocks of readings compared with the predictions of a model, for bodies that rotate
// far within a block. The readings have no noise and the model is exact, so the remaining error is
// that of predicting a mean from a few instants.
#include <gtest/gtest.h>

#include "attitude/observation/prediction.h"
#include "attitude/propagation/run.h"
#include "core/constants.h"
#include "tests/attitude/disturbance_bench.h"

namespace photorque {
namespace {

// A free body that tumbles at 3.6 rad/s, measured without noise.
struct Tumbling {
  PropagationRun run;
  Recording recording;

  explicit Tumbling(double rate_Hz, double duration_s = 20.0) {
    run.model = bench_model();
    run.model.platform.topology = Topology::free;
    run.sensors = {};
    run.sensors.camera.emplace();
    run.sensors.camera->noise_rad = Vec3::Zero();
    run.sensors.gyro.emplace();
    run.initial = state_of(run.model, Quat::Identity(), {2.0, 0.2, 3.0});
    run.duration_s = duration_s;
    run.output_rate_Hz = rate_Hz;
    recording = propagate(run).recording;
  }

  // Observation in blocks. Its noise is so small that an error of a milliarcsecond matters.
  Observation observed(size_t blocks) const {
    Observation seen = observe(recording, "tumbling", run.model.platform, blocks);
    seen.noise.set_levels(0, Vec3::Constant(1e-3 * arcsecond_rad));
    seen.noise.set_levels(3, Vec3::Constant(1e-8));
    return seen;
  }
};

struct Largest {
  double attitude_arcsec = 0.0, gyro_rad_s = 0.0;
  size_t attitudes = 0, rates = 0;  // numbers of compared values
};

Largest largest_of(const Tumbling& body, const Observation& seen, PlatformState start) {
  PredictionOptions options;
  options.keep_residuals = true;
  options.propagation.tolerance = 1e-12;
  start.time_s = seen.time_s.front();
  const Dynamics dynamics(body.run.model);
  Largest largest;
  for (const WhiteRow& off : predict(dynamics, start, seen, {}, options).off) {
    if (off.head<3>().allFinite()) {
      ++largest.attitudes;
      largest.attitude_arcsec =
          std::max(largest.attitude_arcsec, off.head<3>().cwiseAbs().maxCoeff() / arcsecond_rad);
    }
    if (off.segment<3>(3).allFinite()) {
      ++largest.rates;
      largest.gyro_rad_s = std::max(largest.gyro_rad_s, off.segment<3>(3).cwiseAbs().maxCoeff());
    }
  }
  return largest;
}

// Blocks of a tenth of a second, within which the body rotates by 0.36 rad. The reading at the
// middle of a block differs from the mean by up to 3e-3 rad/s and 300 arcsec.
TEST(BlockMeans, OfABodyThatTumblesArePredictedAsMeans) {
  const Tumbling body(160.0);
  const Observation seen = body.observed(200);
  ASSERT_NEAR(static_cast<double>(seen.blocks()), 200.0, 10.0);
  const Largest left = largest_of(body, seen, body.run.initial);
  EXPECT_LT(left.attitude_arcsec, 0.02);
  EXPECT_LT(left.gyro_rad_s, 3e-7);
  Observation as_readings = seen;
  as_readings.spread.clear();
  const Largest middle = largest_of(body, as_readings, body.run.initial);
  EXPECT_GT(middle.attitude_arcsec, 50.0);
  EXPECT_GT(middle.gyro_rad_s, 1e-3);
}

// With more noise, fewer instants per block are predicted. Two have a larger error than three, and
// one has a much larger error.
TEST(BlockMeans, AreLookedAtNoMoreOftenThanTheirNoiseIsWorth) {
  const Tumbling body(160.0);
  Observation seen = body.observed(200);
  seen.noise.set_levels(0, Vec3::Constant(2000.0 * arcsecond_rad));
  seen.noise.set_levels(3, Vec3::Constant(0.4));
  const Largest two = largest_of(body, seen, body.run.initial);
  EXPECT_LT(two.attitude_arcsec, 5.0);
  EXPECT_LT(two.gyro_rad_s, 1e-4);
  EXPECT_GT(two.attitude_arcsec, 0.2);  // fewer than three
  seen.noise.set_levels(0, Vec3::Constant(10.0));
  seen.noise.set_levels(3, Vec3::Constant(100.0));
  EXPECT_GT(largest_of(body, seen, body.run.initial).attitude_arcsec, 50.0);  // one
}

// A camera with an attitude at every fourth instant: within a block its attitudes span a shorter
// time than the gyro's rates.
TEST(BlockMeans, OfACameraSlowerThanTheGyro) {
  Tumbling body(160.0);
  for (Channel& channel : body.recording.channels) {
    for (size_t i = 0; channel.name.starts_with("q_") && i < channel.values.size(); ++i) {
      if (i % 4 != 0) channel.values[i] = NAN;
    }
  }
  const Largest left = largest_of(body, body.observed(200), body.run.initial);
  EXPECT_GT(left.attitudes, 150U);
  EXPECT_GT(left.rates, 150U);
  EXPECT_LT(left.attitude_arcsec, 1.0);
  EXPECT_LT(left.gyro_rad_s, 5e-5);
}

// The first block of a part is a mean over times before the motion of the part starts. Its value at
// the middle of the block is interpolated from its neighbours.
TEST(BlockMeans, FirstBlocksOfPartsAreReadings) {
  const Tumbling body(160.0);
  const Observation seen = body.observed(400), part = seen.part(100, 200);
  EXPECT_EQ(part.spread.front().readings_s, 0.0);
  EXPECT_GT(part.spread[1].readings_s, 0.0);
  const PlatformState then =
      propagated(body.run.model, body.run.initial, part.time_s.front(), 1e-13);
  const Vec3 turn = turn_vector(part.attitude.front() * then.lab_from_body.conjugate());
  EXPECT_LT(turn.norm() / arcsecond_rad, 2.0);
  EXPECT_LT((part.gyro_rad_s.front() - then.rate_body_rad_s).norm(), 2e-5);
  const Vec3 of_mean = turn_vector(seen.attitude[100] * then.lab_from_body.conjugate());
  EXPECT_GT(of_mean.norm() / arcsecond_rad, 20.0);
  EXPECT_GT((seen.gyro_rad_s[100] - then.rate_body_rad_s).norm(), 2e-4);
}

// Averages of averages are averages of the rows.
TEST(BlockMeans, OfMeansHoldTheSameMoments) {
  const Tumbling body(160.0);
  const Observation rows = body.observed(100000), twice = body.observed(800).averaged(200);
  ASSERT_TRUE(rows.spread.empty());
  const Largest left = largest_of(body, twice, body.run.initial);
  EXPECT_GT(left.attitudes, 150U);
  EXPECT_GT(left.rates, 150U);
  EXPECT_LT(left.attitude_arcsec, 1.0);
  EXPECT_LT(left.gyro_rad_s, 1e-5);
  EXPECT_LT(largest_of(body, rows, body.run.initial).attitude_arcsec, 1e-3);
}

}  // namespace
}  // namespace photorque
