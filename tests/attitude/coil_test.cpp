// Current loops, the cage, and the field along an orbit.
#include <gtest/gtest.h>

#include <cmath>

#include "attitude/disturbances/fields/coil_cage.h"
#include "core/constants.h"
#include "core/errors.h"
#include "tests/attitude/settings_bench.h"

namespace photorque {
namespace {

std::vector<Vec3> circle(double radius_m, int corners, const Vec3& centre_m) {
  std::vector<Vec3> points;
  for (int i = 0; i < corners; ++i) {
    const double a = 2 * pi * i / corners;
    points.emplace_back(centre_m + radius_m * Vec3(std::cos(a), std::sin(a), 0));
  }
  return points;
}

TEST(CurrentLoop, AreaOfAPolygonDoesNotDependOnTheOrigin) {
  const std::vector<Vec3> here = {{0, 0, 0}, {0.3, 0, 0}, {0.3, 0.2, 0}, {0, 0.2, 0}};
  std::vector<Vec3> there = here;
  for (Vec3& p : there) p += Vec3(5, -3, 2);
  EXPECT_LT((polygon_area_m2(here) - Vec3(0, 0, 0.06)).norm(), 1e-15);
  EXPECT_LT((polygon_area_m2(there) - Vec3(0, 0, 0.06)).norm(), 1e-13);
}

// Eq. 27 for a thin wire is ½ I ∮ r × dl; summed here along many short pieces.
TEST(CurrentLoop, DipoleIsTheMomentOfItsCurrent) {
  const double current_A = 0.7;
  Vec3 moment = Vec3::Zero();
  constexpr int n = 20000;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * pi * i / n;
    const Vec3 r(0.2 * std::cos(a) + 1.0, 0.1 * std::sin(a), 0.3);
    const Vec3 dl = 2 * pi / n * Vec3(-0.2 * std::sin(a), 0.1 * std::cos(a), 0);
    moment += 0.5 * current_A * r.cross(dl);
  }
  const CurrentLoop ellipse{current_A, 1.0, {0, 0, pi * 0.2 * 0.1}};
  EXPECT_LT((dipole_A_m2({&ellipse, 1}) - moment).norm(), 1e-10);
}

TEST(CurrentLoop, SettingsTakeAreasOrCorners) {
  const std::vector<CurrentLoop> loops = read_current_loops(
      {settings_of(table(
           {{"current_A", node(2)}, {"turns", node(10)}, {"area_m2", numbers({0, 0, 0.01})}})),
       settings_of(table(
           {{"current_A", node(-1)},
            {"corners_m", list({numbers({0, 0, 0}), numbers({0, 1, 0}), numbers({0, 0, 1})})}}))});
  EXPECT_LT((dipole_A_m2(loops) - Vec3(-0.5, 0, 0.2)).norm(), 1e-15);
  const Settings two = settings_of(table(
      {{"current_A", node(1)}, {"corners_m", list({numbers({0, 0, 0}), numbers({0, 1, 0})})}}));
  EXPECT_THROW(read_current_loops({two}), InputError);
}

// B = μ₀ I R² / (2 (R² + z²)^{3/2}) on the axis of a circle (any textbook).
TEST(CurrentLoop, FieldOnTheAxisOfACircle) {
  const std::vector<Vec3> loop = circle(0.5, 2000, Vec3::Zero());
  for (const double z : {0.0, 0.3, 2.0}) {
    const double expected =
        vacuum_permeability_N_A2 * 3.0 * 0.25 / (2 * std::pow(0.25 + z * z, 1.5));
    const Vec3 field = polygon_field_T(loop, 3.0, {0, 0, z});
    EXPECT_NEAR(field.z() / expected, 1.0, 1e-5);
    EXPECT_LT(field.head<2>().norm(), 1e-12 * expected);
  }
}

// Ampère: ∮ B·dl around the wire is μ₀ I, once the loop is closed.
TEST(CurrentLoop, FieldObeysAmpere) {
  const std::vector<Vec3> loop = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  double circulation = 0;
  constexpr int n = 4000;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * pi * (i + 0.5) / n;
    // A circle around the side x = 1, right-handed about its current (+y).
    const Vec3 at(1 + 0.4 * std::cos(a), 0.2, -0.4 * std::sin(a));
    const Vec3 dl = 2 * pi / n * 0.4 * Vec3(-std::sin(a), 0, -std::cos(a));
    circulation += polygon_field_T(loop, 5.0, at).dot(dl);
  }
  EXPECT_NEAR(circulation / (vacuum_permeability_N_A2 * 5.0), 1.0, 1e-6);
}

