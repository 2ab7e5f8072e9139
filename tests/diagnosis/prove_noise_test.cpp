// The errors that `prove` adds to what it records, against the moments of their distributions.
#include <gtest/gtest.h>

#include <cmath>

#include "tools/proof/instruments.h"

namespace photorque {
namespace {

using injected::Errors;
using injected::RandomDraw;

constexpr double row_interval_s = 0.1;

std::vector<double> drawn(const InjectedNoise& noise, size_t count) {
  Errors errors(noise, row_interval_s);
  RandomDraw draw(7, 11);
  std::vector<double> all;
  while (all.size() < count) {
    for (const double e : errors.next(draw)) all.push_back(e);
  }
  return all;
}

// Of values `lag` readings apart on one channel; three channels take turns.
double product_at(const std::vector<double>& values, size_t lag) {
  double sum = 0.0;
  for (size_t i = 3 * lag; i < values.size(); ++i) sum += values[i] * values[i - 3 * lag];
  return sum / static_cast<double>(values.size() - 3 * lag);
}

TEST(ProveNoise, AsStatedIsWhiteAndOfUnitLevel) {
  const auto values = drawn({}, 60000);
  EXPECT_NEAR(product_at(values, 0), 1.0, 0.03);
  EXPECT_NEAR(product_at(values, 1), 0.0, 0.03);
}

// A process of first order: correlation exp(−t/τ) at the stated total level.
TEST(ProveNoise, CorrelationFallsWithItsTime) {
  const auto values = drawn({.time_s = 0.5}, 300000);
  EXPECT_NEAR(product_at(values, 0), 1.0, 0.04);
  EXPECT_NEAR(product_at(values, 5), std::exp(-1.0), 0.04);
  EXPECT_NEAR(product_at(values, 10), std::exp(-2.0), 0.04);
}

TEST(ProveNoise, ScaleMultipliesTheLevel) {
  EXPECT_NEAR(product_at(drawn({.scale = 1.7}, 60000), 0), 1.7 * 1.7, 0.1);
}

// Student's t with 5 degrees of freedom, scaled to unit variance: half of its values lie within
// 0.7267·√(3/5) (tables of the distribution), of normal ones within 0.6745.
TEST(ProveNoise, StudentHasHeavyTailsAtTheStatedLevel) {
  const auto values = drawn({.student_degrees = 5}, 300000);
  EXPECT_NEAR(product_at(values, 0), 1.0, 0.05);
  double within = 0.0, far = 0.0;
  for (const double v : values) {
    within += std::abs(v) < 0.7267 * std::sqrt(0.6) ? 1.0 : 0.0;
    far += std::abs(v) > 4.0 ? 1.0 : 0.0;
  }
  const auto n = static_cast<double>(values.size());
  EXPECT_NEAR(within / n, 0.5, 0.005);
  EXPECT_GT(far / n, 10.0 * 6.3e-5);  // of normal values, 6.3e-5 lie beyond 4 σ
}

TEST(ProveNoise, OutliersAreFiveTimesTheLevel) {
  // 0.95·1 + 0.05·25.
  EXPECT_NEAR(product_at(drawn({.outlier_share = 0.05}, 300000), 0), 2.2, 0.1);
}

TEST(ProveNoise, QuantisedReadingsAreMultiplesOfTheStep) {
  const Errors errors({.step_sigma = 2.0}, row_interval_s);
  EXPECT_DOUBLE_EQ(errors.rounded(3.9e-4, 1e-4), 4e-4);
  EXPECT_DOUBLE_EQ(errors.rounded(-2.9e-4, 1e-4), -2e-4);
  EXPECT_EQ(Errors({}, row_interval_s).rounded(1.23456e-4, 1e-4), 1.23456e-4);
}

}  // namespace
}  // namespace photorque
