// Errors that are larger, more often, than those of a normal distribution.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "attitude/observation/heavy_tails.h"
#include "tests/noise.h"

namespace photorque {
namespace {

constexpr double tail_interval_s = 0.1;
constexpr int tailed = 5;

// A gyro's z alone, with its residuals.
struct LeftRun {
  std::vector<Observation> seen;
  std::vector<Prediction> residuals;
};

LeftRun left_run(size_t count, const std::function<double(double)>& left_at_s) {
  Observation seen;
  Prediction residuals;
  for (size_t i = 0; i < count; ++i) {
    const double time_s = tail_interval_s * static_cast<double>(i), left = left_at_s(time_s);
    seen.time_s.push_back(time_s);
    seen.attitude.push_back(Quat::Identity());
    seen.attitude_rows.push_back(0.0);
    seen.gyro_rad_s.push_back(Vec3(0.0, 0.0, left));
    seen.gyro_rows.push_back(Vec3(0.0, 0.0, 1.0));
    WhiteRow off = WhiteRow::Constant(std::nan(""));
    off[tailed] = left;
    residuals.off.push_back(off);
  }
  return {{seen}, {residuals}};
}

HeavyTails tails_of(const LeftRun& run) {
  return heavy_tails(run.residuals, run.seen, {});
}

// A slow motion beside the noise, as of a torque that is not known yet.
double slow_motion(double time_s) {
  return 3.0 * std::sin(0.3 * time_s) + 0.05 * time_s;
}

template <class Distribution>
std::function<double(double)> noise_of(unsigned seed, Distribution distribution) {
  return [random = std::mt19937_64(seed), distribution](double) mutable {
    return distribution(random);
  };
}

std::function<double(double)> sum_of(const std::function<double(double)>& a,
                                     const std::function<double(double)>& b) {
  return [a, b](double t) mutable { return a(t) + b(t); };
}

TEST(HeavyTails, DegreesAndScaleOfStudentsTAreFoundBesideSlowMotion) {
  double pulls = 0.0;
  int count = 0;
  for (const double degrees : {2.0, 3.0, 5.0}) {
    for (unsigned seed = 1; seed <= 8; ++seed) {
      const auto noise = noise_of(seed, std::student_t_distribution<double>(degrees));
      const HeavyTails tails = tails_of(left_run(4000, sum_of(noise, slow_motion)));
      ASSERT_TRUE(tails[tailed].has_value()) << degrees << " " << seed;
      EXPECT_FALSE(tails[tailed - 1].has_value());
      // The curve carries some of its neighbours' errors into each deviation, which makes it
      // somewhat more normal.
      EXPECT_NEAR(tails[tailed]->scale, 1.0, 0.15) << degrees << " " << seed;
      EXPECT_NEAR(tails[tailed]->degrees, degrees, 0.35 * degrees) << seed;
      pulls += (tails[tailed]->degrees - degrees) / tails[tailed]->degrees_sigma;
      ++count;
    }
  }
  // The mean of the errors, in units of the stated ones.
  EXPECT_LT(std::abs(pulls / count), 1.5);
}

TEST(HeavyTails, NormalCorrelatedAndQuantisedNoiseHaveNone) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const auto white = noise_of(seed, std::normal_distribution<double>());
    EXPECT_FALSE(tails_of(left_run(4000, white))[tailed].has_value()) << seed;
    EXPECT_FALSE(tails_of(left_run(4000, sum_of(white, slow_motion)))[tailed].has_value()) << seed;
    const auto correlated = [white, last = 0.0](double t) mutable {
      return last = 0.8 * last + 0.6 * white(t);
    };
    EXPECT_FALSE(tails_of(left_run(4000, correlated))[tailed].has_value()) << seed;
    for (const double motion : {0.0, 1.0}) {
      const auto coarse = [white, motion](double t) mutable {
        return 2.0 * std::round(0.5 * (white(t) + motion * slow_motion(t)));
      };
      EXPECT_FALSE(tails_of(left_run(4000, coarse))[tailed].has_value()) << seed << " " << motion;
    }
  }
}

// A mode that rings down has many small and few large deflections, and is motion all the same.
TEST(HeavyTails, RingingIsNoNoise) {
  for (const double hertz : {0.9, 2.3, 3.7}) {
    const auto ring = [hertz](double t) {
      return 40.0 * std::exp(-t / 60.0) * std::sin(6.2832 * hertz * t);
    };
    const LeftRun run =
        left_run(4000, sum_of(noise_of(5, std::normal_distribution<double>()), ring));
    EXPECT_FALSE(tails_of(run)[tailed].has_value()) << hertz;
    std::vector<Observation> seen = run.seen;
    EXPECT_EQ(drop_bursts(run.residuals, {}, seen), 0) << hertz;
  }
}

