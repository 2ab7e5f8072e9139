// Averages of readings against the motion itself: a symmetric top free of torque, whose motion
// every textbook has (Landau and Lifshitz, Mechanics, section 33).
#include "attitude/observation/observation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "attitude/estimation/conventions.h"
#include "core/constants.h"

namespace photorque {
namespace {

// Spins at 1 rad/s about its axis and wobbles by a tenth of it; I3 = 1.6 I1.
struct Top {
  static constexpr double spin_rad_s = 1.0, wobble_rad_s = 0.1, ratio = 1.6;

  // The rates turn in body axes at Ω = (I3/I1 − 1) ω3.
  static Vec3 rate_rad_s(double t_s) {
    const double phase = (ratio - 1.0) * spin_rad_s * t_s;
    return {wobble_rad_s * std::cos(phase), wobble_rad_s * std::sin(phase), spin_rad_s};
  }
  // Precession about the angular momentum at L/I1, then rotation about the own axis at −Ω.
  static Quat lab_from_body(double t_s) {
    const Vec3 momentum(wobble_rad_s, 0.0, ratio * spin_rad_s);  // over I1, at t = 0
    const Quat about_momentum(Eigen::AngleAxisd(momentum.norm() * t_s, momentum.normalized()));
    const Quat about_axis(Eigen::AngleAxisd(-(ratio - 1.0) * spin_rad_s * t_s, Vec3::UnitZ()));
    return about_momentum * about_axis;
  }
};

// 160 readings a second for 10 s, exact; the camera sees every `camera_every`-th row.
Observation seen_by(size_t camera_every, bool gyro) {
  constexpr double interval_s = 1.0 / 160.0;
  Observation seen;
  seen.has_gyro = gyro;
  seen.row_interval_s = interval_s;
  for (size_t i = 0; i < 1600; ++i) {
    const double t_s = interval_s * static_cast<double>(i);
    seen.time_s.push_back(t_s);
    const bool camera = i % camera_every == 0;
    seen.attitude.push_back(camera ? Top::lab_from_body(t_s) : Quat(NAN, NAN, NAN, NAN));
    seen.attitude_rows.push_back(camera ? 1.0 : 0.0);
    seen.gyro_rad_s.push_back(gyro ? Top::rate_rad_s(t_s) : Vec3::Constant(NAN));
    seen.gyro_rows.push_back(gyro ? Vec3::Ones() : Vec3::Zero());
  }
  return seen;
}

// Blocks of 0.1 s. The mean of positions over a turn of 0.1 rad lies inside the arc, by 8″; the
// mean time of every second row is half a row, 3 ms, before that of all.
TEST(Observation, BlocksStandWhereTheMotionIs) {
  constexpr double arcsec = arcsecond_rad;
  for (const size_t camera_every : {1u, 2u, 3u}) {
    for (const bool gyro : {true, false}) {
      const Observation blocks = seen_by(camera_every, gyro).averaged(100);
      ASSERT_NEAR(static_cast<double>(blocks.blocks()), 100.0, 2.0);
      for (size_t i = 0; i < blocks.blocks(); ++i) {
        const double t_s = blocks.time_s[i];
        const Quat off = blocks.attitude[i] * Top::lab_from_body(t_s).conjugate();
        // The curvature remains: of the wobble 0.06 rad/s² T²/24 = 5″ and more in blocks of odd
        // rows.
        EXPECT_LT(turn_vector(off).norm(), 7.0 * arcsec) << t_s;
        if (!gyro) continue;
        // And of the rate, ω″ T²/24 = 1.5e-5 rad/s.
        EXPECT_LT((blocks.gyro_rad_s[i] - Top::rate_rad_s(t_s)).norm(), 2.5e-5) << t_s;
      }
    }
  }
}

// A gyro in other units than its header says: that is found out later, and must not have bent the
// attitudes by then.
TEST(Observation, AGyroThatDisagreesMovesNoAttitude) {
  Observation seen = seen_by(1, true);
  for (Vec3& rate_rad_s : seen.gyro_rad_s) rate_rad_s /= degree_rad;
  const Observation blocks = seen.averaged(100);
  for (size_t i = 0; i < blocks.blocks(); ++i) {
    const Quat off = blocks.attitude[i] * Top::lab_from_body(blocks.time_s[i]).conjugate();
    EXPECT_LT(turn_vector(off).norm(), 7.0 * arcsecond_rad) << blocks.time_s[i];
  }
}

TEST(Observation, BlocksOfOneRowStayAsTheyAre) {
  const Observation seen = seen_by(2, true);
  const Observation same = seen.averaged(1599);
  ASSERT_EQ(same.blocks(), seen.blocks());
  for (size_t i = 0; i < seen.blocks(); ++i) {
    EXPECT_EQ(same.time_s[i], seen.time_s[i]);
    EXPECT_EQ(same.gyro_rad_s[i], seen.gyro_rad_s[i]);
    if (seen.attitude_rows[i] > 0.0) {
      EXPECT_LT(seen.attitude[i].angularDistance(same.attitude[i]), 1e-7);
    }
  }
}

// The rates of the top as a recording would have them that misnames their unit or their axes.
Observation rates_read_as(const Mat3& matrix) {
  Observation seen = seen_by(1, true);
  seen.sees_axis = {false, false, false};
  for (Vec3& rate : seen.gyro_rad_s) rate = matrix * rate;
  return seen;
}

// Angular frequency of the rates about the axis, divided by the spin: I3/I1 − 1 of a top.
double cone_per_spin(const Observation& seen) {
  const auto phase = [&](size_t i) {
    return std::atan2(seen.gyro_rad_s[i].y(), seen.gyro_rad_s[i].x());
  };
  return std::remainder(phase(160) - phase(0), 2.0 * pi) / (seen.time_s[160] - seen.time_s[0]) /
         seen.gyro_rad_s[0].z();
}

TEST(FreeRates, AreReadSoThatEulersEquationHolds) {
  const Mat3 inertia = Vec3(1.0, 1.0, Top::ratio).asDiagonal();
  Mat3 degrees = Mat3::Identity() / degree_rad, reversed = Vec3(1, 1, -1).asDiagonal(), exchanged;
  exchanged << 0, 1, 0, 1, 0, 0, 0, 0, 1;
  for (const Mat3& wrong : {degrees, reversed, exchanged, Mat3(degrees * reversed)}) {
    Observation seen = rates_read_as(wrong);
    EXPECT_GT(std::abs(cone_per_spin(seen) / (Top::ratio - 1.0) - 1.0), 0.5);
    EXPECT_NE(repair_free_rates({&seen, 1}, inertia), "");
    EXPECT_NEAR(cone_per_spin(seen), Top::ratio - 1.0, 1e-9);
  }
}

TEST(FreeRates, ThatAreRightOrUndeterminedAreUnchanged) {
  const Mat3 inertia = Vec3(1.0, 1.0, Top::ratio).asDiagonal();
  Observation right = rates_read_as(Mat3::Identity());
  EXPECT_EQ(repair_free_rates({&right, 1}, inertia), "");
  // Two axes reversed are the same motion seen from elsewhere.
  Observation turned = rates_read_as(Vec3(-1, -1, 1).asDiagonal());
  EXPECT_EQ(repair_free_rates({&turned, 1}, inertia), "");
  // The motion of a ball determines nothing. Other physics cannot be repaired by an axis.
  Observation mirrored = rates_read_as(Vec3(1, 1, -1).asDiagonal());
  EXPECT_EQ(repair_free_rates({&mirrored, 1}, Mat3::Identity()), "");
  Observation driven = right;
  for (size_t i = 0; i < driven.blocks(); ++i) {
    const double t_s = driven.time_s[i];
    driven.gyro_rad_s[i] = {std::sin(3.0 * t_s), std::sin(4.1 * t_s), std::cos(2.3 * t_s)};
  }
  EXPECT_EQ(repair_free_rates({&driven, 1}, inertia), "");
}

}  // namespace
}  // namespace photorque
