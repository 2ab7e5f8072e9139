// The effect of a swinging appendage on a platform with one axis, against the textbook step
// response of a damped oscillator.
#include "diagnosis/attitude/effects/scan.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/constants.h"

namespace photorque {
namespace {

constexpr double frequency_Hz = 1.3, damping = 0.08, appendage_kg_m2 = 2e-4, interval_s = 0.05;
constexpr double from_s = 5.0, until_s = 9.0, acceleration_rad_s2 = 3e-3;
const Vec3 inertia_kg_m2(0.11, 0.12, 0.19);

// Angle and rate of an oscillator at rest until a push of 1 rad/s² begins at time 0.
std::array<double, 2> step_response(double t_s) {
  if (t_s <= 0.0) return {0.0, 0.0};
  const double w = 2.0 * pi * frequency_Hz, root = std::sqrt(1.0 - damping * damping);
  const double shrunk = std::exp(-damping * w * t_s), phase = w * root * t_s;
  return {(1.0 - shrunk * (std::cos(phase) + damping / root * std::sin(phase))) / (w * w),
          shrunk * std::sin(phase) / (w * root)};
}

// Turns faster and faster about z from 5 s to 9 s, with an appendage about z that the model does
// not know. `slow_arcsec` adds a residual that nothing swinging explains.
struct PushedTurn {
  Observation seen;
  Prediction propagated;

  explicit PushedTurn(double slow_arcsec) {
    for (int i = 0; i < 800; ++i) {
      const double t = interval_s * i;
      seen.time_s.push_back(t);
      seen.attitude_rows.push_back(i % 2);  // a camera of half the rate
      seen.gyro_rows.push_back(Vec3::Ones());
      const double pushed = std::max(0.0, t - from_s), let_go = std::max(0.0, t - until_s);
      PlatformState state;
      state.rate_body_rad_s = {0.0, 0.0, acceleration_rad_s2 * (pushed - let_go)};
      const double turn = 0.5 * acceleration_rad_s2 * (pushed * pushed - let_go * let_go);
      state.lab_from_body = Eigen::AngleAxisd(turn, Vec3::UnitZ());
      propagated.states.push_back(state);
      const auto begin = step_response(t - from_s), end = step_response(t - until_s);
      const double fraction = appendage_kg_m2 / inertia_kg_m2.z() * acceleration_rad_s2;
      WhiteRow white = WhiteRow::Zero();
      white[2] =
          (fraction * (begin[0] - end[0]) + slow_arcsec * arcsecond_rad * std::sin(0.1 * t)) /
          seen.noise.of(2).level;
      white[5] = fraction * (begin[1] - end[1]) / seen.noise.of(5).level;
      if (i % 2 == 0) white.head<3>().setConstant(NAN);
      propagated.residual.push_back(white);
    }
  }

  Score score(double at_Hz) const {
    return score_of_ringing({{seen, propagated}}, inertia_kg_m2.asDiagonal(),
                            {Vec3::UnitX(), Vec3::UnitZ()}, at_Hz, damping);
  }
};

TEST(Ringing, FindsTheAppendageOfASinglePush) {
  const Score score = PushedTurn(0.0).score(frequency_Hz);
  ASSERT_EQ(score.estimate.size(), 2);
  EXPECT_NEAR(score.estimate[1], appendage_kg_m2, 1e-6 * appendage_kg_m2);
  // Nothing turns about x: no appendage there could show.
  EXPECT_EQ(score.estimate[0], 0.0);
}

TEST(Ringing, GainsMostAtTheRightFrequency) {
  const PushedTurn scene(0.0);
  const double right = scene.score(frequency_Hz).gain;
  for (const double off : {0.7, 0.85, 1.2, 1.4}) {
    EXPECT_LT(scene.score(off * frequency_Hz).gain, 0.5 * right) << off;
  }
}

// A slow residual, a hundred times as large as the ringing of about 0.1", is not taken for it.
TEST(Ringing, IgnoresSlowMotion) {
  const double without = PushedTurn(0.0).score(frequency_Hz).estimate[1];
  EXPECT_NEAR(PushedTurn(10.0).score(frequency_Hz).estimate[1], without, 0.02 * without);
}

}  // namespace
}  // namespace photorque
