// CCSDS messages as input: orbits (OEM) and initial attitudes (APM).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <string>

#include "attitude/disturbances/fields/coil_cage.h"
#include "attitude/environment/environment.h"
#include "attitude/recordings/apm.h"
#include "attitude/recordings/oem.h"
#include "core/constants.h"
#include "core/errors.h"
#include "core/files.h"
#include "tests/attitude/disturbance_bench.h"
#include "tests/files.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

using Path = std::function<std::array<Vec3, 2>(double)>;  // position [m], velocity [m/s]

struct OemOptions {
  std::string frame = "EME2000", time_system = "UTC", interpolation = "";
  std::string start = "2026-03-01T00:00:00";
  bool xml = false;
};

std::string oem_text(const Path& path, double duration_s, double interval_s,
                     const OemOptions& options = {}) {
  const Epoch start = *parse_epoch(options.start);
  const std::string stop = epoch_text(start.after(duration_s));
  std::string rows;
  for (double t_s = 0.0; t_s < duration_s + 0.5 * interval_s; t_s += interval_s) {
    const auto [r, v] = path(t_s);
    const std::string epoch = epoch_text(start.after(t_s));
    char row[400];
    const char* format =
        options.xml ? "<stateVector><EPOCH>%s</EPOCH><X units=\"km\">%.12g</X><Y>%.12g</Y><Z>%.12g"
                      "</Z><X_DOT>%.12g</X_DOT><Y_DOT>%.12g</Y_DOT><Z_DOT>%.12g</Z_DOT>"
                      "</stateVector>\n"
                    : "%s %.12g %.12g %.12g %.12g %.12g %.12g\n";
    std::snprintf(row, sizeof row, format, epoch.c_str(), r.x() / 1e3, r.y() / 1e3, r.z() / 1e3,
                  v.x() / 1e3, v.y() / 1e3, v.z() / 1e3);
    rows += row;
  }
  if (options.xml) {
    return "<?xml version=\"1.0\"?>\n<oem id=\"CCSDS_OEM_VERS\" version=\"2.0\"><header/><body>"
           "<segment><metadata><OBJECT_NAME>A</OBJECT_NAME><OBJECT_ID>B</OBJECT_ID>"
           "<CENTER_NAME>EARTH</CENTER_NAME><REF_FRAME>" +
           options.frame + "</REF_FRAME><TIME_SYSTEM>" + options.time_system +
           "</TIME_SYSTEM><START_TIME>" + options.start + "</START_TIME><STOP_TIME>" + stop +
           "</STOP_TIME></metadata><data>\n" + rows + "</data></segment></body></oem>\n";
  }
  return "CCSDS_OEM_VERS = 2.0\nCREATION_DATE = 2026-01-01T00:00:00\nORIGINATOR = TEST\n"
         "META_START\nOBJECT_NAME = A\nOBJECT_ID = B\nCENTER_NAME = Earth\nREF_FRAME = " +
         options.frame + "\nTIME_SYSTEM = " + options.time_system +
         "\nSTART_TIME = " + options.start + "\nSTOP_TIME = " + stop + "\n" +
         options.interpolation + "META_STOP\n\nCOMMENT states\n" + rows;
}

OrbitEphemeris orbit_of(const std::string& message) {
  return OrbitEphemeris(new_file(message));
}

// Kepler's ellipse in closed form, except for the iteration of the eccentric anomaly.
std::array<Vec3, 2> ellipse(double time_s) {
  constexpr double mu = 3.986004418e14, a_m = 8e6, e = 0.15;
  const double n = std::sqrt(mu / (a_m * a_m * a_m)), mean = 0.4 + n * time_s;
  double anomaly = mean;
  for (int i = 0; i < 50; ++i) anomaly = mean + e * std::sin(anomaly);
  const double b = std::sqrt(1.0 - e * e), rate = n / (1.0 - e * std::cos(anomaly));
  const Mat3 turn = turned(1.1, {1, 2, 3}).toRotationMatrix();
  return {turn * (a_m * Vec3(std::cos(anomaly) - e, b * std::sin(anomaly), 0)),
          turn * (a_m * rate * Vec3(-std::sin(anomaly), b * std::cos(anomaly), 0))};
}

double largest_error_m(const OrbitEphemeris& orbit) {
  double largest = 0.0;
  for (double t_s = 0.0; t_s <= orbit.duration_s(); t_s += 37.0) {
    largest = std::max(largest, (orbit.at(t_s)[0] - ellipse(t_s)[0]).norm());
  }
  return largest;
}

