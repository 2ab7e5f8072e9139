#include "inference/whiteness.h"
#include "tests/noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace photorque::inference {
namespace {

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

}  // namespace
}  // namespace photorque::inference
