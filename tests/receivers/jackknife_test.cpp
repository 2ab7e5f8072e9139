#include "raytrace/receiver.h"

#include <gtest/gtest.h>

namespace photorque {
namespace {

// One bin of 1, 2, 6 and another of 4, 4, 7 in three replicates.
const BinSums sums{2, 3, {1, 4, 2, 4, 6, 7}};

TEST(Jackknife, LinearFunctionsHaveTheOrdinaryError) {
  const Estimate left = jackknife(sums, [](std::span<const double> bins) { return bins[0]; });
  EXPECT_NEAR(left.value, 3.0, 1e-14);
  EXPECT_NEAR(left.standard_error, std::sqrt(7.0 / 3.0), 1e-14);
  const Estimate both =
      jackknife(sums, [](std::span<const double> bins) { return 2 * bins[0] - bins[1]; });
  const Estimate direct =
      sums.estimate([](std::span<const double> bins) { return 2 * bins[0] - bins[1]; });
  EXPECT_NEAR(both.value, direct.value, 1e-14);
  EXPECT_NEAR(both.standard_error, direct.standard_error, 1e-14);
}

TEST(Jackknife, SquaresLoseTheirBias) {
  // E[x̄²] = μ² + σ²/R: what remains after the correction is x̄² − s²/R = 9 − 7/3.
  const Estimate square =
      jackknife(sums, [](std::span<const double> bins) { return bins[0] * bins[0]; });
  EXPECT_NEAR(square.value, 9.0 - 7.0 / 3.0, 1e-13);
}

TEST(Jackknife, MeanBinsAverageReplicates) {
  const std::vector<double> mean = mean_bins(sums);
  EXPECT_DOUBLE_EQ(mean[0], 3.0);
  EXPECT_DOUBLE_EQ(mean[1], 5.0);
}

}  // namespace
}  // namespace photorque