// States 240 s apart, like those of the ISS that NASA publishes. The error of Hermite's polynomial
// of degree 7 is f⁽⁸⁾/8! times the product of the squared distances to the states. With 0.21 rad
// between states it is 2e-9 of the distance in the middle of the ephemeris and 3e-8, a quarter of a
// metre, near its ends.
TEST(OrbitMessage, IsInterpolatedAsItStates) {
  for (const auto& [interpolation, largest_m] :
       std::initializer_list<std::pair<const char*, double>>{
           {"", 0.5},
           {"INTERPOLATION = HERMITE\nINTERPOLATION_DEGREE = 7\n", 0.5},
           {"INTERPOLATION = LAGRANGE\nINTERPOLATION_DEGREE = 9\n", 30.0}}) {
    const OrbitEphemeris orbit =
        orbit_of(oem_text(ellipse, 9600.0, 240.0, {.interpolation = interpolation}));
    EXPECT_EQ(orbit.duration_s(), 9600.0);
    EXPECT_EQ(epoch_text(orbit.start()), "2026-03-01T00:00:00.000000");
    EXPECT_LT(largest_error_m(orbit), largest_m) << interpolation;
    const Vec3 velocity_m_s = orbit.at(5000.0)[1];
    EXPECT_LT((velocity_m_s - ellipse(5000.0)[1]).norm(), 1e-3 * velocity_m_s.norm());
  }
  const OrbitEphemeris linear =
      orbit_of(oem_text(ellipse, 600.0, 10.0, {.interpolation = "INTERPOLATION = LINEAR\n"}));
  const Vec3 middle_m = 0.5 * (ellipse(100.0)[0] + ellipse(110.0)[0]);
  EXPECT_LT((linear.at(105.0)[0] - middle_m).norm(), 1e-3);
}

TEST(OrbitMessage, KvnAndXmlHoldTheSame) {
  const OrbitEphemeris kvn = orbit_of(oem_text(ellipse, 2400.0, 60.0)),
                       xml = orbit_of(oem_text(ellipse, 2400.0, 60.0, {.xml = true}));
  for (const double t_s : {0.0, 17.0, 1234.5, 2400.0}) {
    EXPECT_EQ(kvn.at(t_s)[0], xml.at(t_s)[0]);
  }
}

// Editors on Windows may begin files with a byte-order mark and end lines with two characters.
TEST(OrbitMessage, MarksOfEditorsAreNoWords) {
  const std::string text = oem_text(ellipse, 2400.0, 60.0);
  std::string edited = "\xef\xbb\xbf";
  for (const char c : text) edited += c == '\n' ? "\r\n" : std::string(1, c);
  EXPECT_EQ(orbit_of(edited).at(17.0)[0], orbit_of(text).at(17.0)[0]);
}

// Segments as after a manoeuvre, which no polynomial may cross, with covariances between them.
TEST(OrbitMessage, SegmentsFollowEachOther) {
  const auto turned_back = [](double t_s) {
    const auto [r, v] = ellipse(1200.0 - t_s);
    return std::array<Vec3, 2>{r, -v};
  };
  const std::string second = oem_text(turned_back, 1200.0, 60.0, {.start = "2026-03-01T00:20:00"});
  const std::string block = second.substr(second.find("META_START"));
  const std::string covariance =
      "COVARIANCE_START\nEPOCH = 2026-03-01T00:00:00\n1\n0 1\nCOVARIANCE_STOP\n";
  const OrbitEphemeris orbit = orbit_of(oem_text(ellipse, 1200.0, 60.0) + covariance + block);
  EXPECT_EQ(orbit.duration_s(), 2400.0);
  const std::string lower = replaced(block, "OBJECT_NAME = A", "OBJECT_NAME = a");
  EXPECT_EQ(orbit_of(oem_text(ellipse, 1200.0, 60.0) + lower).duration_s(), 2400.0);
  EXPECT_LT((orbit.at(1199.0)[0] - ellipse(1199.0)[0]).norm(), 0.1);
  EXPECT_LT((orbit.at(1199.0)[1] - ellipse(1199.0)[1]).norm(), 0.1);
  EXPECT_GT(orbit.at(1201.0)[1].dot(-ellipse(1200.0)[1]), 0.0);
  EXPECT_THROW(orbit_of(oem_text(ellipse, 1140.0, 60.0) + block), InputError);
}

