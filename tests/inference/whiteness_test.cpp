// Noise and outliers, from residuals whose statistics are known.
#include "inference/whiteness.h"
#include "tests/noise.h"

#include <gtest/gtest.h>

#include <cmath>

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

}  // namespace
}  // namespace photorque::inference