// The classical pair of circles a radius apart: B = (4/5)^{3/2} μ₀ n I / R.
TEST(CurrentLoop, HelmholtzPairOfCircles) {
  const double R = 0.8;
  Vec3 field = Vec3::Zero();
  for (const double z : {-0.5 * R, 0.5 * R})
    field += polygon_field_T(circle(R, 2000, {0, 0, z}), 1.0, Vec3::Zero());
  EXPECT_NEAR(field.z() / (std::pow(0.8, 1.5) * vacuum_permeability_N_A2 / R), 1.0, 1e-5);
}

CoilCage cage() {
  const CoilPair pair{1.2, square_pair_spacing * 1.2, 40};
  return {{pair, {1.3, square_pair_spacing * 1.3, 40}, {1.4, square_pair_spacing * 1.4, 40}}};
}

TEST(CoilCage, CurrentsMakeTheWantedField) {
  const Vec3 wanted_T(2e-5, -1e-5, 4.5e-5);
  const Vec3 currents_A = cage().currents_A(wanted_T);
  EXPECT_LT((cage().field_lab_T(currents_A, Vec3::Zero()) - wanted_T).norm(), 1e-18);
}

// Square pairs: B = 1.629 μ₀ n I / side · … at the published optimum spacing; here from the closed
// form of a square's axis field, 4 μ₀I a²/(2π (a² + z²) √(2a² + z²)) with a half the side.
TEST(CoilCage, CentreFieldIsThatOfTwoSquares) {
  const double a = 0.6, z = 0.5 * square_pair_spacing * 1.2;
  const double expected = 2 * 40 * 4 * vacuum_permeability_N_A2 * a * a /
                          (2 * pi * (a * a + z * z) * std::sqrt(2 * a * a + z * z));
  EXPECT_NEAR(cage().field_lab_T({1, 0, 0}, Vec3::Zero()).x() / expected, 1.0, 1e-12);
}

// At the named spacing the second derivative on the axis vanishes: the field is flat to fourth
// order.
TEST(CoilCage, NamedSpacingIsTheFlattest) {
  const auto curvature = [](double spacing_over_side) {
    const CoilPair pair{1.0, spacing_over_side, 1};
    const CoilCage c{{pair, pair, pair}};
    const auto field = [&](double x) { return c.field_lab_T({1, 0, 0}, {x, 0, 0}).x(); };
    return (field(0.01) - 2 * field(0) + field(-0.01)) / field(0) / 1e-4;
  };
  EXPECT_LT(std::abs(curvature(square_pair_spacing)), 3e-3);
  EXPECT_GT(std::abs(curvature(1.05 * square_pair_spacing)), 0.05);
  EXPECT_LT(cage().nonuniformity(0.2), 0.01);
  EXPECT_GT(cage().nonuniformity(0.6), cage().nonuniformity(0.2));
}

// Kepler: the field comes back after one period only for a non-rotating Earth; over the poles of a
// polar orbit its size is twice that at the equator, and its extremes are those of IGRF.
TEST(OrbitField, HasTheSizeOfTheFieldAtThatHeight) {
  const CircularOrbit polar{.radius_m = 6871.2e3, .inclination_rad = pi / 2};
  const double period_s = 2 * pi * std::sqrt(std::pow(6871.2e3, 3) / earth_gravitation_m3_s2);
  EXPECT_NEAR(period_s, 5668, 5);
  const TimeSeries field_T = orbit_field_T(polar, 2026.0, period_s, 10.0);
  double least = 1, most = 0;
  for (double t = 0; t < period_s; t += 10) {
    least = std::min(least, field_T.at(t).norm());
    most = std::max(most, field_T.at(t).norm());
  }
  EXPECT_GT(least, 1.7e-5);
  EXPECT_LT(most, 5.5e-5);
  EXPECT_GT(most / least, 1.7);
}

// Starting over the equator at the zero meridian, east, north and down are y, z and −x.
TEST(OrbitField, AxesAreInertial) {
  const CircularOrbit orbit{.radius_m = 6871.2e3, .inclination_rad = 0.9};
  const Vec3 ned_T =
      GeomagneticModel(2026.0).north_east_down_T(GeocentricPosition{6871.2e3, pi / 2, 0.0});
  const Vec3 start_T = orbit_field_T(orbit, 2026.0, 100, 10).at(0.0);
  EXPECT_LT((start_T - Vec3(-ned_T.z(), ned_T.y(), ned_T.x())).norm(), 1e-15);
}

}  // namespace
}  // namespace photorque