// A geostationary satellite is at rest in ITRF and moves at 3.0747 km/s in inertial axes.
TEST(OrbitMessage, FramesThatTurnWithTheEarthBecomeInertial) {
  const auto file = new_file(oem_text(
      [](double) {
        return std::array<Vec3, 2>{Vec3(42164e3, 0, 0), Vec3(0, 0, 0)};
      },
      7200.0, 120.0, {.frame = "ITRF2014", .start = "2007-10-15T00:00:00"}));
  const OrbitEphemeris orbit(file);
  const auto [begin_m, velocity_m_s] = orbit.at(0.0);
  // The Earth rotation angle at MJD 54388 from the test of SOFA's iauEra00.
  EXPECT_NEAR(std::atan2(begin_m.y(), begin_m.x()), 0.4022837240028158102, 1e-12);
  EXPECT_NEAR(velocity_m_s.norm(), 3074.66, 0.05);
  const Vec3 hour_m = orbit.at(3600.0)[0];
  // 15.041 deg in an hour (360 deg in 86164.1 s).
  EXPECT_NEAR(std::acos(begin_m.dot(hour_m) / hour_m.squaredNorm()) / degree_rad, 15.041, 1e-3);
}

// GPS is ahead of UTC by 18 s since 2017, TAI by 37 s, TT by 69.184 s.
TEST(OrbitMessage, TimeSystemsAreConverted) {
  for (const auto& [system, start] : std::initializer_list<std::pair<const char*, const char*>>{
           {"UTC", "2026-03-01T00:00:00"},
           {"GPS", "2026-03-01T00:00:18"},
           {"TAI", "2026-03-01T00:00:37"},
           {"TT", "2026-03-01T00:01:09.184"}}) {
    const OrbitEphemeris orbit =
        orbit_of(oem_text(ellipse, 600.0, 60.0, {.time_system = system, .start = start}));
    EXPECT_EQ(epoch_text(orbit.start()), "2026-03-01T00:00:00.000000") << system;
  }
  // Around the leap second at the end of 2016, by IERS Bulletin C 52.
  EXPECT_EQ(epoch_text(*to_utc(*parse_epoch("2017-01-01T00:00:37"), "TAI")),
            "2017-01-01T00:00:00.000000");
  EXPECT_EQ(epoch_text(*to_utc(*parse_epoch("2017-01-01T00:00:35"), "TAI")),
            "2016-12-31T23:59:59.000000");
  EXPECT_FALSE(to_utc(*parse_epoch("2017-01-01T00:00:35"), "TCB"));
}

// Value of SOFA's test of iauGmst06, at MJD 53736.
TEST(EarthRotation, AgreesWithSofa) {
  EXPECT_NEAR(greenwich_sidereal_time_rad(*parse_epoch("2006-01-01T00:00:00")),
              1.754174971870091203, 1e-8);
}

TEST(OrbitMessage, UnsupportedFeaturesAreRejected) {
  const std::string good =
      oem_text(ellipse, 600.0, 60.0,
               {.interpolation = "INTERPOLATION = HERMITE\nINTERPOLATION_DEGREE = 7\n"});
  const auto right = new_file(good);
  EXPECT_NO_THROW(OrbitEphemeris{right});
  for (const auto& [from, to, word] :
       std::initializer_list<std::array<const char*, 3>>{{"Earth", "MARS", "EARTH"},
                                                         {"EME2000", "RTN", "ITRF"},
                                                         {"= UTC", "= TCB", "GPS"},
                                                         {"HERMITE", "CHEBYSHEV", "LAGRANGE"},
                                                         {"DEGREE = 7", "DEGREE = 99", "DEGREE"},
                                                         {"CCSDS_OEM_VERS", "CCSDS_X", "OEM"},
                                                         {"COMMENT states", "1 2 3", "km/s"},
                                                         {"META_STOP", "", "META_STOP"}}) {
    const auto file = new_file(replaced(good, from, to));
    const std::string refusal = refusal_of([&] { const OrbitEphemeris orbit(file); });
    EXPECT_THAT(refusal, testing::HasSubstr(word));
    EXPECT_THAT(refusal, testing::HasSubstr(file.string()));
  }
  // States an hour apart, about two per revolution, are too few for a polynomial.
  EXPECT_THROW(orbit_of(oem_text(ellipse, 14400.0, 3600.0)), InputError);
  // Numbers that are too small by a factor of 1000, so not in kilometres.
  const auto too_small = new_file(oem_text(
      [](double t_s) {
        const auto [r, v] = ellipse(t_s);
        return std::array<Vec3, 2>{Vec3(1e-3 * r), Vec3(1e-3 * v)};
      },
      600.0, 60.0));
  EXPECT_THROW(OrbitEphemeris{too_small}, InputError);
  EXPECT_THROW(OrbitEphemeris(right).at(1000.0), NumericalError);
}