// The error of a mean of robust readings is the Cramér-Rao bound √((ν + 3)/(ν + 1)/n) of the scale;
// that of raw ones is √(ν/(ν − 2)/n), for ν = 3 by 41 % more.
TEST(HeavyTails, TamedReadingsHaveTheBoundOfTheMeanAndTheirStatedLevel) {
  constexpr double degrees = 3.0;
  constexpr size_t count = 400;
  constexpr int draws = 600;
  HeavyTails tails;
  tails[tailed] = HeavyTail{degrees, 0.1, 1.0};
  std::mt19937_64 random(7);
  std::student_t_distribution<double> noise(degrees);
  double robust_square = 0.0, raw_square = 0.0, level = 0.0;
  for (int draw = 0; draw < draws; ++draw) {
    LeftRun run = left_run(count, [&](double) { return noise(random); });
    const auto mean_of = [&] {
      double sum = 0.0;
      for (const Vec3& gyro : run.seen[0].gyro_rad_s) sum += gyro[2];
      return sum / static_cast<double>(count);
    };
    raw_square += std::pow(mean_of(), 2) / draws;
    robustify(tails, run.residuals, run.seen);
    robust_square += std::pow(mean_of(), 2) / draws;
    for (size_t i = 0; i < count; ++i)
      run.residuals[0].off[i][tailed] = run.seen[0].gyro_rad_s[i][2];
    level += deviation_level(run.residuals, run.seen, tailed) / draws;
  }
  const double bound = (degrees + 3.0) / (degrees + 1.0) / count;
  // A mean square of n draws scatters by √(2/n) of itself, here 6 %. The curve through neighbours
  // is not known without error, which costs a little.
  EXPECT_NEAR(robust_square / bound, 1.0, 0.2);
  EXPECT_GT(raw_square / bound, 1.6);
  EXPECT_NEAR(level, std::sqrt((degrees + 3.0) / (degrees + 1.0)), 0.07);
}

TEST(HeavyTails, TamingMovesWithTheMotion) {
  HeavyTails tails;
  tails[tailed] = HeavyTail{3.0, 0.1, 1.0};
  const auto noise = [] { return noise_of(3, std::student_t_distribution<double>(3.0)); };
  const auto parabola = [](double t) { return 20.0 - 3.0 * t + 0.05 * t * t; };
  LeftRun alone = left_run(300, noise()), moved = left_run(300, sum_of(noise(), parabola));
  robustify(tails, alone.residuals, alone.seen);
  robustify(tails, moved.residuals, moved.seen);
  for (size_t i = 0; i < 300; ++i) {
    const double time_s = alone.seen[0].time_s[i];
    EXPECT_NEAR(moved.seen[0].gyro_rad_s[i][2] - parabola(time_s), alone.seen[0].gyro_rad_s[i][2],
                1e-9)
        << i;
  }
}

TEST(HeavyTails, AnAttitudeIsTurnedAboutItsLabAxisAlone) {
  Observation seen;
  Prediction residuals;
  Noise white(11, 1e-4);
  const Quat attitude(Eigen::AngleAxisd(1.1, Vec3(1.0, 2.0, -0.5).normalized()));
  constexpr size_t count = 60, wrong = 31;
  for (size_t i = 0; i < count; ++i) {
    Vec3 error(white(), white(), white());
    if (i == wrong) error.x() = 0.01;
    seen.time_s.push_back(tail_interval_s * static_cast<double>(i));
    seen.attitude.push_back(Quat(Eigen::AngleAxisd(error.norm(), error.normalized())) * attitude);
    seen.attitude_rows.push_back(1.0);
    seen.gyro_rad_s.push_back(Vec3::Zero());
    seen.gyro_rows.push_back(Vec3::Zero());
    WhiteRow off = WhiteRow::Constant(std::nan(""));
    off.head<3>() = error;
    residuals.off.push_back(off);
  }
  HeavyTails tails;
  tails[0] = HeavyTail{3.0, 0.1, 1e-4};
  std::vector<Observation> runs = {seen};
  robustify(tails, {residuals}, runs);
  const Vec3 left = turn_vector(runs[0].attitude[wrong] * attitude.conjugate());
  // An error of a hundred scales is as good as none.
  EXPECT_LT(std::abs(left.x()), 4e-4);
  EXPECT_NEAR(left.y(), residuals.off[wrong][1], 2e-6);
  EXPECT_NEAR(left.z(), residuals.off[wrong][2], 2e-6);
}

TEST(Bursts, AreDroppedAndNothingElse) {
  Noise white(13);
  LeftRun run = left_run(4000, [&](double t) {
    const bool in_burst = (t >= 100.0 && t < 102.0) || (t >= 250.0 && t < 251.2);
    return (in_burst ? 15.0 : 1.0) * white() + slow_motion(t);
  });
  const int64_t dropped = drop_bursts(run.residuals, {}, run.seen);
  EXPECT_GE(dropped, 28);
  EXPECT_LE(dropped, 32 + 4 * 7);
  int64_t outside = 0;
  for (size_t i = 0; i < 4000; ++i) {
    const double t = run.seen[0].time_s[i];
    const bool near_burst = (t > 99.0 && t < 103.0) || (t > 249.0 && t < 252.2);
    if (run.seen[0].gyro_rows[i][2] == 0.0 && !near_burst) ++outside;
  }
  EXPECT_EQ(outside, 0);
  for (unsigned seed = 1; seed <= 10; ++seed) {
    LeftRun heavy = left_run(4000, noise_of(seed, std::student_t_distribution<double>(3.0)));
    EXPECT_LE(drop_bursts(heavy.residuals, {}, heavy.seen), 14) << seed;
  }
}

}  // namespace
}  // namespace photorque
