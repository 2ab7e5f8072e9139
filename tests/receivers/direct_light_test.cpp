// Parts of gathering: the light of a disc on a point, tables and rules of quadrature, shafts.
#include <gtest/gtest.h>

#include <random>

#include "core/constants.h"
#include "core/numerics/quadrature.h"
#include "raytrace/direct/disc_light.h"
#include "raytrace/direct/irradiance_table.h"
#include "raytrace/tracing/shadow.h"
#include "tests/raytrace/test_scenes.h"
#include "tests/receivers/gather_lamps.h"

namespace photorque {
namespace {

using fixtures::gaussian_led;
using fixtures::lambertian_disc;
using fixtures::pillbox_disc;

// View factors from a surface element to a disc of radius r, by contour integration.
// Source: J. R. Howell, A Catalog of Radiation Heat Transfer Configuration Factors, B-12 (element
// parallel to the disc, offset a) and B-15 (element normal to the disc's plane, facing its axis).
double parallel_view_factor(double h, double a, double r) {
  const double H = h / a, R = r / a, Z = 1 + H * H + R * R;
  return 0.5 * (1 - (Z - 2 * R * R) / std::sqrt(Z * Z - 4 * R * R));
}
double upright_view_factor(double h, double a, double r) {
  const double H = h / a, R = r / a, Z = 1 + H * H + R * R;
  return 0.5 * H * (Z / std::sqrt(Z * Z - 4 * R * R) - 1);
}

TEST(DiscLight, LambertianDiscMatchesViewFactors) {
  const double r = 0.2, exitance = 2.0 / (pi * r * r);
  const Beam beam = lambertian_disc(2 * r);
  const DiscLight light(*beam.emitter, *beam.aperture);
  EXPECT_NEAR(light.exitance_W_m2(), exitance, 1e-12 * exitance);
  for (const double h : {0.05, 0.3, 2.0}) {
    EXPECT_NEAR(light.irradiance_W_m2({0, 0, h}, {0, 0, -1}), exitance * r * r / (h * h + r * r),
                1e-5 * exitance);
    for (const double a : {0.1, 0.2, 0.5, 1.5}) {
      const double parallel = exitance * parallel_view_factor(h, a, r);
      EXPECT_NEAR(light.irradiance_W_m2({a, 0, h}, {0, 0, -1}), parallel, 2e-5 * exitance)
          << h << " " << a;
    }
    // An upright element sees the whole disc from the front only beside it.
    for (const double a : {0.5, 1.5}) {
      const double upright = exitance * upright_view_factor(h, a, r);
      EXPECT_NEAR(light.irradiance_W_m2({0, a, h}, {0, -1, 0}), upright, 2e-5 * exitance)
          << h << " " << a;
    }
  }
}

TEST(DiscLight, LightOnAWidePlaneIsAllItsPower) {
  for (const double diameter_m : {0.002, 0.02, 0.2}) {
    const Beam beam = gaussian_led(diameter_m, 6.0, {0, 0, 0}, {0, 0, 1});
    const DiscLight light(*beam.emitter, *beam.aperture);
    const double h = 1.0;
    double power_W = 0.0;
    for (const auto& [x, weight] : gauss_legendre(64)) {
      const double r = 0.35 * (1 + x);
      power_W += 0.35 * weight * 2 * pi * r * light.irradiance_W_m2({r, 0, h}, {0, 0, -1});
    }
    EXPECT_NEAR(power_W, 1.0, 3e-5) << diameter_m;
  }
}

TEST(DiscLight, HalfOfTheFluxOfAGaussianIsWithinHalfItsWidth) {
  const Beam beam = gaussian_led(0.01, 3.0, {0, 0, 0}, {0, 0, 1});
  const DiscLight light(*beam.emitter, *beam.aperture);
  EXPECT_NEAR(light.half_flux_rad() / degree_rad, 1.5, 1e-3);
  EXPECT_TRUE(light.fades_out());
  const Beam sharp = pillbox_disc("angle");
  EXPECT_FALSE(DiscLight(*sharp.emitter, *sharp.aperture).fades_out());
}

// Largest difference at scattered points, over the largest irradiance.
double table_error(const DiscLight& light, const IrradianceTable& table, double low_m,
                   double high_m, double wide_m) {
  const SobolSequence points({3, 1, 0});
  double largest = 0.0, worst = 0.0;
  for (uint32_t i = 0; i < 2000; ++i) {
    const auto p = points.point(i);
    const Vec3 at(wide_m * (2 * p[0] - 1), wide_m * (2 * p[1] - 1),
                  low_m + p[2] * (high_m - low_m));
    const double lean = p[3] - 0.5;
    const Vec3 normal(std::sin(lean), 0, -std::cos(lean));
    const double expected = light.irradiance_W_m2(at, normal);
    largest = std::max(largest, expected);
    worst = std::max(worst, std::abs(table.irradiance_W_m2(at, normal) - expected));
  }
  return worst / largest;
}

TEST(IrradianceTable, AgreesWithTheIntegralForSmoothAndForSharpBeams) {
  for (const Beam& beam :
       {gaussian_led(0.045, 3, {0, 0, 1.5}, {0, 0, -1}), pillbox_disc("angle")}) {
    const DiscLight light(*beam.emitter, *beam.aperture);
    for (const double high_m : {1.2, 1.8}) {
      const auto table = IrradianceTable::make(light, 1.2, high_m, 1);
      ASSERT_TRUE(table.has_value()) << high_m;
      EXPECT_LT(table_error(light, *table, 1.2, high_m, 0.3), 5e-6) << high_m;
    }
  }
}

TEST(IrradianceTable, RejectsFunctionsThatCannotBeTabulated) {
  const Beam pillbox = pillbox_disc("angle"), lambertian = lambertian_disc(0.4);
  const DiscLight sharp(*pillbox.emitter, *pillbox.aperture);
  // The beam's edge crosses the axis at 0.2 m / tan 1.5° = 7.6 m.
  EXPECT_TRUE(IrradianceTable::make(sharp, 6.0, 7.0, 1).has_value());
  EXPECT_FALSE(IrradianceTable::make(sharp, 6.0, 9.0, 1).has_value());
  const DiscLight wide(*lambertian.emitter, *lambertian.aperture);
  EXPECT_FALSE(IrradianceTable::make(wide, 1.0, 2.0, 1).has_value());
}

// A segment between random points of two balls that crosses a triangle proves that the shaft meets
// it.
TEST(Shaft, NeverLosesATriangleThatALineCrosses) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  const auto point = [&](double scale) {
    return Vec3(scale * normal(random), scale * normal(random), scale * normal(random));
  };
  int crossed = 0, spared = 0;
  for (int i = 0; i < 20000; ++i) {
    const Ball from{point(1.0), 0.3 * std::abs(normal(random))};
    const Ball to{point(1.0), 0.3 * std::abs(normal(random))};
    const Vec3 a = from.centre_m + from.radius_m * std::cbrt(0.9) * point(1.0).normalized();
    const Vec3 b = to.centre_m + to.radius_m * std::cbrt(0.9) * point(1.0).normalized();
    // A triangle about a point of the segment, and one anywhere.
    const Vec3 on = a + std::uniform_real_distribution<double>(0, 1)(random) * (b - a);
    const Vec3 e = point(0.5), f = point(0.5);
    const TriangleCorners hit = {on + e, on + f, on - e - f};
    EXPECT_TRUE(Shaft(from, to).may_meet(hit));
    ++crossed;
    const Vec3 away = point(2.0);
    spared += Shaft(from, to).may_meet({away, away + point(0.2), away + point(0.2)}) ? 0 : 1;
  }
  EXPECT_EQ(crossed, 20000);
  EXPECT_GT(spared, 12000);  // it does leave out most of what is far away
}

// All lines between two balls that a convex body blocks go into it; a lamp within it is not
// blocked.
TEST(Shaft, BlocksOnlyWhatGoesThroughTheBody) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const auto point = [&](double scale) {
    return Vec3(scale * normal(random), scale * normal(random), scale * normal(random));
  };
  int blocked = 0, missed = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 low = point(0.5), high = low + point(1.0).cwiseAbs() + Vec3::Constant(0.05);
    Scene scene;
    fixtures::add(scene, fixtures::box(low, high), grey_surface("s", 0, 0), "box");
    const auto occluders = occluders_above(scene, Vec3(0, 0, -100), Vec3::UnitZ());
    ASSERT_EQ(occluders.size(), 1u);
    ASSERT_EQ(occluders[0].faces.size(), 6u);
    const Ball from{point(1.0), 0.2 * uniform(random)}, to{point(1.5), 0.2 * uniform(random)};
    if (!Shaft(from, to).is_blocked_by(occluders[0])) {
      ++missed;
      continue;
    }
    ++blocked;
    EXPECT_TRUE(Shaft(from, to).may_meet(occluders[0]));
    const Eigen::AlignedBox3d box(low, high);
    EXPECT_FALSE(box.contains(to.centre_m));
    for (int k = 0; k < 20; ++k) {
      const Vec3 a = from.centre_m + from.radius_m * point(1.0).normalized();
      const Vec3 b = to.centre_m + to.radius_m * point(1.0).normalized();
      // The part of the line within the three slabs.
      double first = 0.0, last = 1.0;
      for (int axis = 0; axis < 3; ++axis) {
        const double to_low = (low[axis] - a[axis]) / (b[axis] - a[axis]);
        const double to_high = (high[axis] - a[axis]) / (b[axis] - a[axis]);
        first = std::max(first, std::min(to_low, to_high));
        last = std::min(last, std::max(to_low, to_high));
      }
      EXPECT_LT(first, last);
    }
  }
  EXPECT_GT(blocked, 300);
  EXPECT_GT(missed, 10000);
}

}  // namespace
}  // namespace photorque