// The gravity gradient torque 3μ/r³ u × J u on the ellipse, one hour after an epoch that is ten
// minutes after the first state.
TEST(Orbit, OfAnEphemerisHasTheGradientOfItsStates) {
  const auto file = new_file(oem_text(ellipse, 9600.0, 120.0));
  AttitudeModel model = bench_model();
  model.platform.inertia_kg_m2 = Vec3(10, 30, 25).asDiagonal();
  model =
      with(with(model, "orbit", "ephemeris = " + toml(file) + ", epoch = '2026-03-01T00:10:00'"),
           "gravity_gradient", {});
  const Quat attitude = turned(0.7, {1, -1, 2});
  const Vec3 position_m = ellipse(4200.0)[0], u = attitude.conjugate() * position_m.normalized();
  const Vec3 expected = 3.0 * 3.986004418e14 / std::pow(position_m.norm(), 3) *
                        u.cross(Vec3(10 * u.x(), 30 * u.y(), 25 * u.z()));
  const Vec3 found = torque_body_N_m(model, attitude, Vec3::Zero(), 3600.0);
  EXPECT_LT((found - expected).norm(), 1e-7 * expected.norm());
}

// States on a circle give the same field as the circle.
TEST(Orbit, OfStatesOnACircleIsTheCircle) {
  const CircularOrbit circle{.radius_m = 6871.2e3, .inclination_rad = 0.9, .phase_rad = 0.3};
  const double motion_rad_s = circle.motion_rad_s();
  const auto file = new_file(oem_text(
      [&](double t_s) {
        const double u = 0.3 + motion_rad_s * t_s;
        const Vec3 along = std::cos(u) * circle.ahead() - std::sin(u) * circle.node();
        return std::array<Vec3, 2>{circle.radius_m * circle.up(t_s),
                                   circle.radius_m * motion_rad_s * along};
      },
      6000.0, 60.0, {.start = "2007-10-15T00:00:00"}));
  const std::string sun = "date_year = 2025, sun_direction = [1, 0.2, 0.1]";
  const AttitudeModel stated =
                          with(bench_model(), "orbit",
                               "altitude_m = 500e3, inclination_rad = 0.9, phase_rad = 0.3, "
                               "greenwich_angle_rad = 0.4022837240028158, duration_s = 6000, " +
                                   sun),
                      read = with(bench_model(), "orbit", "ephemeris = " + toml(file) + ", " + sun);
  const auto at = [](const AttitudeModel& model, double t_s) {
    const AttitudeModel full = with(model, "magnetic_dipole", "dipole_A_m2 = [1, 2, 3]");
    return torque_body_N_m(full, Quat::Identity(), Vec3::Zero(), t_s);
  };
  for (const double t_s : {0.0, 777.0, 3210.0, 5990.0}) {
    EXPECT_LT((at(stated, t_s) - at(read, t_s)).norm(), 1e-6 * at(stated, t_s).norm()) << t_s;
  }
}

// Behind the Earth there is no light pressure. The Sun is that of the environment if the orbit has
// none.
TEST(Orbit, TakesTheSunOfTheEnvironment) {
  const auto pressure = [](const Vec3& sun, const std::string& further_keys) {
    AttitudeModel model = bench_model();
    model.environment.sun = SunPath::fixed(sun);
    model = with(model, "orbit", "altitude_m = 500e3, inclination_deg = 0" + further_keys);
    model = with(model, "radiation_pressure", "area_moment_m3 = [0, 0, 1]");
    return torque_body_N_m(model, Quat::Identity()).norm();
  };
  const double lit_N_m = pressure(Vec3::UnitX(), "");  // the satellite is on +x
  EXPECT_NEAR(lit_N_m, 1361.0 / 299792458.0, 0.01 * lit_N_m);
  EXPECT_EQ(pressure(-Vec3::UnitX(), ""), 0.0);
  EXPECT_EQ(pressure(Vec3::UnitX(), ", sun_direction = [-1, 0, 0]"), 0.0);
}

