// Current loops, and the field along an orbit.
#include <gtest/gtest.h>

#include <cmath>

#include "attitude/disturbances/fields/coil_cage.h"
#include "core/constants.h"
#include "core/errors.h"
#include "tests/attitude/settings_bench.h"

namespace photorque {
namespace {

TEST(CurrentLoop, AreaOfAPolygonDoesNotDependOnTheOrigin) {
  const std::vector<Vec3> here = {{0, 0, 0}, {0.3, 0, 0}, {0.3, 0.2, 0}, {0, 0.2, 0}};
  std::vector<Vec3> there = here;
  for (Vec3& p : there) p += Vec3(5, -3, 2);
  EXPECT_LT((polygon_area_m2(here) - Vec3(0, 0, 0.06)).norm(), 1e-15);
  EXPECT_LT((polygon_area_m2(there) - Vec3(0, 0, 0.06)).norm(), 1e-13);
}

// Eq. 27 for a thin wire is ½ I ∮ r × dl, summed here over many short pieces.
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
      {settings_of("current_A = 2, turns = 10, area_m2 = [0, 0, 0.01]"),
       settings_of("current_A = -1, corners_m = [[0, 0, 0], [0, 1, 0], [0, 0, 1]]")});
  EXPECT_LT((dipole_A_m2(loops) - Vec3(-0.5, 0, 0.2)).norm(), 1e-15);
  const Settings two = settings_of("current_A = 1, corners_m = [[0, 0, 0], [0, 1, 0]]");
  EXPECT_THROW(read_current_loops({two}), InputError);
}

// At an altitude of 500 km a revolution takes 94.5 min. On a polar orbit the field over the poles
// is about twice that over the equator.
TEST(OrbitField, IsTwiceAsStrongOverThePolesInEveryRevolution) {
  const CircularOrbit polar{.radius_m = 6871.2e3, .inclination_rad = pi / 2};
  const double period_s = 2 * pi / polar.motion_rad_s();
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

// At the start, over the equator at the zero meridian, east, north and down are y, z and −x.
TEST(OrbitField, AxesAreInertial) {
  const CircularOrbit orbit{.radius_m = 6871.2e3, .inclination_rad = 0.9};
  const Vec3 ned_T =
      GeomagneticModel(2026.0).north_east_down_T(GeocentricPosition{6871.2e3, pi / 2, 0.0});
  const Vec3 start_T = orbit_field_T(orbit, 2026.0, 100, 10).at(0.0);
  EXPECT_LT((start_T - Vec3(-ned_T.z(), ned_T.y(), ned_T.x())).norm(), 1e-15);
}

}  // namespace
}  // namespace photorque
