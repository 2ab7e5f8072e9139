// Quadrature, roots and interpolation against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/numerics/adaptive_quadrature.h"
#include "core/numerics/interpolation.h"
#include "core/numerics/quadrature.h"
#include "core/numerics/root.h"

namespace photorque {
namespace {

TEST(Quadrature, ExactForTheDegreesThatItClaims) {
  const auto power = [](int degree) { return [degree](double x) { return std::pow(x, degree); }; };
  const auto exact = [](int degree) { return std::pow(2.0, degree + 1) / (degree + 1); };
  EXPECT_NEAR(integrate(gauss_8, power(15), 0.0, 2.0) / exact(15), 1.0, 1e-14);
  EXPECT_NEAR(integrate(lobatto_8, power(13), 0.0, 2.0) / exact(13), 1.0, 1e-14);
  EXPECT_GT(std::abs(integrate(gauss_8, power(16), 0.0, 2.0) / exact(16) - 1.0), 1e-10);
  EXPECT_GT(std::abs(integrate(lobatto_8, power(14), 0.0, 2.0) / exact(14) - 1.0), 1e-10);
}

// Over panels the error falls with the 16th power of their number: ∫₀^π e^x sin x dx = (e^π + 1)/2.
TEST(Quadrature, PanelsConvergeToRounding) {
  const auto f = [](double x) { return std::exp(x) * std::sin(x); };
  const double exact = 0.5 * (std::exp(std::numbers::pi) + 1.0);
  EXPECT_NEAR(integrate(gauss_8, f, 0.0, std::numbers::pi, 16) / exact, 1.0, 1e-15);
  EXPECT_GT(std::abs(integrate(
                         gauss_8, [&](double x) { return f(9 * x); }, 0.0, 1.0, 1) /
                         integrate(
                             gauss_8, [&](double x) { return f(9 * x); }, 0.0, 1.0, 16) -
                     1.0),
            1e-12);
}

// A step of height 1, whose halves never agree, and one below the smallest normal number.
TEST(AdaptiveQuadrature, EndsWhereNumbersLoseTheirDigits) {
  for (const double height : {1.0, 1e-310}) {
    int calls = 0;
    const auto step = [&](double x) {
      ++calls;
      return x < 1.0 / 3.0 ? 0.0 : height;
    };
    const double value = integrate_adaptively(step, 0.0, 1.0, 0.0).value;
    EXPECT_NEAR(value / height, 2.0 / 3.0, height == 1.0 ? 1e-7 : 0.1);
    EXPECT_EQ(calls < 10, height < 1.0) << calls;
  }
}

TEST(GaussLegendre, RulesIntegratePowersUpToTheirDegree) {
  for (const size_t n : {1u, 2u, 7u, 33u, 64u}) {
    for (const size_t power : {size_t{0}, n, 2 * n - 1, 2 * n - 2}) {
      double sum = 0.0;
      for (const auto& [x, weight] : gauss_legendre(n))
        sum += weight * std::pow(x, static_cast<double>(power));
      const double exact = power % 2 == 1 ? 0.0 : 2.0 / static_cast<double>(power + 1);
      EXPECT_NEAR(sum, exact, 2e-14) << n << " " << power;
    }
  }
}

TEST(Chebyshev, CellMeansOfAPolynomialAreExact) {
  const size_t n = 6, cells = 5;
  const auto f = [](double x) { return 1 - 3 * x + 2 * x * x * x - 7 * std::pow(x, 5); };
  const auto whole = [](double x) {
    return x - 1.5 * x * x + 0.5 * std::pow(x, 4) - 7.0 / 6.0 * std::pow(x, 6);
  };
  Eigen::VectorXd values(static_cast<Eigen::Index>(n));
  for (size_t i = 0; i < n; ++i) values(static_cast<Eigen::Index>(i)) = f(chebyshev_fraction(n, i));
  const Eigen::VectorXd means = chebyshev_term_means(n, cells) * chebyshev_coefficients(n) * values;
  for (size_t c = 0; c < cells; ++c) {
    const double low = static_cast<double>(c) / cells, high = static_cast<double>(c + 1) / cells;
    EXPECT_NEAR(means(static_cast<Eigen::Index>(c)), (whole(high) - whole(low)) / (high - low),
                1e-13);
  }
}

// The coefficients of T₃ by its values: 0, 0, 0, 1, 0.
TEST(Chebyshev, WeightsPickOutOneCoefficient) {
  const size_t n = 5;
  for (size_t k = 0; k < n; ++k) {
    double coefficient = 0.0;
    for (size_t i = 0; i < n; ++i) {
      const double x = chebyshev_point(n, i);
      coefficient += chebyshev_weight(n, k, std::acos(x)) * (4.0 * x * x * x - 3.0 * x);
    }
    EXPECT_NEAR(coefficient, k == 3 ? 1.0 : 0.0, 1e-15) << k;
  }
}

TEST(MonotoneSlopes, NeverLeaveTheDataAndMeetSmoothOnes) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<double> x{0.0}, y{uniform(random)};
    for (int i = 0; i < 12; ++i) {
      x.push_back(x.back() + 0.01 + uniform(random));
      y.push_back(uniform(random) < 0.3 ? y.back() : uniform(random));
    }
    const auto slope = monotone_slopes(x, y);
    for (size_t i = 0; i + 1 < x.size(); ++i) {
      double before = y[i];
      for (double t = 0.02; t <= 1.0; t += 0.02) {
        const double at = hermite(x[i + 1] - x[i], y[i], slope[i], y[i + 1], slope[i + 1], t);
        EXPECT_GE((at - before) * (y[i + 1] - y[i]), -1e-15);
        before = at;
      }
    }
  }
  std::vector<double> x, y;
  for (int i = 0; i <= 20; ++i) {
    x.push_back(0.05 * i + 0.01 * (i % 3));
    y.push_back(std::exp(x.back()));
  }
  const auto slope = monotone_slopes(x, y);
  for (size_t i = 2; i + 2 < x.size(); ++i) EXPECT_NEAR(slope[i] / y[i], 1.0, 3e-6);
}

