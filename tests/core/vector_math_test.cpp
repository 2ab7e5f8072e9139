#include "core/numerics/vector_math.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/constants.h"
#include "core/numerics/random.h"

namespace photorque {
namespace {

uint32_t word(uint64_t i) {
  return static_cast<uint32_t>(mix_bits(i));
}

const std::vector<uint32_t> corners = {0u,          1u,          0x3fffffffu,
                                       0x40000000u, 0x7fffffffu, 0x80000000u,
                                       0xbfffffffu, 0xc0000000u, 0xffffffffu};

std::vector<uint32_t> words() {
  std::vector<uint32_t> all = corners;
  for (uint64_t i = 0; i < 200000; ++i) all.push_back(word(i));
  return all;
}

TEST(VectorMath, FractionsAgreeWithSobolAndSumToOne) {
  for (const uint32_t bits : words()) {
    EXPECT_EQ(fraction_of(bits), sobol_fraction(bits));
    EXPECT_EQ(fraction_of(bits) + remainder_of(bits), 1.0);
    EXPECT_GT(remainder_of(bits), 0.0);
  }
}

TEST(VectorMath, CirclePointsMatchLibraryToFourEMinus16) {
  for (const uint32_t bits : words()) {
    const long double angle =
        2.0L * std::numbers::pi_v<long double> * static_cast<long double>(sobol_fraction(bits));
    const CirclePoint point = circle_point(bits);
    EXPECT_NEAR(point.cos, static_cast<double>(std::cos(angle)), 4e-16) << bits;
    EXPECT_NEAR(point.sin, static_cast<double>(std::sin(angle)), 4e-16) << bits;
  }
}

TEST(VectorMath, SinglePrecisionMatchesLibraryToTwoEMinus7) {
  for (const uint32_t bits : words()) {
    const double fraction = sobol_fraction(bits), angle = 2.0 * pi * fraction;
    EXPECT_NEAR(single_fraction(bits), fraction, 2e-7 * fraction + 0x1p-33) << bits;
    EXPECT_GT(single_fraction(bits), 0.0f);
    EXPECT_LE(single_fraction(bits), 1.0f);
    const SingleCirclePoint point = single_circle_point(bits);
    EXPECT_NEAR(point.cos, std::cos(angle), 2e-7) << bits;
    EXPECT_NEAR(point.sin, std::sin(angle), 2e-7) << bits;
  }
}

TEST(VectorMath, LogarithmMatchesLibraryToFiveEMinus16) {
  std::vector<double> arguments = {0x1p-33,       0x1p-1022,      1e300,
                                   0.5,           std::sqrt(0.5), 1.0 - 0x1p-53,
                                   1.0 + 0x1p-52, std::sqrt(2.0), 2.0};
  for (const uint32_t bits : words()) arguments.push_back(remainder_of(bits));
  for (const double x : arguments) {
    const auto exact = static_cast<double>(std::log(static_cast<long double>(x)));
    EXPECT_NEAR(log_positive(x), exact, 5e-16 * std::abs(exact)) << x;
  }
  EXPECT_EQ(log_positive(1.0), 0.0);
}

}  // namespace
}  // namespace photorque
