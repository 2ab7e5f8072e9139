// Light from a planet compared with closed forms and with an independent integration.
#include "attitude/environment/planet_light.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/constants.h"

namespace photorque {
namespace {

constexpr double earth_m = 6371.2e3;

PlanetSurface even(double albedo, double emissivity) {
  return {{albedo, 0.0, 0.0}, {emissivity, 0.0, 0.0}};
}

// Reflected and infrared irradiance of a plate with this normal (axes of planet_axes()).
PlanetIrradiance on_plate(const std::vector<PlanetPart>& parts, const PlanetSurface& surface,
                          const Vec3& normal, const Mat3& axes, const Vec3& to_sun,
                          double season = 0.0) {
  PlanetIrradiance sum;
  for (const PlanetPart& part : parts) {
    const double cosine = std::max(0.0, part.towards.dot(normal));
    const PlanetIrradiance one = planet_irradiance(part, surface, axes, to_sun, season, 1361.0);
    sum.reflected_W_m2 += cosine * one.reflected_W_m2;
    sum.infrared_W_m2 += cosine * one.infrared_W_m2;
  }
  return sum;
}

// A uniformly bright sphere of exitance M gives M (R/r)² cos γ to a plate that sees all of it,
// where γ is the angle between the normal of the plate and the direction to the centre.
// Source: J. R. Howell, R. Siegel, M. P. Mengüç, A Catalog of Radiation Heat Transfer Configuration
// Factors, B-12 and B-13.
TEST(PlanetLight, APlateThatSeesTheWholePlanetHasTheClosedViewFactor) {
  for (const double altitude_m : {400e3, 550e3, 20200e3, 35786e3}) {
    const double distance_m = earth_m + altitude_m, ratio = earth_m / distance_m;
    const double widest_rad = 0.5 * pi - std::asin(ratio);
    const double expected = 0.68 * 1361.0 / 4.0 * ratio * ratio;
    for (const double tilt_rad : {0.0, 0.5 * widest_rad, 0.99 * widest_rad}) {
      const Vec3 normal(std::sin(tilt_rad), 0.0, -std::cos(tilt_rad));
      const PlanetIrradiance got = on_plate(planet_parts(earth_m, distance_m), even(0.0, 0.68),
                                            normal, Mat3::Identity(), Vec3::UnitX());
      EXPECT_NEAR(got.infrared_W_m2, expected * std::cos(tilt_rad), 1e-12 * expected);
      EXPECT_EQ(got.reflected_W_m2, 0.0);
    }
  }
}

// A plate edge-on to the vertical sees half of the planet: F = (ρ − sin ρ cos ρ)/π with sin ρ =
// R/r. Source: Howell, Siegel, Mengüç, B-13, at 90 deg.
TEST(PlanetLight, AnUprightPlateSeesHalf) {
  const double distance_m = earth_m + 800e3, rho = std::asin(earth_m / distance_m);
  const PlanetIrradiance got = on_plate(planet_parts(earth_m, distance_m, 24, 256), even(0.0, 1.0),
                                        Vec3::UnitX(), Mat3::Identity(), Vec3::UnitX());
  const double factor = (rho - std::sin(rho) * std::cos(rho)) / pi;
  EXPECT_NEAR(got.infrared_W_m2 / (1361.0 / 4.0), factor, 1e-4 * factor);
}

// From far away a Lambert sphere gives (2/3) a E (R/r)² (sin α + (π − α) cos α)/π at the phase
// angle α. Source: H. N. Russell, Astrophysical Journal 43, 173 (1916).
TEST(PlanetLight, FromFarAwayTheSphereHasItsPhases) {
  const double ratio = 1e-3;
  const auto parts = planet_parts(earth_m, earth_m / ratio, 32, 256);
  for (const double phase_deg : {0.0, 30.0, 90.0, 135.0, 170.0}) {
    const double a = phase_deg * degree_rad;
    const Vec3 to_sun(std::sin(a), 0.0, std::cos(a));
    const PlanetIrradiance got =
        on_plate(parts, even(0.3, 0.0), -Vec3::UnitZ(), Mat3::Identity(), to_sun);
    const double expected =
        2.0 / 3.0 * 0.3 * 1361.0 * ratio * ratio * (std::sin(a) + (pi - a) * std::cos(a)) / pi;
    EXPECT_NEAR(got.reflected_W_m2, expected, 2e-3 * 1361.0 * 0.2 * ratio * ratio) << phase_deg;
  }
}

// A sum over points on the surface by the formula for flat parts: M cos α dA/(π d²).
TEST(PlanetLight, AgreesWithPointsThrownOnTheSphere) {
  const double distance_m = earth_m + 550e3;
  const PlanetSurface earth;
  const Vec3 up = Vec3(0.3, -0.5, 0.8).normalized(), to_sun = Vec3(0.9, 0.1, 0.4).normalized();
  const Mat3 axes = planet_axes(up, to_sun);
  const double season = 0.8;
  Vec3 expected = Vec3::Zero();
  constexpr size_t count = 1'000'000;
  const double lowest = earth_m / distance_m;  // cosine of the horizon's angle at the centre
  for (size_t i = 0; i < count; ++i) {
    // A lattice with two irrational steps covers the cap uniformly.
    const double u = std::fmod(0.5 + 0.7548776662466927 * static_cast<double>(i), 1.0);
    const double v = std::fmod(0.5 + 0.5698402909980532 * static_cast<double>(i), 1.0);
    const double c = lowest + (1.0 - lowest) * u, s = std::sqrt(1.0 - c * c);
    const Vec3 zenith = axes * Vec3(s * std::cos(2.0 * pi * v), s * std::sin(2.0 * pi * v), c);
    const Vec3 way = earth_m * zenith - distance_m * up;  // from the satellite
    const double d = way.norm(), cos_alpha = -zenith.dot(way) / d;
    const double latitude = zenith.z(), second = 1.5 * latitude * latitude - 0.5;
    const double albedo = 0.34 + 0.10 * season * latitude + 0.29 * second;
    const double emissivity = 0.68 - 0.07 * season * latitude - 0.18 * second;
    const double exitance =
        1361.0 * (albedo * std::max(0.0, zenith.dot(to_sun)) + 0.25 * emissivity);
    const double area_m2 = 2.0 * pi * earth_m * earth_m * (1.0 - lowest) / count;
    expected += exitance * cos_alpha * area_m2 / (pi * d * d) * way / d;
  }
  const auto flow = [&](size_t rings, size_t sectors) {
    Vec3 sum = Vec3::Zero();
    for (const PlanetPart& part : planet_parts(earth_m, distance_m, rings, sectors)) {
      sum += planet_irradiance(part, earth, axes, to_sun, season, 1361.0).sum_W_m2() *
             (axes * part.towards);
    }
    return sum;
  };
  EXPECT_LT((flow(24, 128) - expected).norm(), 2e-4 * expected.norm());
  EXPECT_LT((flow(4, 12) - expected).norm(), 3e-3 * expected.norm());  // the default partition
}

// 22 December is in the northern winter: more snow and less infrared in the north.
TEST(PlanetLight, SeasonsAreTheNorthernOnes) {
  EXPECT_NEAR(season_cosine(2024.0 + 355.0 / 365.0), 1.0, 1e-9);
  EXPECT_NEAR(season_cosine(2024.0 + 172.5 / 365.0), -1.0, 1e-9);
  const PlanetSurface earth;
  EXPECT_DOUBLE_EQ(earth.albedo.at(1.0, 1.0), 0.34 + 0.10 + 0.29);
  EXPECT_DOUBLE_EQ(earth.emissivity.at(-1.0, 1.0), 0.68 + 0.07 - 0.18);
}

// In the middle of the Earth's shadow the satellite sees no lit ground; infrared stays.
TEST(PlanetLight, NothingIsReflectedInTheMiddleOfTheShadow) {
  const Mat3 axes = planet_axes(Vec3::UnitX(), -Vec3::UnitX());
  const PlanetIrradiance got = on_plate(planet_parts(earth_m, earth_m + 550e3), PlanetSurface{},
                                        -Vec3::UnitZ(), axes, -Vec3::UnitX());
  EXPECT_EQ(got.reflected_W_m2, 0.0);
  EXPECT_GT(got.infrared_W_m2, 100.0);
}

}  // namespace
}  // namespace photorque