TEST(Orbit, KeysOfCircleAndEphemerisExcludeEachOther) {
  const auto file = new_file(oem_text(ellipse, 600.0, 60.0));
  const std::string states = "ephemeris = " + toml(file);
  EXPECT_THROW(make(bench_model(), "orbit", states + ", altitude_m = 5e5"), InputError);
  EXPECT_THROW(make(bench_model(), "orbit", states + ", epoch = '2026-03-02T00:00:00'"),
               InputError);
  EXPECT_THROW(make(bench_model(), "orbit", "inclination_deg = 50"), InputError);
}

// One state of a body that Orekit 12 wrote in three ways (its test messages of APM).
constexpr const char* head =
    "CCSDS_APM_VERS = 2.0\nCREATION_DATE = 2023-04-04T13:34:26\nORIGINATOR = TEST\n"
    "OBJECT_NAME = SAT\nOBJECT_ID = 2002-999Z\nTIME_SYSTEM = UTC\nEPOCH = 2008-04-07T00:00:00\n";
constexpr const char* frames = "REF_FRAME_A = EME2000\nREF_FRAME_B = SC_BODY_1\n";
constexpr const char* quaternion =
    "Q1 = -0.6447327809733585\nQ2 = -0.3463409538535587\nQ3 = -0.28613054916357517\n"
    "QC = 0.6184633325084984\n";
constexpr const char* quaternion_slope =
    "Q1_DOT = -1.3272033450196288E-4 [1/s]\nQ2_DOT = -3.2795194482559584E-4\n"
    "Q3_DOT = 3.464798547870986E-4\nQC_DOT = -1.6171349757177208E-4\n";
constexpr const char* angles =
    "EULER_ROT_SEQ = XYZ\nANGLE_1 = -94.09388961597182 [deg]\nANGLE_2 = -3.4078345850798306\n"
    "ANGLE_3 = -53.31530870930127\n";
constexpr const char* slopes =
    "ANGLE_1_DOT = -0.0460027198499188\nANGLE_2_DOT = -0.03813817285262154\n"
    "ANGLE_3_DOT = -0.0024435821811146495 [deg/s]\n";
const Vec3 orekit_rate_rad_s =
    degree_rad * Vec3(0.0031504176144069016, -0.0596101304816182, 2.9095159008651856e-4);
const Quat orekit_attitude(0.6184633325084984, -0.6447327809733585, -0.3463409538535587,
                           -0.28613054916357517);

std::string block(const std::string& name, const std::string& lines) {
  return name + "_START\n" + frames + lines + name + "_STOP\n";
}

TEST(AttitudeMessage, ThreeFormatsOfOrekitGiveOneState) {
  const std::string angular =
      block("ANGVEL",
            "ANGVEL_FRAME = SC_BODY_1\nANGVEL_X = 0.0031504176144069016\n"
            "ANGVEL_Y = -0.0596101304816182\nANGVEL_Z = 2.9095159008651856E-4\n");
  for (const std::string& text :
       {block("QUAT", quaternion) + angular,
        block("QUAT", std::string(quaternion) + quaternion_slope), block("EULER", angles) + angular,
        block("EULER", std::string(angles) + slopes)}) {
    const auto file = new_file(head + text);
    const AttitudeParameters read = read_apm(file);
    EXPECT_LT(read.lab_from_body.angularDistance(orekit_attitude), 1e-12);
    ASSERT_TRUE(read.rate_body_rad_s);
    EXPECT_LT((*read.rate_body_rad_s - orekit_rate_rad_s).norm(), 1e-12);
    EXPECT_EQ(epoch_text(read.epoch), "2008-04-07T00:00:00.000000");
  }
  const std::string unusable = replaced(block("QUAT", quaternion), "EME2000", "ITRF1997");
  const auto second = new_file(head + unusable + block("QUAT", quaternion)),
             after = new_file(head + unusable + block("EULER", angles)),
             none = new_file(head + unusable + replaced(unusable, "ITRF1997", "LVLH")),
             lower =
                 new_file(head + replaced(replaced(block("QUAT", quaternion), "EME2000", "eme2000"),
                                          "SC_BODY_1", "sc_body_1"));
  for (const auto& file : {second.string(), after.string(), lower.string()}) {
    EXPECT_LT(read_apm(file).lab_from_body.angularDistance(orekit_attitude), 1e-12);
  }
  EXPECT_THAT(refusal_of([&] { read_apm(none); }), testing::HasSubstr("\"ITRF1997\""));
  const auto still = new_file(head + block("QUAT", quaternion));
  EXPECT_FALSE(read_apm(still).rate_body_rad_s);
}