TEST(Hermite, CubicsAreExact) {
  const auto f = [](double x) { return 2.0 - x + 0.5 * x * x - 3.0 * x * x * x; };
  const auto slope = [](double x) { return -1.0 + x - 9.0 * x * x; };
  for (const double t : {0.0, 0.25, 0.7, 1.0}) {
    EXPECT_NEAR(hermite(3.0, f(-1.0), slope(-1.0), f(2.0), slope(2.0), t), f(-1.0 + 3.0 * t),
                1e-14);
  }
}

TEST(Bisect, EndsAtNeighbouringNumbersOrAtTheStatedTolerance) {
  const auto below = [](double x) { return x * x < 2.0; };
  const RootBracket exact = bisect(0.0, 2.0, below);
  EXPECT_EQ(std::nextafter(exact.low, 2.0), exact.high);
  EXPECT_LE(exact.low, std::sqrt(2.0));
  EXPECT_GE(exact.high, std::sqrt(2.0));
  const RootBracket ten = bisect(0.0, 2.0, below, {10});
  EXPECT_EQ(ten.high - ten.low, 2.0 / 1024);
  const RootBracket coarse = bisect(0.0, 2.0, below, {200, 1e-3});
  EXPECT_LE(coarse.high - coarse.low, 1e-3 * coarse.high);
  EXPECT_GT(coarse.high - coarse.low, 0.4e-3 * coarse.high);
}

// From every start, although Newton's method alone leaves the bracket from most of them.
TEST(NewtonRoot, StaysInItsBracket) {
  for (const double start : {-4.9, -1.0, 0.0, 0.3, 4.9}) {
    int count = 0;
    const double root = newton_root(-5.0, 5.0, start, 1e-15, [&](double x) {
      ++count;
      const double f = std::atan(x - 0.4);
      return NewtonStep{f < 0.0, -f * (1.0 + (x - 0.4) * (x - 0.4))};
    });
    EXPECT_NEAR(root, 0.4, 1e-15) << start;
    EXPECT_LT(count, 60) << start;
  }
}

// e^−x = 1/2 and its derivatives: with more of them, fewer evaluations.
TEST(FallingRoot, EveryDerivativeSavesEvaluations) {
  const double exact = std::log(2.0);
  std::vector<int> counts;
  for (const int known : {1, 2, 3}) {
    int count = 0;
    const double root = falling_root(0.0, 50.0, 2.5, 1e-9, [&](double x) {
      ++count;
      const double e = std::exp(-x);
      FunctionAt f{e - 0.5, -e};
      if (known > 1) f.curvature = e;
      if (known > 2) f.third = -e;
      return f;
    });
    EXPECT_NEAR(root, exact, 1e-14) << known;
    counts.push_back(count);
  }
  EXPECT_LE(counts[1], counts[0]);
  EXPECT_LE(counts[2], counts[1]);
  EXPECT_LT(counts[2], counts[0]);
}

// One step of four numbers is four steps of one.
TEST(RootStep, LanesAndNumbersTakeTheSameSteps) {
  const Quad value{0.3, -2.0, 1e-9, 5.0}, slope{-1.0, -0.2, -3.0, -0.1};
  const Quad curvature{0.5, 0.01, -2.0, 4.0}, third{-0.1, 0.3, 7.0, -9.0};
  const RootStep<Quad> four = third_order_step(value, slope, curvature, third);
  for (int i = 0; i < 4; ++i) {
    const RootStep<double> one =
        third_order_step<double>(value[i], slope[i], curvature[i], third[i]);
    EXPECT_DOUBLE_EQ(four.length[i], one.length);
    EXPECT_DOUBLE_EQ(four.left[i], one.left);
  }
}

TEST(Quad, FunctionsWorkNumberByNumber) {
  const Quad x{0.25, 1.0, 2.5, 700.0}, y{-1.0, NAN, 3.0, HUGE_VAL};
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(sqrt(x)[i], std::sqrt(x[i]));
    EXPECT_NEAR(exp(x)[i] / std::exp(x[i]), 1.0, 3e-16);
    EXPECT_NEAR(log(x)[i], std::log(x[i]), 3e-16 * std::abs(std::log(x[i])));
    EXPECT_EQ(max(x, y)[i], std::max(x[i], y[i]));
    EXPECT_EQ(min(x, y)[i], std::min(x[i], y[i]));
    EXPECT_EQ(is_finite(y)[i] != 0, std::isfinite(y[i]));
  }
  EXPECT_EQ(abs(y)[0], 1.0);
  EXPECT_TRUE(all_of(x > 0.0));
  EXPECT_FALSE(all_of(x > 1.0));
  EXPECT_TRUE(any_of(x > 600.0));
  EXPECT_FALSE(any_of(x > 701.0));
}

}  // namespace
}  // namespace photorque
