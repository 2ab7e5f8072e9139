#include "core/numerics/lanes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "core/constants.h"
#include "core/numerics/collocation_points.h"
#include "core/numerics/dual.h"
#include "core/numerics/random.h"
#include "core/numerics/vector_math.h"

namespace photorque {
namespace {

double units_in_last_place(double a, double b) {
  return std::abs(a - b) / (std::nextafter(std::abs(b), HUGE_VAL) - std::abs(b));
}

// The C library is the reference: a different algorithm, right to one unit in the last place.
TEST(Lanes, SineAndCosineAgreeWithTheLibrary) {
  std::mt19937_64 engine(1);
  for (const double size : {1e-8, 1.0, 30.0, 1e4, 2e7, 1e12}) {
    std::uniform_real_distribution<double> uniform(-size, size);
    for (int i = 0; i < 2000; ++i) {
      Lanes x;
      for (int k = 0; k < Lanes::count; ++k) x.set(k, uniform(engine));
      const Lanes s = sin(x), c = cos(x);
      for (int k = 0; k < Lanes::count; ++k) {
        EXPECT_LE(units_in_last_place(s[k], std::sin(x[k])), 3.0) << x[k];
        EXPECT_LE(units_in_last_place(c[k], std::cos(x[k])), 3.0) << x[k];
      }
    }
  }
  EXPECT_EQ(sin(Lanes(0.0))[5], 0.0);
  EXPECT_TRUE(std::isnan(sin(Lanes(NAN))[0]));
}

TEST(Lanes, ArctangentAgreesWithTheLibrary) {
  std::mt19937_64 engine(2);
  std::uniform_real_distribution<double> exponent(-12.0, 12.0), sign(-1.0, 1.0);
  const auto any = [&] { return std::copysign(std::pow(10.0, exponent(engine)), sign(engine)); };
  for (int i = 0; i < 20000; ++i) {
    Lanes x, y;
    for (int k = 0; k < Lanes::count; ++k) {
      x.set(k, any());
      y.set(k, i % 2 == 0 ? any() : x[k] * sign(engine) * 3.0);
    }
    const Lanes angle = atan2(y, x);
    for (int k = 0; k < Lanes::count; ++k) {
      EXPECT_LE(units_in_last_place(angle[k], std::atan2(y[k], x[k])), 3.0) << y[k] << " " << x[k];
    }
  }
  for (const double x : {-2.0, 0.0, 2.0}) {
    for (const double y : {-2.0, 0.0, 2.0}) EXPECT_EQ(atan2(Lanes(y), x)[3], std::atan2(y, x));
  }
  EXPECT_TRUE(std::isnan(atan2(Lanes(NAN), 1.0)[0]));
  EXPECT_TRUE(std::isnan(atan2(Lanes(1.0), NAN)[0]));
}

TEST(Lanes, SelectionsWorkLaneByLane) {
  Lanes x;
  for (int k = 0; k < Lanes::count; ++k) x.set(k, k - 3.5);
  const Lanes chosen = where_at_least(x, 0.5, 1.0, -x);
  for (int k = 0; k < Lanes::count; ++k) EXPECT_EQ(chosen[k], x[k] >= 0.5 ? 1.0 : -x[k]);
  EXPECT_EQ(largest(larger_magnitude(x, 0.25)), 3.5);
  EXPECT_EQ(sum(x), 0.0);
}

// Each function of DualLanes: value as the library's, derivative as the difference quotient.
TEST(DualLanes, DerivativesAreThoseOfTheFunctions) {
  using Unary = std::function<DualLanes(const DualLanes&)>;
  const std::vector<std::pair<const char*, Unary>> functions = {
      {"sqrt", [](const DualLanes& x) { return sqrt(x); }},
      {"sin", [](const DualLanes& x) { return sin(x); }},
      {"cos", [](const DualLanes& x) { return cos(x); }},
      {"exp", [](const DualLanes& x) { return exp(x); }},
      {"log", [](const DualLanes& x) { return log(x); }},
      {"pow 0.5", [](const DualLanes& x) { return pow(x, 0.5); }},
      {"pow 1.5", [](const DualLanes& x) { return pow(x, 1.5); }},
      {"pow -2.2", [](const DualLanes& x) { return pow(x, -2.2); }},
      {"atan2 y", [](const DualLanes& x) { return atan2(x, DualLanes(-0.7)); }},
      {"atan2 x", [](const DualLanes& x) { return atan2(DualLanes(0.3), x); }},
      {"quotient", [](const DualLanes& x) { return (1.0 + x * x) / (x - 5.0); }},
      {"compound",
       [](const DualLanes& x) {
         DualLanes y = x;
         y *= x;
         y += sin(x);
         y /= x;
         y -= 2.0;
         return -y;
       }},
      {"where", [](const DualLanes& x) { return where_at_least(x, 1.0, x * x, 3.0 * x); }},
      {"from_values",
       [](const DualLanes& x) {
         return from_values(x, [](double a) { return std::array{a * a * a, 3 * a * a}; });
       }},
  };
  for (const auto& [name, f] : functions) {
    for (const double at : {0.4, 1.3, 2.9}) {
      DualLanes x(at);
      x.seed(3);
      const DualLanes y = f(x);
      const double h = 1e-6;
      const double slope =
          (f(DualLanes(at + h)).value[2] - f(DualLanes(at - h)).value[2]) / (2 * h);
      EXPECT_NEAR(y.partials()[3][2], slope, 1e-8 * (1 + std::abs(slope))) << name << " at " << at;
      EXPECT_EQ(y.partials()[0][2], 0.0) << name;
    }
  }
}

TEST(DualLanes, LengthIsSafeAtRest) {
  Vec3Of<DualLanes> v(DualLanes(0.0), DualLanes(0.0), DualLanes(0.0));
  for (int k = 0; k < 3; ++k) v[k].seed(k);
  const Vec3Of<DualLanes> drag = pow(length(v), 0.5) * v;
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(drag[k].value[0], 0.0);
    EXPECT_NEAR(drag[k].partials()[k][0], 0.0, 1e-70);
  }
}

// Gauss's rule of eight points integrates powers up to 15 exactly, and its collocation polynomial
// those up to 7 at any fraction.
TEST(Gauss, IntegratesPolynomialsExactly) {
  for (int power = 0; power <= 15; ++power) {
    double sum = 0.0;
    for (size_t i = 0; i < gauss::points; ++i) {
      sum += gauss::weights[i] * std::pow(gauss::nodes[i], power);
    }
    EXPECT_NEAR(sum, 1.0 / (power + 1), 3e-16) << power;
  }
  for (int power = 0; power <= 7; ++power) {
    Lanes increments;
    for (int i = 0; i < Lanes::count; ++i) {
      const auto k = static_cast<size_t>(i);
      increments.set(i, gauss::weights[k] * std::pow(gauss::nodes[k], power));
    }
    const Lanes stages = gauss::times(gauss::mu_columns, increments);
    const Lanes next = gauss::times(gauss::continuation_columns(0.5), increments);
    for (int i = 0; i < Lanes::count; ++i) {
      const auto k = static_cast<size_t>(i);
      EXPECT_NEAR(stages[i], std::pow(gauss::nodes[k], power + 1) / (power + 1), 2e-16);
      const double beyond = 1.0 + 0.5 * gauss::nodes[k];
      EXPECT_NEAR(next[i], 0.5 * gauss::weights[k] * std::pow(beyond, power), 1e-11);
    }
    for (const double fraction : {0.0, 0.3, 0.77, 1.0}) {
      EXPECT_NEAR(gauss::times(gauss::dense_weights(fraction), increments)[0],
                  std::pow(fraction, power + 1) / (power + 1), 3e-15);
    }
  }
}

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
