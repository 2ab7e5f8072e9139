// A gyro whose bias drifts, or is another after every switching on: no torque, and no other error
// of an instrument, is named for it.
#include <gtest/gtest.h>

#include "attitude/estimation/fit.h"
#include "attitude/observation/bias_history.h"
#include "attitude/observation/kinematics.h"
#include "attitude/propagation/run.h"
#include "tests/diagnosis/noisy_recording.h"
#include "tests/noise.h"

namespace photorque {
namespace {

using namespace rigid_body;
using BiasOverTime = std::function<Vec3(double)>;

constexpr size_t gyro_x_channel = 4;

NamedRecording with_bias(NamedRecording r, const BiasOverTime& bias_rad_s) {
  for (size_t row = 0; row < r.recording.time_s.size(); ++row) {
    const Vec3 bias = bias_rad_s(r.recording.time_s[row]);
    for (size_t k = 0; k < 3; ++k) {
      r.recording.channels[gyro_x_channel + k].values[row] += bias[static_cast<Eigen::Index>(k)];
    }
  }
  return r;
}

// The effect of an unknown torque on the motion must not matter.
Vec3 unknown_torque(const State& s) {
  return 4e-6 * Vec3(std::sin(0.11 * s.time_s), std::cos(0.07 * s.time_s), 0.3);
}

Vec3 slow_drift_rad_s(double t_s) {
  return 4e-4 *
         Vec3(std::sin(2.0 * pi * t_s / 600.0), std::cos(2.0 * pi * t_s / 700.0), 1e-3 * t_s);
}

std::vector<BiasHistory> histories_of(const std::vector<NamedRecording>& recordings) {
  std::vector<Observation> seen;
  for (const NamedRecording& r : recordings) seen.push_back(observe(r.recording, r.name));
  std::vector<const Observation*> pieces;
  for (const Observation& s : seen) pieces.push_back(&s);
  return bias_histories(pieces);
}

// Readings of a gyro of the assumed class: scale and misalignment of one per cent.
NamedRecording with_gyro_matrix(NamedRecording r, unsigned seed) {
  Noise normal(seed, 0.01);
  Mat3 matrix = Mat3::Identity();
  for (double& entry : matrix.reshaped()) entry += normal();
  for (size_t row = 0; row < r.recording.time_s.size(); ++row) {
    Vec3 rate;
    for (Eigen::Index k = 0; k < 3; ++k) {
      rate[k] = r.recording.channels[gyro_x_channel + static_cast<size_t>(k)].values[row];
    }
    rate = matrix * rate;
    for (Eigen::Index k = 0; k < 3; ++k) {
      r.recording.channels[gyro_x_channel + static_cast<size_t>(k)].values[row] = rate[k];
    }
  }
  return r;
}

// The drift at its knots, in units of the stated errors, which hold what a gyro of that class may
// add; a mutant that states a third of them fails.
TEST(BiasHistory, FollowsADriftBesideAnyTorque) {
  double square = 0.0;
  int count = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    Session session;
    session.duration_s = 360.0;
    const auto found = histories_of({with_bias(
        with_gyro_matrix(recorded_with(seed, session, unknown_torque), seed), slow_drift_rad_s)});
    ASSERT_EQ(found.size(), 1u) << seed;
    const BiasHistory& history = found.front();
    Vec3 mean = Vec3::Zero();
    for (const double t_s : history.time_s) mean += slow_drift_rad_s(t_s);
    mean /= static_cast<double>(history.time_s.size());
    for (size_t i = 0; i < history.time_s.size(); ++i) {
      const Vec3 off = history.bias_rad_s[i] - (slow_drift_rad_s(history.time_s[i]) - mean);
      const Vec3 pull = off.cwiseQuotient(history.sigma_rad_s[i]);
      square += pull.squaredNorm();
      count += 3;
    }
  }
  // One, had every gyro the errors assumed in all respects. Lines between knots a minute apart
  // leave 4e-4 (2π 60/600)²/8 = 2e-5 rad/s of the curves besides.
  EXPECT_LT(std::sqrt(square / count), 1.5);
  EXPECT_GT(std::sqrt(square / count), 0.4);
}

// Nor does loud or correlated noise count as a drift, nor a scale of each axis of the gyro.
TEST(BiasHistory, IsSilentWhereNothingDrifts) {
  int found = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    Session session;
    session.duration_s = 360.0;
    if (seed % 4 == 1) session.gyro.level = 3.0;
    if (seed % 4 == 2) session.gyro.time_s = 2.0;
    if (seed % 4 == 3) session.camera.time_s = 3.0;
    NamedRecording r = with_bias(recorded_with(seed, session, unknown_torque),
                                 [](double) { return Vec3(1e-3, -2e-3, 5e-4); });
    for (size_t k = 0; k < 3; ++k) {
      for (double& rate : r.recording.channels[gyro_x_channel + k].values) {
        rate *= 1.0 + 0.004 * (static_cast<double>(k) - 1.0);
      }
    }
    found += histories_of({r}).empty() ? 0 : 1;
  }
  EXPECT_EQ(found, 0);
}

