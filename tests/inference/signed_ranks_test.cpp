#include "inference/whiteness.h"

#include <gtest/gtest.h>

#include <cmath>

namespace photorque::inference {
namespace {

// By hand: sizes 1, 2, 2, 4 have the ranks 1, 2.5, 2.5, 4; above zero are 1, 2 and 4, 7.5 in all.
TEST(SignedRanks, AreThoseByHand) {
  const double error = std::sqrt(4.0 * 5.0 * 9.0 / 24.0);
  EXPECT_DOUBLE_EQ(signed_rank_sigma({1.0, -2.0, 2.0, 0.0, 4.0}), (7.5 - 5.0) / error);
  EXPECT_DOUBLE_EQ(signed_rank_sigma({-1.0, 2.0, -2.0, -4.0}), (2.5 - 5.0) / error);
  EXPECT_EQ(signed_rank_sigma({}), 0.0);
  EXPECT_EQ(signed_rank_sigma({0.0, NAN}), 0.0);
}

// One that is as wild as can be counts for one.
TEST(SignedRanks, AreNotMovedByOne) {
  std::vector<double> x(30, 0.0);
  for (size_t i = 0; i < x.size(); ++i) x[i] = 1.0 + static_cast<double>(i);
  const double before = signed_rank_sigma(x);
  x.back() = -1e300;
  // n = 30: all above zero is 232.5 over √2363.75.
  EXPECT_NEAR(before, 232.5 / std::sqrt(2363.75), 1e-12);
  EXPECT_NEAR(signed_rank_sigma(x), (232.5 - 30.0) / std::sqrt(2363.75), 1e-12);
}

}  // namespace
}  // namespace photorque::inference