TEST(AttitudeMessage, XmlOfBothVersions) {
  const auto xml = [](const std::string& version, const std::string& data) {
    return "<?xml version=\"1.0\"?>\n<apm id=\"CCSDS_APM_VERS\" version=\"" + version +
           "\"><header/><body><segment><metadata><TIME_SYSTEM>TAI</TIME_SYSTEM></metadata><data>" +
           data + "</data></segment></body></apm>\n";
  };
  const std::string four = "<quaternion><Q1>0.6</Q1><Q2>0</Q2><Q3>0</Q3><QC>0.8</QC></quaternion>";
  const auto second = new_file(xml(
      "2.0",
      "<EPOCH>2023-01-01T00:00:37</EPOCH><quaternionState><REF_FRAME_A>GCRF</REF_FRAME_A>"
      "<REF_FRAME_B>SC_BODY</REF_FRAME_B>" +
          four +
          "</quaternionState><angularVelocity>"
          "<REF_FRAME_A>GCRF</REF_FRAME_A><REF_FRAME_B>SC_BODY</REF_FRAME_B><ANGVEL_FRAME>GCRF"
          "</ANGVEL_FRAME><ANGVEL_X units=\"deg/s\">0</ANGVEL_X><ANGVEL_Y>90</ANGVEL_Y><ANGVEL_Z>0"
          "</ANGVEL_Z></angularVelocity>"));
  const AttitudeParameters of_second = read_apm(second);
  EXPECT_LT(of_second.lab_from_body.angularDistance(Quat(0.8, 0.6, 0, 0)), 1e-15);
  EXPECT_EQ(epoch_text(of_second.epoch), "2023-01-01T00:00:00.000000");
  // About lab y; body z is lab y turned back by the 73.74 deg about x whose cosine is 0.28.
  EXPECT_LT((*of_second.rate_body_rad_s - 0.5 * pi * Vec3(0, 0.28, -0.96)).norm(), 1e-14);
  const auto first =
      new_file(xml("1.0",
                   "<quaternionState><EPOCH>2023-01-01T00:00:37</EPOCH><Q_FRAME_A>SC_BODY_1"
                   "</Q_FRAME_A><Q_FRAME_B>EME2000</Q_FRAME_B><Q_DIR>A2B</Q_DIR>" +
                       four + "</quaternionState>"));
  EXPECT_LT(read_apm(first).lab_from_body.angularDistance(Quat(0.8, -0.6, 0, 0)), 1e-15);
  const auto euler = new_file(
      xml("1.0",
          "<eulerElementsThree><EPOCH>2023-01-01T00:00:00</EPOCH><EULER_FRAME_A>EME2000"
          "</EULER_FRAME_A><EULER_FRAME_B>SC_BODY_1</EULER_FRAME_B><EULER_DIR>A2B"
          "</EULER_DIR><EULER_ROT_SEQ>312</EULER_ROT_SEQ><rotationAngles><rotation1 "
          "angle=\"Z_ANGLE\">90</rotation1><rotation2 angle=\"X_ANGLE\">90</rotation2>"
          "<rotation3 angle=\"Y_ANGLE\">0</rotation3></rotationAngles></eulerElementsThree>"));
  const Quat expected = turned(0.5 * pi, Vec3::UnitZ()) * turned(0.5 * pi, Vec3::UnitX());
  EXPECT_LT(read_apm(euler).lab_from_body.angularDistance(expected), 1e-14);
}

TEST(AttitudeMessage, UnsupportedFeaturesAreRejected) {
  const auto spin = new_file(head + block("SPIN", "SPIN_ALPHA = 24.8\nSPIN_DELTA = 33.7\n"));
  EXPECT_THROW(read_apm(spin), InputError);
  const std::string good = head + block("QUAT", quaternion);
  const auto right = new_file(good);
  EXPECT_NO_THROW(read_apm(right));
  for (const auto& [from, to, word] :
       std::initializer_list<std::array<const char*, 3>>{{"EME2000", "ITRF-97", "inertial"},
                                                         {"EME2000", "LVLH", "inertial"},
                                                         {"EME2000", "SC_BODY_2", "space"},
                                                         {"= UTC", "= TCB", "GPS"},
                                                         {"Q1 = -0.6", "Q1 = -0.9", "norm"},
                                                         {"QC = 0.6184633325084984\n", "", "QC"},
                                                         {"CCSDS_APM_VERS", "CCSDS_X", "APM"}}) {
    const auto file = new_file(replaced(good, from, to));
    EXPECT_THAT(refusal_of([&] { read_apm(file); }), testing::HasSubstr(word)) << to;
  }
}

}  // namespace
}  // namespace photorque
