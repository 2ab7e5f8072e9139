#include "inference/whiteness.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace photorque::inference {
namespace {

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