// If a body turns half a radian from row to row, the motion between the rows is unknown. A
// diagnosis that ignores this finds a drift.
Vec3 as_if_lopsided(const State& s) {
  const Mat3 own = inertia_kg_m2(), lopsided = Vec3(0.136, 0.158, 0.197).asDiagonal();
  const Vec3& w = s.rate_rad_s;
  const Vec3 turning = -(lopsided.inverse() * w.cross(lopsided * w));
  return own * turning + w.cross(own * w);
}

// A gyro that reads a sixth too little while the body slows down: no drift of its bias.
TEST(BiasHistory, IsSilentWhereAScaleIsFarOff) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    Session session;
    session.duration_s = 360.0;
    NamedRecording r = recorded_with(seed, session, unknown_torque);
    for (size_t k = 0; k < 3; ++k) {
      for (double& rate : r.recording.channels[gyro_x_channel + k].values) rate *= 0.84;
    }
    EXPECT_TRUE(histories_of({r}).empty()) << seed;
  }
}

// A pendulum of a quarter of a minute, five readings in a block: a parabola over h = 1.25 s to
// either side of a swing A sin ωt (A = 0.3 rad, ω = 0.35 rad/s) misses its rate by A ω³ h²/10, so
// that the curve is off by half a milliradian, beside 2e-4 rad of noise. Not by a part of the
// swing.
TEST(KinematicRun, FollowsASwingInBlocksOfReadings) {
  const auto bottom_heavy = [](const State& s) -> Vec3 {
    return 2e-2 * (s.lab_from_body.conjugate() * Vec3::UnitZ()).cross(Vec3::UnitZ());
  };
  Session session;
  session.interval_s = 0.05;
  session.rate_rad_s = Vec3(0.1, -0.06, 0.17);
  const NamedRecording r = recorded_with(1, session, bottom_heavy);
  const KinematicRun run = kinematic_run(observe(r.recording, r.name).averaged(1200), nullptr);
  for (const KinematicSeries& series : run.axis) {
    double square = 0.0;
    for (const double angle : series.angle_rad) square += angle * angle;
    EXPECT_LT(std::sqrt(square / static_cast<double>(series.blocks())), 1e-3);
  }
}

TEST(BiasHistory, IsSilentWhereABodyTumbles) {
  for (const double faster : {1.0, 2.0, 3.0, 7.0}) {
    Session session;
    session.rate_rad_s = faster * Vec3(0.25, -0.21, 0.6);
    const NamedRecording r = recorded_with(3, session, as_if_lopsided);
    EXPECT_TRUE(histories_of({r}).empty()) << faster;
  }
}

NominalModel model_with_bias() {
  NominalModel nominal = nominal_model();
  const DisturbanceContext context{nominal.model.platform, nominal.model.environment};
  Disturbance bias = make_disturbance_of("gyro_bias", {{"bias_rad_s", {0, 0, 0}}}, context);
  for (Parameter& p : bias.parameters) p.sigma = 1e-3;
  bias.per_recording = true;
  nominal.model.disturbances.push_back(bias);
  return nominal;
}

// Three standard deviations of the stated value lie between the two.
TEST(GyroBias, IsAnotherAfterEverySwitchingOnWithoutANameForIt) {
  Session session;
  session.duration_s = 250.0;
  const NamedRecording first = with_bias(recorded_with(1, session, nothing_more),
                                         [](double) { return Vec3(1e-3, 0.0, -1e-3); }),
                       second = with_bias(recorded_with(2, session, nothing_more),
                                          [](double) { return Vec3(-1e-3, 1e-3, 2e-3); });
  const Diagnosis d = diagnose(model_with_bias(), {first}, {second});
  EXPECT_EQ(d.verdict, Verdict::consistent) << d.sentence;
  EXPECT_LT(d.holdout->chi2_per_sample_after, 1.1);
}

TEST(GyroBias, ThatDriftsIsAFindingOfTheInstrument) {
  Session session;
  session.duration_s = 250.0;
  const NamedRecording first = with_bias(recorded_with(1, session, nothing_more), slow_drift_rad_s),
                       second =
                           with_bias(recorded_with(2, session, nothing_more), slow_drift_rad_s);
  const Diagnosis d = diagnose(model_with_bias(), {first}, {second});
  EXPECT_EQ(d.verdict, Verdict::consistent) << d.sentence;
  const auto is_drift = [](const InstrumentFinding& f) { return f.what == "bias_drift_rad_s"; };
  EXPECT_EQ(std::count_if(d.instruments.begin(), d.instruments.end(), is_drift), 6);
}

}  // namespace
}  // namespace photorque
