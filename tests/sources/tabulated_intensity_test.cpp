// The interpolant of an intensity table: monotone, of exactly known flux, sampled exactly.
#include "sources/profiles/tabulated_intensity.h"

#include <random>

#include "core/constants.h"
#include "raytrace/direct/disc_light.h"
#include "sampling.h"
#include "sources/lamps/ies.h"

namespace photorque {
namespace {

using test::table_direction;

IntensityTable axial(double step_rad, double end_rad, const std::function<double(double)>& f) {
  IntensityTable table;
  const auto steps = static_cast<int>(std::lround(end_rad / step_rad));
  for (int i = 0; i <= steps; ++i) {
    table.polar_rad.push_back(i == steps ? end_rad : i * step_rad);
    table.intensity.push_back(f(table.polar_rad.back()));
  }
  table.azimuth_rad = {0.0};
  return table;
}

// Planes over the whole turn of I(polar, azimuth).
IntensityTable planes(int count, double end_rad, const std::function<double(double, double)>& f) {
  IntensityTable table = axial(2 * deg, end_rad, [](double) { return 0.0; });
  table.azimuth_rad.clear();
  table.intensity.clear();
  for (int j = 0; j < count; ++j) {
    table.azimuth_rad.push_back(2 * pi * j / count);
    for (const double t : table.polar_rad) {
      table.intensity.push_back(f(t, table.azimuth_rad.back()));
    }
  }
  return table;
}

// ∫ exp(−θ²/2σ²) over the sphere, by a sum of a million terms.
double gaussian_flux(double sigma_rad) {
  constexpr int steps = 1'000'000;
  const double end = std::min(pi, 9 * sigma_rad);
  double sum = 0.0;
  for (int i = 0; i < steps; ++i) {
    const double t = end * (i + 0.5) / steps;
    sum += std::sin(t) * std::exp(-0.5 * t * t / (sigma_rad * sigma_rad));
  }
  return 2 * pi * sum * end / steps;
}

// A smooth beam in steps of 1/25 of its width: between the angles the curve errs by so little that
// the flux is right to 1e-6. Lambert's law, whose flux is π, in steps of 5 degrees.
TEST(TabulatedIntensity, FluxOfSmoothTablesIsThatOfTheBeam) {
  const double sigma = 1.5 * deg / std::sqrt(2 * std::numbers::ln2);
  const TabulatedIntensity gaussian(axial(
      0.05 * deg, 30 * deg, [&](double t) { return std::exp(-0.5 * t * t / (sigma * sigma)); }));
  EXPECT_NEAR(gaussian.flux() / gaussian_flux(sigma), 1.0, 1e-7);
  const TabulatedIntensity lambert(axial(5 * deg, 90 * deg, [](double t) { return std::cos(t); }));
  EXPECT_NEAR(lambert.flux() / pi, 1.0, 2e-6);
  const TabulatedIntensity sphere(axial(5 * deg, pi, [](double) { return 3.0; }));
  EXPECT_NEAR(sphere.flux() / (12 * pi), 1.0, 1e-14);
}

// The flux against the interpolant itself, summed point by point: equal for coarse, jagged tables
// too.
TEST(TabulatedIntensity, FluxIsThatOfTheInterpolant) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const TabulatedIntensity jagged(
      planes(8, pi, [&](double, double) { return uniform(random) < 0.2 ? 0.0 : uniform(random); }));
  double sum = 0.0;
  constexpr int polar_steps = 7200, turns = 64;  // corners of the interpolant are on the grid
  for (int i = 0; i < polar_steps; ++i) {
    const double t = pi * (i + 0.5) / polar_steps;
    for (int k = 0; k < turns; ++k) {
      sum += std::sin(t) * jagged.at(t, 2 * pi * (k + 0.5) / turns);
    }
  }
  sum *= pi / polar_steps * (2 * pi / turns);
  EXPECT_NEAR(jagged.flux() / sum, 1.0, 1e-6);
}

TEST(TabulatedIntensity, CellsAreSampledWithTheirShareOfTheFlux) {
  // Bright to one side, dark in some planes, and with an edge: the flux in a cell of directions is
  // counted and compared with the integral of the interpolant.
  const TabulatedIntensity intensity(planes(12, 100 * deg, [](double t, double azimuth) {
    if (azimuth > 5.0) return 0.0;
    return std::exp(-t) * (1.2 + std::cos(azimuth - 0.7)) + (t < 20 * deg ? 1.0 : 0.0);
  }));
  constexpr int rows = 10, columns = 12, fine = 40;
  std::vector<double> expected(rows * columns, 0.0), counted(rows * columns, 0.0);
  const double row_rad = 100 * deg / rows, column_rad = 2 * pi / columns;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      double sum = 0.0;
      for (int i = 0; i < fine; ++i) {
        for (int k = 0; k < fine; ++k) {
          const double t = row_rad * (row + (i + 0.5) / fine);
          sum += std::sin(t) * intensity.at(t, column_rad * (column + (k + 0.5) / fine));
        }
      }
      expected[row * columns + column] =
          sum * row_rad * column_rad / (fine * fine) / intensity.flux();
    }
  }
  const PhotometricLamp lamp(1.0, {}, intensity);
  constexpr uint32_t rays = 1u << 20;
  for (const auto& ray : test::rays_of(lamp, rays)) {
    const GoniometerAngles at = table_angles(Pole::beam, ray.direction);
    const double turn = at.azimuth_rad < 0.0 ? at.azimuth_rad + 2 * pi : at.azimuth_rad;
    const int row = std::min(static_cast<int>(at.polar_rad / row_rad), rows - 1);
    const int column = std::min(static_cast<int>(turn / column_rad), columns - 1);
    counted[row * columns + column] += 1.0 / rays;
  }
  for (size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(counted[i], expected[i], 2e-5) << i;
}

