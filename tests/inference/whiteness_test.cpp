// Noise, outliers and paired differences, from numbers whose statistics are known.
#include "inference/whiteness.h"
#include "tests/noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

namespace photorque::inference {
namespace {

std::vector<double> white(uint64_t seed, size_t count, double size = 1.0) {
  Noise normal(seed, size);
  std::vector<double> r(count);
  for (double& x : r) x = normal();
  return r;
}

TEST(Whiteness, ShowsSlowMotion) {
  std::vector<double> r = white(1, 4000, 2.0);
  for (size_t i = 0; i < r.size(); ++i) r[i] += 50.0 * std::sin(0.002 * static_cast<double>(i));
  EXPECT_GT(whiteness({{white(2, 4000), r}}, {}).excess_sigma, 100.0);
}

// The excess of white noise has mean 0 and variance 1: means of neighbours are standard normals
// over √neighbours.
TEST(Whiteness, ExcessOfWhiteNoiseIsAStandardNormal) {
  constexpr int seeds = 400;
  double sum = 0.0, squares = 0.0;
  for (uint64_t seed = 0; seed < seeds; ++seed) {
    const double e = whiteness({{white(seed, 2000)}}, {}).excess_sigma;
    sum += e;
    squares += e * e;
  }
  EXPECT_NEAR(sum / seeds, 0.0, 4.0 / std::sqrt(seeds));
  EXPECT_NEAR(squares / seeds, 1.0, 4.0 * std::sqrt(2.5 / seeds));
}

// An oscillation at half the sampling rate cancels in means of neighbours: χ² per reading is
// 1 + 1.5², above 1.15 by 2.1 of √(2/n).
TEST(Whiteness, SizeShowsWhatIsAsFastAsTheReadings) {
  constexpr size_t count = 2000;
  std::vector<double> r = white(3, count);
  EXPECT_LT(size_excess_sigma({{r}}, 1.15), 0.0);
  for (size_t i = 0; i < count; ++i) r[i] += i % 2 == 0 ? 1.5 : -1.5;
  EXPECT_LT(whiteness({{r}}, {}).excess_sigma, 4.0);
  const double expected = 2.1 / std::sqrt(2.0 / count);
  // Standard error of a non-central χ²: √((2 + 4 · 1.5²)/n) over √(2/n).
  EXPECT_NEAR(size_excess_sigma({{r}}, 1.15), expected, 4.0 * std::sqrt(5.5));
}

TEST(Whiteness, OutliersDifferFromLocalPredictions) {
  std::vector<double> r = white(5, 500);
  // A residual that runs away steadily is none, however large.
  for (size_t i = 0; i < r.size(); ++i) r[i] += 3.0 * static_cast<double>(i);
  EXPECT_TRUE(outliers(r, {}).empty());
  // A neighbour is off by half of the outlier, which is no outlier here.
  for (size_t i = 0; i < r.size(); ++i) r[i] = 3.0 * static_cast<double>(i);
  for (const size_t i : {0u, 100u}) r[i] += 15.0;
  r[499] -= 15.0;
  EXPECT_EQ(outliers(r, {}), (std::vector<size_t>{0, 100, 499}));
  Thresholds::Noise lax;
  lax.outlier_sigma = 100.0;
  EXPECT_TRUE(outliers(r, lax).empty());
  // A prediction that is elsewhere turns by far more than the noise from one reading to the next:
  // motion, and not outliers; what stands out of that is one.
  for (size_t i = 0; i < r.size(); ++i) r[i] = 1e4 * std::sin(1.1 * static_cast<double>(i));
  EXPECT_TRUE(outliers(r, {}).empty());
  r[200] += 3e4;
  EXPECT_EQ(outliers(r, {}), (std::vector<size_t>{200}));
}

// The numbers 1 to 5 have Student's t = 3/√(2.5/5) with four degrees of freedom. Its two-sided
// probability is 0.01324, that of a normal number of 2.477 (tables of both distributions).
TEST(MeanSigma, IsThatOfANormalNumber) {
  EXPECT_NEAR(mean_sigma({1.0, 2.0, 3.0, 4.0, 5.0}), 2.477, 0.03);
  EXPECT_NEAR(mean_sigma({-1.0, -2.0, -3.0, -4.0, -5.0}), -2.477, 0.03);
  EXPECT_EQ(mean_sigma({1.0, 2.0}), 0.0);
  EXPECT_EQ(mean_sigma({1.0, -1.0, 2.0, -2.0}), 0.0);
}

// For noise it is normal: its mean square is 1, with a standard deviation of √(2/n) for n draws.
TEST(MeanSigma, OfNoiseIsNormal) {
  Noise normal(3);
  constexpr int draws = 4000;
  double squares = 0.0;
  for (int i = 0; i < draws; ++i) {
    std::vector<double> x(16);
    for (double& value : x) value = normal();
    squares += std::pow(mean_sigma(x), 2);
  }
  EXPECT_NEAR(squares / draws, 1.0, 5.0 * std::sqrt(2.0 / draws) + 0.02);
}

TEST(MeanSigma, NoSingleOneDecides) {
  std::vector<double> x(16, 1.0);
  x[3] = -1e300;
  EXPECT_GT(mean_sigma(x), 2.0);
  x[3] = -std::numeric_limits<double>::infinity();
  EXPECT_GT(mean_sigma(x), 2.0);
}

double probability_above(double deviate) {
  return 0.5 * std::erfc(deviate / std::sqrt(2.0));
}

std::vector<double> counted_to(size_t n) {
  std::vector<double> x(n);
  std::iota(x.begin(), x.end(), 1.0);
  return x;
}

// By hand: sizes 1, 2, 2, 4 have the ranks 1, 2.5, 2.5, 4; above zero are 1, 2 and 4, 7.5 in all,
// and below zero 2.5. Of the 16 choices of signs four have at most that: none, 1, and either 2.5.
TEST(SignedRanks, AreThoseByHand) {
  EXPECT_NEAR(probability_above(signed_rank_sigma({1.0, -2.0, 2.0, 0.0, 4.0})), 4.0 / 16.0, 1e-12);
  EXPECT_NEAR(probability_above(-signed_rank_sigma({-1.0, 2.0, -2.0, -4.0})), 4.0 / 16.0, 1e-12);
  EXPECT_EQ(signed_rank_sigma({}), 0.0);
  EXPECT_EQ(signed_rank_sigma({0.0, NAN}), 0.0);
  EXPECT_NEAR(signed_rank_sigma({1.0, -1.0}), 0.0, 1e-12);
}

// One that is as wild as can be counts for one. With the ranks 1 to 30, sums of at most 30 have as
// many choices as there are partitions of 0 to 30 into distinct parts, 2035 (OEIS A000009, summed).
TEST(SignedRanks, AreNotMovedByOne) {
  std::vector<double> x = counted_to(30);
  EXPECT_NEAR(std::ldexp(probability_above(signed_rank_sigma(x)), 30), 1.0, 1e-6);
  x.back() = -1e300;
  EXPECT_NEAR(std::ldexp(probability_above(signed_rank_sigma(x)), 30), 2035.0, 1e-3);
}

// Critical values for n = 16, one-sided 1 % (23 below zero: 0.0091; F. Wilcoxon, S. K. Katti and
// R. A. Wilcox, Selected Tables in Mathematical Statistics 1 (1970) 171).
TEST(SignedRanks, AreThoseOfTheTables) {
  std::vector<double> x = counted_to(16);
  x[15] = -16.0;
  x[6] = -7.0;
  EXPECT_NEAR(probability_above(signed_rank_sigma(x)), 0.0091, 5e-5);
}

// Beyond 50 the normal approximation: n = 60, all above zero, 915 over √18452.5.
TEST(SignedRanks, AreNormalWhereManyAre) {
  EXPECT_NEAR(signed_rank_sigma(counted_to(60)), 915.0 / std::sqrt(18452.5), 1e-12);
}

}  // namespace
}  // namespace photorque::inference
