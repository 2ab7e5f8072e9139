// The drag of the residual atmosphere on a spacecraft, from a table over the wind's directions.
#include <gtest/gtest.h>

#include <cmath>

#include "attitude/disturbances/fields/coil_cage.h"
#include "attitude/environment/thermosphere.h"
#include "core/errors.h"
#include "tests/attitude/disturbance_bench.h"
#include "tests/files.h"

namespace photorque {
namespace {

// The worked example of the table's source, which is exponential between its rows: 2.1219854e-14
// kg/m³ at 747.2119 km. Scale heights grow with altitude, so that a smooth curve lies below it.
// Source: D. A. Vallado, Fundamentals of Astrodynamics and Applications, 4th ed. (2013), example
// 8-4, p. 567.
TEST(Thermosphere, HasTheDensityOfThePublishedExample) {
  const Thermosphere atmosphere;
  const double density = atmosphere.at(747.2119e3)[0];
  EXPECT_LT(density, 2.1219854e-14);
  EXPECT_NEAR(density, 2.1219854e-14, 0.04 * 2.1219854e-14);
  EXPECT_NEAR(atmosphere.at(400e3)[0], 3.725e-12, 1e-24);
}

TEST(Thermosphere, SlopesAreDerivativesAndDensityFalls) {
  const Thermosphere atmosphere;
  for (double altitude_m = 105.5e3; altitude_m < 1.3e6; altitude_m += 7e3) {
    const auto [density, slope] = atmosphere.at(altitude_m);
    const double step_m = 1.0;
    const double difference =
        (atmosphere.at(altitude_m + step_m)[0] - atmosphere.at(altitude_m - step_m)[0]) / 2.0;
    EXPECT_NEAR(slope, difference, 1e-6 * std::abs(slope)) << altitude_m;
    EXPECT_LT(slope, 0.0);
    EXPECT_GT(density, 0.0);
  }
}

// Geodetic altitude of the poles and the equator; 45 deg of geocentric latitude lies at a radius of
// 6367.418 km of the ellipsoid.
TEST(Thermosphere, AltitudesAreAboveTheEllipsoid) {
  EXPECT_NEAR(ellipsoid_altitude_m<double>(Vec3(6378137.0 + 4e5, 0, 0)), 4e5, 1e-3);
  EXPECT_NEAR(ellipsoid_altitude_m<double>(Vec3(0, 0, 6356752.3 + 4e5)), 4e5, 1.0);
  const Vec3 middle = (6367417.7 + 4e5) * Vec3(0.5, 0.5, std::sqrt(0.5));
  EXPECT_NEAR(ellipsoid_altitude_m<double>(middle), 4e5, 100.0);
}

AttitudeModel in_orbit(double inclination_deg, double phase_deg) {
  return with(bench_model(), "orbit",
              "altitude_m = 400e3, inclination_deg = " + toml(inclination_deg) +
                  ", phase_deg = " + toml(phase_deg));
}

Vec3 drag_N_m(const AttitudeModel& in_orbit, const Quat& attitude, double time_s,
              const std::string& further_keys = "") {
  const AttitudeModel model =
      with(in_orbit, "aerodynamic_drag", "table = " + toml(sphere_table()) + further_keys);
  return torque_body_N_m(model, attitude, Vec3::Zero(), time_s);
}

// Along the equator the atmosphere turns with the orbit, and over the node of a polar orbit across
// it: 7.67 and 0.49 km/s.
TEST(AerodynamicDrag, TheAtmosphereTurnsWithTheEarth) {
  const double radius_m = 6371.2e3 + 400e3;
  const double orbit_m_s = std::sqrt(earth_gravitation_m3_s2 / radius_m);
  const double air_m_s = 2.0 * pi / 86164.0905 * radius_m;  // a sidereal day
  const double density = 4e-12;
  for (const auto& [inclination_deg, wind] :
       {std::pair{0.0, Vec3(0.0, orbit_m_s - air_m_s, 0.0)},
        std::pair{180.0, Vec3(0.0, -orbit_m_s - air_m_s, 0.0)},
        std::pair{90.0, Vec3(0.0, -air_m_s, orbit_m_s)}}) {
    const Quat attitude = turned(1.2, Vec3(1, -2, 3));
    const Vec3 expected = 0.5 * density * wind.squaredNorm() *
                          sphere_table_torque_N_m(attitude.inverse() * wind.normalized());
    const Vec3 found = drag_N_m(in_orbit(inclination_deg, 0.0), attitude, 0.0,
                                ", density_kg_m3 = " + toml(density));
    EXPECT_LT((found - expected).norm(), 1e-4 * expected.norm()) << inclination_deg;
    EXPECT_GT((found - 0.9 * expected).norm(), 0.05 * expected.norm());
  }
}

// A polar orbit of constant radius is 21.4 km higher above the flattened poles than above the
// equator, where the atmosphere is 1.4 times as dense.
TEST(AerodynamicDrag, TheMeanAtmosphereFollowsTheAltitude) {
  const Thermosphere atmosphere;
  const Quat attitude = turned(0.4, Vec3(0, 1, 1));
  const auto over_stated = [&](double phase_deg) {
    const AttitudeModel model = in_orbit(90.0, phase_deg);
    return drag_N_m(model, attitude, 0.0).norm() /
           drag_N_m(model, attitude, 0.0, ", density_kg_m3 = 1.0").norm();
  };
  EXPECT_NEAR(over_stated(0.0), atmosphere.at(6771.2e3 - 6378137.0)[0], 1e-3 * over_stated(0.0));
  EXPECT_NEAR(over_stated(90.0), atmosphere.at(6771.2e3 - 6356752.3)[0], 1e-3 * over_stated(90.0));
  EXPECT_GT(over_stated(0.0), 1.3 * over_stated(90.0));
}

TEST(AerodynamicDrag, ReadsADensityOverTime) {
  const auto path = test_file("density.csv", "t_s,density_kg_m3\n0,1e-12\n100,3e-12\n");
  const AttitudeModel model = in_orbit(51.0, 20.0);
  const Quat attitude = turned(0.4, Vec3(0, 1, 1));
  const Vec3 file = drag_N_m(model, attitude, 50.0, ", density_file = " + toml(path));
  const Vec3 number = drag_N_m(model, attitude, 50.0, ", density_kg_m3 = 2e-12");
  EXPECT_LT((file - number).norm(), 1e-12 * number.norm());
  EXPECT_THROW(
      drag_N_m(model, attitude, 50.0, ", density_file = " + toml(path) + ", density_kg_m3 = 1e-12"),
      InputError);
}

// On the ground there is no orbit.
TEST(AerodynamicDrag, NeedsAnOrbit) {
  EXPECT_EQ(drag_N_m(bench_model(), Quat::Identity(), 0.0).norm(), 0.0);
}

}  // namespace
}  // namespace photorque