TEST(TabulatedIntensity, PolesAcrossTheBeamEmitAtTheirAngles) {
  for (const Pole pole : {Pole::vertical, Pole::horizontal}) {
    IntensityTable table{pole, {}, {}, false, {}};
    for (int i = 0; i <= 18; ++i) table.polar_rad.push_back((45 + 5 * i) * deg);
    for (int j = -6; j <= 6; ++j) table.azimuth_rad.push_back(5 * j * deg);
    for (const double azimuth : table.azimuth_rad) {
      for (const double polar : table.polar_rad) {
        const Vec3 d = table_direction(pole, polar, azimuth);
        table.intensity.push_back(std::exp(10 * d.z() + 4 * d.x() - 2 * d.y()));
      }
    }
    const TabulatedIntensity intensity(table);
    Vec3 first = Vec3::Zero(), expected = Vec3::Zero();
    for (int i = 0; i < 900; ++i) {
      for (int k = 0; k < 600; ++k) {
        const double polar = (45 + 0.1 * (i + 0.5)) * deg, azimuth = (-30 + 0.1 * (k + 0.5)) * deg;
        expected +=
            std::sin(polar) * intensity.at(polar, azimuth) * table_direction(pole, polar, azimuth);
      }
    }
    expected *= 0.01 * deg * deg / intensity.flux();
    const PhotometricLamp lamp(1.0, {}, intensity);
    constexpr uint32_t rays = 1u << 16;
    for (const auto& ray : test::rays_of(lamp, rays)) first += ray.direction / rays;
    EXPECT_TRUE(first.isApprox(expected, 2e-5))
        << first.transpose() << " / " << expected.transpose();
    EXPECT_GT(first.x(), 0.05);
    EXPECT_LT(first.y(), -0.02);
  }
}

TEST(TabulatedIntensity, TablesThatAreTooCoarseAreNamedWithTheirError) {
  const double sigma = 1.5 * deg / std::sqrt(2 * std::numbers::ln2);
  const auto beam = [&](double t) { return std::exp(-0.5 * t * t / (sigma * sigma)); };
  const PhotometricLamp fine(1.0, {}, TabulatedIntensity(axial(0.05 * deg, 30 * deg, beam)));
  EXPECT_EQ(coarseness_notice(fine), std::nullopt);
  // Straight lines hold h²/12 · I''(0)/I(0) more flux: (h/σ)²/12 (Euler and Maclaurin).
  const PhotometricLamp coarse(1.0, {}, TabulatedIntensity(axial(0.25 * deg, 30 * deg, beam)));
  EXPECT_NEAR(coarse.intensity().coarseness().straight, std::pow(0.25 * deg / sigma, 2) / 12, 2e-5);
  EXPECT_THAT(coarseness_notice(coarse).value_or(""), testing::HasSubstr("steps of 0.25 deg"));
}

// A disc of radius R that shines by Lambert's law with exitance M lights a point of its axis at z
// with M R²/(R² + z²) (J. R. Howell, A Catalog of Radiation Heat Transfer Configuration Factors,
// B-12); a narrow beam from a small disc with power times intensity per flux over z².
TEST(PhotometricLamp, CanBeGatheredFromAsADisc) {
  const Opening disc{Opening::Shape::ellipse, 0.4, 0.4};
  const PhotometricLamp lambert(
      2.0, disc, TabulatedIntensity(axial(deg, 90 * deg, [](double t) { return std::cos(t); })));
  const auto aperture = uniform_aperture(lambert);
  ASSERT_TRUE(aperture.has_value());
  for (const double z : {0.1, 0.5, 2.0}) {
    const double expected = 2.0 / (pi * 0.04) * 0.04 / (0.04 + z * z);
    EXPECT_NEAR(DiscLight(lambert, *aperture).irradiance_W_m2(Vec3(0, 0, z), -Vec3::UnitZ()),
                expected, 2e-5 * expected);
  }
  const double sigma = 1.5 * deg / std::sqrt(2 * std::numbers::ln2);
  const PhotometricLamp narrow(1.0, {Opening::Shape::ellipse, 1e-4, 1e-4},
                               TabulatedIntensity(axial(0.1 * deg, 90 * deg, [&](double t) {
                                 return std::exp(-0.5 * t * t / (sigma * sigma));
                               })));
  const double expected = 1.0 / gaussian_flux(sigma);
  EXPECT_NEAR(
      DiscLight(narrow, *uniform_aperture(narrow)).irradiance_W_m2(Vec3(0, 0, 1), -Vec3::UnitZ()),
      expected, 2e-5 * expected);
}

TEST(PhotometricLamp, IsNoDiscWithSidesOrACornerOrLightBehind) {
  const Opening disc{Opening::Shape::ellipse, 0.4, 0.4};
  const auto lambert = axial(deg, 90 * deg, [](double t) { return std::cos(t); });
  const Opening square{Opening::Shape::rectangle, 0.4, 0.4};
  EXPECT_FALSE(uniform_aperture(PhotometricLamp(1.0, square, TabulatedIntensity(lambert))));
  const auto sided =
      planes(8, 90 * deg, [](double t, double c) { return std::cos(t) * (1.5 + std::cos(c)); });
  EXPECT_FALSE(uniform_aperture(PhotometricLamp(1.0, disc, TabulatedIntensity(sided))));
  const auto behind = axial(deg, 120 * deg, [](double) { return 1.0; });
  EXPECT_FALSE(uniform_aperture(PhotometricLamp(1.0, disc, TabulatedIntensity(behind))));
}

}  // namespace
}  // namespace photorque
