// Position and light pressure of the Sun.
#include "attitude/environment/sun.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "attitude/environment/environment.h"
#include "core/errors.h"
#include "scenes/experiment/toml.h"
#include "tests/attitude/disturbance_bench.h"
#include "tests/files.h"

namespace photorque {
namespace {

Environment environment_of(const std::string& toml) {
  const Settings settings(parse_toml(toml, "sun.toml"));
  Environment environment = read_environment(settings);
  settings.finish();
  return environment;
}

Vec3 sun_at(const std::string& toml, double time_s = 0.0) {
  return environment_of("[sun]\n" + toml).sun->at(time_s)[0];
}

double angle_deg(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) / degree_rad;
}

Vec3 ecliptic(double longitude_deg) {
  const double l = longitude_deg * degree_rad, obliquity = 23.4392911 * degree_rad;
  return {std::cos(l), std::sin(l) * std::cos(obliquity), std::sin(l) * std::sin(obliquity)};
}

// J. Meeus, Astronomical Algorithms (1998), example 25.b: on 1992 October 13.0 TD the Sun's
// longitude is 199.907272 deg for the equinox of date and 0.1009 deg more for that of J2000; R =
// 0.99760775.
TEST(Sun, StandsWhereTheAlmanacHasIt) {
  const Vec3 sun = sun_at("date = \"1992-10-13\"");
  EXPECT_LT(angle_deg(sun, ecliptic(199.907272 + 0.1009)), 0.02);
  EXPECT_NEAR(sun.norm(), 0.99760775, 1e-3);
  // Three days later: the daily motion is 0.9905 deg there (Kepler's second law).
  EXPECT_NEAR(angle_deg(sun, sun_at("date = \"1992-10-13\"", 3 * 86400.0)), 3 * 0.9905, 0.01);
}

// The distances at both ends of the long axis, half a period apart.
TEST(Sun, OrbitIsKepler) {
  const std::string orbit =
      "date = \"2020-01-01\"\norbit = { semi_major_axis_au = 1.5, eccentricity = 0.3, "
      "inclination_deg = 20, ascending_node_deg = 40, perihelion_deg = 70, mean_anomaly_deg = 0 }";
  const double year_s = 365.2568983 * 86400.0, half_s = 0.5 * std::pow(1.5, 1.5) * year_s;
  const Vec3 near = sun_at(orbit), far = sun_at(orbit, half_s);
  EXPECT_NEAR(near.norm(), 1.5 * 0.7, 1e-12);
  EXPECT_NEAR(far.norm(), 1.5 * 1.3, 1e-7);
  EXPECT_NEAR(angle_deg(near, far), 180.0, 1e-5);
  // The latitude b of the perihelion, opposite to the Sun: sin b = sin i sin ω.
  const double obliquity = 23.4392911 * degree_rad;
  const Vec3 pole(0.0, -std::sin(obliquity), std::cos(obliquity));
  EXPECT_NEAR(-near.normalized().dot(pole), std::sin(20 * degree_rad) * std::sin(70 * degree_rad),
              1e-12);
  // With an epoch one day before the date, the spacecraft is one day further.
  EXPECT_NEAR((sun_at(orbit + "\n", 86400.0) -
               sun_at("date = \"2020-01-02\"\norbit = { semi_major_axis_au = 1.5, eccentricity = "
                      "0.3, inclination_deg = 20, ascending_node_deg = 40, perihelion_deg = 70, "
                      "mean_anomaly_deg = 0, epoch = \"2020-01-01\" }"))
                  .norm(),
              0.0, 1e-12);
}

// Kepler's equation in the closed direction: from the eccentric anomaly to the time.
TEST(Sun, KeplersEquationHoldsForEveryEllipse) {
  for (const double eccentricity : {0.0, 0.0167, 0.29, 0.31, 0.7, 0.97, 0.9999}) {
    for (const double e_rad : {-3.1, -1.0, -1e-3, 0.0, 1e-6, 0.02, 0.5, 1.6, 3.0, 3.14}) {
      for (const double turns : {0.0, -3.0, 1000.0}) {
        HeliocentricOrbit orbit;
        orbit.eccentricity = eccentricity;
        orbit.mean_anomaly_rad = e_rad - eccentricity * std::sin(e_rad) + 2.0 * pi * turns;
        const auto seen = orbit.in_plane(0.0).position_au;
        // The mean anomaly is rounded to 1e-12 after a thousand turns. This error is multiplied by
        // dE/dM.
        const double rounding = 1e-15 + (turns != 0.0 ? 2e-12 : 4e-16);
        const double tolerance = 1e-15 + rounding / (1.0 - eccentricity * std::cos(e_rad));
        EXPECT_NEAR(seen[0][0], std::cos(e_rad) - eccentricity, tolerance) << eccentricity << e_rad;
        EXPECT_NEAR(seen[1][0], std::sqrt(1.0 - eccentricity * eccentricity) * std::sin(e_rad),
                    tolerance)
            << eccentricity << " " << e_rad;
      }
    }
  }
}

// Eight instants at once: each lane has a different anomaly.
TEST(Sun, KeplersEquationHoldsInEveryLane) {
  const double e_rad[] = {-3.0, -1.7, -0.4, -1e-4, 0.0, 0.3, 1.5, 2.9};
  for (const double eccentricity : {0.0167, 0.29, 0.6, 0.95}) {
    HeliocentricOrbit orbit;
    orbit.eccentricity = eccentricity;
    // Mean motion of Gauss's year, at 1 au.
    const double motion_rad_s = 0.01720209895 / 86400.0;
    Lanes times_s;
    for (int lane = 0; lane < Lanes::count; ++lane) {
      times_s.set(lane, (e_rad[lane] - eccentricity * std::sin(e_rad[lane])) / motion_rad_s);
    }
    const auto seen = orbit.in_plane(times_s).position_au;
    for (int lane = 0; lane < Lanes::count; ++lane) {
      const double tolerance = 4e-15 / (1.0 - eccentricity * std::cos(e_rad[lane]));
      EXPECT_NEAR(seen[0][lane], std::cos(e_rad[lane]) - eccentricity, tolerance) << lane;
      EXPECT_NEAR(seen[1][lane],
                  std::sqrt(1.0 - eccentricity * eccentricity) * std::sin(e_rad[lane]), tolerance)
          << lane;
    }
  }
}

TEST(Sun, SlopesAreThoseOfThePath) {
  const auto path = environment_of(
                        "[sun]\ndate = \"2015-04-27T03:00\"\npointing = { axis = \"x\", "
                        "right_ascension_deg = 130, declination_deg = 17, roll_deg = 30 }")
                        .sun;
  for (const double t_s : {0.0, 3e6, -2e7}) {
    const double step_s = 1000.0;
    const Vec3 difference = (path->at(t_s + step_s)[0] - path->at(t_s - step_s)[0]) / (2 * step_s);
    EXPECT_LT((path->at(t_s)[1] - difference).norm(), 1e-7 * difference.norm());
  }
}

// A lab axis that points to the vernal equinox, to the pole, and to the Sun itself.
TEST(Sun, PointingTurnsTheLab) {
  const auto lab = [](const char* pointing) {
    return sun_at(std::string("date = \"2000-01-01T12:00:00\"\npointing = ") + pointing);
  };
  const Vec3 sun = sun_at("date = \"2000-01-01T12:00:00\"");
  // With x towards the equinox and y towards the north pole, z is −y of the equator.
  const Vec3 a = lab("{ axis = \"x\", right_ascension_deg = 0, declination_deg = 0 }");
  EXPECT_NEAR((a - Vec3(sun.x(), sun.z(), -sun.y())).norm(), 0.0, 1e-14);
  // After a roll of 90 deg about x, y points to −y of the equator.
  const Vec3 b =
      lab("{ axis = \"x\", right_ascension_deg = 0, declination_deg = 0, roll_deg = 90 }");
  EXPECT_NEAR((b - Vec3(sun.x(), -sun.y(), -sun.z())).norm(), 0.0, 1e-14);
  const double right_ascension = std::atan2(sun.y(), sun.x()) / degree_rad,
               declination = std::asin(sun.z() / sun.norm()) / degree_rad;
  const Vec3 c = lab(("{ right_ascension_deg = " + std::to_string(right_ascension) +
                      ", declination_deg = " + std::to_string(declination) + " }")
                         .c_str());
  EXPECT_NEAR((c - Vec3(0, 0, sun.norm())).norm(), 0.0, 1e-7);
}

TEST(Sun, ComesFromATableToo) {
  std::ostringstream file;
  file << "t_s,sun_x,sun_y,sun_z\n";
  for (int i = 0; i <= 90; ++i) {
    const double a = i * degree_rad;
    file << 100 * i << ',' << 3 * std::cos(a) << ',' << 3 * std::sin(a) << ",0\n";
  }
  const auto path = test_file("sun.csv", file.str());
  const std::string toml = "table = '" + path.string() + "'\ndistance_au = 2";
  const Vec3 sun = sun_at(toml, 4550.0);
  EXPECT_NEAR(
      (sun - 2.0 * Vec3(std::cos(45.5 * degree_rad), std::sin(45.5 * degree_rad), 0)).norm(), 0.0,
      1e-5);
  write_file_whole(path, "t_s,sun_x,sun_y,sun_z\n0,1,0,0\n1,0,0,0\n2,0,1,0\n");
  EXPECT_THROW(sun_at("table = '" + path.string() + "'", 1.0), NumericalError);
  EXPECT_THROW(sun_at("direction = [1, 0, 0]\ndate = \"2020-01-01\""), InputError);
  EXPECT_THROW(sun_at("distance_au = 2"), InputError);
  EXPECT_THROW(sun_at("direction = [0, 0, 0]"), InputError);
  EXPECT_DOUBLE_EQ(sun_at("direction = [0, 1, 0]\ndistance_au = 9.54").y(), 9.54);
  const auto orbit = [](const std::string& key) {
    return sun_at(
        "date = \"2020-01-01\"\norbit = { semi_major_axis_au = 9.54, mean_anomaly_deg = 1, " + key +
        " }");
  };
  EXPECT_NEAR(orbit("eccentricity = 0").norm(), 9.54, 1e-12);
  EXPECT_THROW(
      sun_at("date = \"2020-01-01\"\norbit = { semi_major_axis_au = 1e-9, mean_anomaly_deg = 1 }"),
      InputError);
  EXPECT_THROW(orbit("perihelion_deg = 1e30"), InputError);
  EXPECT_THROW(sun_at("date = \"yesterday\""), InputError);
}

// The pressure is 1361 W/m² divided by the speed of light, and a quarter of it at 2 au. The torque
// is p s × a for a centre of pressure beside the centre of mass, and rotates with the body.
TEST(Sun, PressesBesideTheCentreOfMass) {
  AttitudeModel model = bench_model();
  model.environment = environment_of("[sun]\ndirection = [0, 5, 0]\ndistance_au = 2");
  model = with(model, "radiation_pressure", "area_moment_m3 = [0, 0, 0.5]");
  const double pressure_Pa = 1361.0 / 299792458.0 / 4.0;
  const Vec3 upright = torque_body_N_m(model, Quat::Identity());
  EXPECT_NEAR((upright - pressure_Pa * Vec3(0.5, 0, 0)).norm(), 0.0, 1e-18);
  // After a rotation by a about x, the Sun is at (0, cos a, −sin a) in the body.
  const double a = 0.4;
  const Vec3 leaning = torque_body_N_m(model, turned(a, Vec3::UnitX()));
  EXPECT_NEAR((leaning - pressure_Pa * Vec3(0.5 * std::cos(a), 0, 0)).norm(), 0.0, 1e-18);
  EXPECT_THROW(make(bench_model(), "radiation_pressure", "area_moment_m3 = [0, 0, 1]"), InputError);
}

}  // namespace
}  // namespace photorque
