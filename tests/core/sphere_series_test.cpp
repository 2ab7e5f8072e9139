// Functions of a direction as spherical harmonics.
#include "core/numerics/sphere_series.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/constants.h"

namespace photorque {
namespace {

struct Grid {
  std::vector<double> azimuth_rad, elevation_rad;
  Grid(int around, int rings) {
    for (int a = 0; a < around; ++a) azimuth_rad.push_back(-pi + 2.0 * pi * a / around);
    for (int e = 0; e < rings; ++e) elevation_rad.push_back(-0.5 * pi + pi * e / (rings - 1));
  }
  template <typename Function>
  Eigen::MatrixXd values(const Function& f) const {
    Eigen::MatrixXd all(static_cast<Eigen::Index>(azimuth_rad.size() * elevation_rad.size()), 1);
    Eigen::Index node = 0;
    for (const double a : azimuth_rad) {
      for (const double e : elevation_rad) all(node++, 0) = f(a, e);
    }
    return all;
  }
};

Vec3 direction(double azimuth_rad, double elevation_rad) {
  return {std::cos(elevation_rad) * std::cos(azimuth_rad),
          std::cos(elevation_rad) * std::sin(azimuth_rad), std::sin(elevation_rad)};
}

// Polynomials of degree n in x, y, z are harmonics up to degree n.
TEST(SphereSeries, IsExactForPolynomials) {
  const auto cubic = [](double a, double e) {
    const Vec3 d = direction(a, e);
    return 0.3 - d.x() + 2.0 * d.y() * d.z() + d.x() * d.x() * d.y() - 0.7 * std::pow(d.z(), 3);
  };
  const Grid grid(24, 13);
  for (const int degree : {3, 8}) {
    const auto series =
        SphereSeries::fit(degree, grid.azimuth_rad, grid.elevation_rad, grid.values(cubic));
    for (const double a : {-3.0, -0.2, 1.7}) {
      for (const double e : {-0.5 * pi, -0.9, 0.05, 1.2, 0.5 * pi}) {
        EXPECT_NEAR(series.at(a, e)[0], cubic(a, e), 1e-12);
      }
    }
  }
}

// The mean over the sphere of z² z² is 1/5, of (z² − 1/3)² 4/45: z² has parts of degree 0 and 2.
TEST(SphereSeries, PartsOfOneDegreeHaveTheirMeanSquares) {
  const Grid grid(16, 9);
  const auto square = [](double, double e) { return std::pow(std::sin(e), 2); };
  const auto series =
      SphereSeries::fit(4, grid.azimuth_rad, grid.elevation_rad, grid.values(square));
  EXPECT_NEAR(series.mean_product(0, 0, 0), 1.0 / 9.0, 1e-13);
  EXPECT_NEAR(series.mean_product(2, 0, 0), 4.0 / 45.0, 1e-13);
  EXPECT_NEAR(series.mean_product(1, 0, 0), 0.0, 1e-13);
  SphereSeries half = series;
  half.scale(2, 0, 0.5);
  EXPECT_NEAR(half.at(0.3, 0.2)[0], 1.0 / 3.0 + 0.5 * (square(0, 0.2) - 1.0 / 3.0), 1e-12);
}

TEST(SphereSeries, IsSingleValuedAtThePolesWhateverTheValues) {
  const Grid grid(36, 19);
  const auto rough = [](double a, double e) { return std::sin(7.3 * a + 2.0) * std::cos(3.1 * e); };
  const auto series =
      SphereSeries::fit(12, grid.azimuth_rad, grid.elevation_rad, grid.values(rough));
  EXPECT_NEAR(series.at(0.4, 0.5 * pi)[0], series.at(2.9, 0.5 * pi)[0], 1e-12);
}

}  // namespace
}  // namespace photorque
