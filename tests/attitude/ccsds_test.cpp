#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>

#include "attitude/environment/epoch.h"
#include "attitude/recordings/aem.h"
#include "attitude/recordings/apm.h"
#include "attitude/recordings/recording.h"
#include "core/errors.h"
#include "core/text/parse.h"
#include "tests/files.h"
#include "tests/outside.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

std::filesystem::path shared_message(const std::string& name) {
  return outside::third_party("ccsds") / name;
}

constexpr const char* small_aem =
    "CCSDS_AEM_VERS = 1.0\nCREATION_DATE = 2020-01-01T00:00:00\nORIGINATOR = TEST\n"
    "META_START\nOBJECT_NAME = A\nOBJECT_ID = B\nREF_FRAME_A = LAB\nREF_FRAME_B = SC_BODY_1\n"
    "ATTITUDE_DIR = A2B\nTIME_SYSTEM = UTC\nSTART_TIME = 2020-01-01T00:00:00\n"
    "STOP_TIME = 2020-01-01T00:00:01\nATTITUDE_TYPE = QUATERNION\nQUATERNION_TYPE = FIRST\n"
    "META_STOP\nDATA_START\n2020-01-01T00:00:00 1 0 0 0\n2020-001T00:00:01.5 0 1 0 0\nDATA_STOP\n";

// GMAT wrote the same attitude as quaternions (scalar last) and as Euler angles 321.
TEST(Aem, QuaternionAndEulerFilesHoldTheSameAttitude) {
  PHOTORQUE_NEEDS_THIRD_PARTY("ccsds");
  const auto quaternion_path = shared_message("CCSDS_BasicQuatFile.aem");
  const auto by_time = [](const std::filesystem::path& path) {
    std::map<double, Quat> attitudes;
    for (const AemAttitude& row : read_aem(path).rows) attitudes[row.time_s] = row.lab_from_body;
    return attitudes;
  };
  const auto quaternions = by_time(quaternion_path);
  int compared = 0;
  for (const auto& [time_s, attitude] : by_time(shared_message("CCSDS_BasicEulerFile.aem"))) {
    const auto same = quaternions.find(time_s);
    if (same == quaternions.end()) continue;
    EXPECT_GT(std::abs(same->second.dot(attitude)), 1.0 - 1e-14) << time_s;
    ++compared;
  }
  EXPECT_EQ(compared, 122);
}

// The first attitude of these files, as published.
TEST(Aem, EulerSequenceAgreesWithThePublishedQuaternion) {
  const std::string euler =
      replaced(replaced(replaced(replaced(small_aem, "QUATERNION\n", "EULER_ANGLE\n"),
                                 "QUATERNION_TYPE = FIRST", "EULER_ROT_SEQ = 321"),
                        "1 0 0 0", "35.4540963916258 -15.74726604135554 18.80387738364443"),
               "0 1 0 0", "0 0 0");
  const auto file = new_file(euler);
  const Quat q = read_aem(file).rows.front().lab_from_body;
  const Quat published(0.9240493645517975, 0.1952861484651402, -0.07946016321668915,
                       0.3188764252036319);
  // The angles are published to 5e-14 deg, the quaternion to 1e-16.
  EXPECT_LT(q.angularDistance(published), 1e-14);
}

// One attitude in two notations, from the example of CCSDS 504.0-B-2 with the spacecraft MMS. It
// rotates about its z axis at 18.29 deg/s, that is by 182.9 deg in the ten seconds between the
// rows.
TEST(Aem, Version2HasQuaternionsAndEulerAnglesWithRates) {
  const auto message = [](const std::string& type, const std::string& rows) {
    return "CCSDS_AEM_VERS = 2.0\nCREATION_DATE = 2023-02-14T12:00:00\nORIGINATOR = GSFC\n"
           "MESSAGE_ID = A000006\nMETA_START\nOBJECT_NAME = MMS\nOBJECT_ID = 2015-011A\n"
           "CENTER_NAME = EARTH\nREF_FRAME_A = EME2000\nREF_FRAME_B = SC_BODY_1\n"
           "TIME_SYSTEM = TAI\nSTART_TIME = 2023-054T00:00:09.150001\n"
           "STOP_TIME = 2023-054T00:00:19.150001\nATTITUDE_TYPE = " +
           type + "\nANGVEL_FRAME = SC_BODY_1\nMETA_STOP\nDATA_START\n" + rows + "DATA_STOP\n";
  };
  const auto quaternions = new_file(message(
      "QUATERNION/ANGVEL",
      "2023-054T00:00:09.150001 0.056482 0.209807 -0.912091 0.347679 -0.021029 0.023643 18.288407\n"
      "2023-054T00:00:19.150001 0.208972 -0.060605 0.371436 0.902603 -0.019288 0.021817 "
      "18.291279\n"));
  const auto angles = new_file(message(
      "EULER_ANGLE/ANGVEL\nEULER_ROT_SEQ = ZXZ",
      "2023-054T00:00:09.150001 5.798977 25.098268 -144.066452 -0.021029 0.023643 18.288407\n"
      "2023-054T00:00:19.150001 6.194963 25.134202 38.541023 -0.019288 0.021817 18.291279\n"));
  const auto by_quaternions = read_aem(quaternions).rows;
  const auto by_angles = read_aem(angles).rows;
  ASSERT_EQ(by_quaternions.size(), 2u);
  ASSERT_EQ(by_angles.size(), 2u);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_LT(by_quaternions[i].lab_from_body.angularDistance(by_angles[i].lab_from_body), 1e-5);
    EXPECT_EQ(by_quaternions[i].rate_body_rad_s, by_angles[i].rate_body_rad_s);
  }
  EXPECT_NEAR(by_angles[1].time_s, 10.0, 1e-6);
  ASSERT_TRUE(by_angles[0].rate_body_rad_s);
  // Rotated for ten seconds at the printed rate. The nutation is half a degree.
  const Quat turned =
      by_angles[0].lab_from_body *
      Quat(Eigen::AngleAxisd(10.0 * by_angles[0].rate_body_rad_s->z(), Vec3::UnitZ()));
  EXPECT_LT(turned.angularDistance(by_angles[1].lab_from_body), 0.01);
  const Recording recording = read_recording(quaternions);
  ASSERT_NE(recording.find("gyro_z_rad_s"), nullptr);
  EXPECT_DOUBLE_EQ(recording.find("gyro_z_rad_s")->values[0], 18.288407 * degree_rad);
  // A rate in the axes of the other frame is rotated to body axes by the attitude.
  const auto inertial = new_file(replaced(
      message("EULER_ANGLE/ANGVEL\nEULER_ROT_SEQ = ZXZ", "2023-054T00:00:09.150001 0 90 0 1 2 3\n"),
      "ANGVEL_FRAME = SC_BODY_1", "ANGVEL_FRAME = EME2000"));
  const auto about_x = read_aem(inertial).rows;
  EXPECT_LT((*about_x[0].rate_body_rad_s - degree_rad * Vec3(1, 3, -2)).norm(), 1e-15);
  // A frame may be named by its keyword. A third frame is refused.
  const std::string text = file_text(inertial);
  const auto by_keyword =
                 new_file(replaced(text, "FRAME = EME2000\nMETA", "FRAME = REF_FRAME_A\nMETA")),
             by_other =
                 new_file(replaced(text, "FRAME = EME2000\nMETA", "FRAME = ref_frame_b\nMETA")),
             third = new_file(replaced(text, "FRAME = EME2000\nMETA", "FRAME = ITRF-97\nMETA"));
  EXPECT_EQ(read_aem(by_keyword).rows[0].rate_body_rad_s, about_x[0].rate_body_rad_s);
  EXPECT_EQ(read_aem(by_other).rows[0].rate_body_rad_s, degree_rad * Vec3(1, 2, 3));
  EXPECT_THAT(
      refusal_of([&] { read_aem(third); }),
      testing::HasSubstr("ANGVEL_FRAME: found \"ITRF-97\", expected one of the two frames"));
  const auto spin = new_file(message("SPIN", "2023-054T00:00:09.150001 1 2 3 4\n"));
  EXPECT_THROW(read_aem(spin), InputError);
}

// In XML the order of a quaternion's numbers is free.
TEST(Aem, XmlAndKeywordsAgree) {
  const auto xml = new_file(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<aem id=\"CCSDS_AEM_VERS\" version=\"1.0\">\n"
      "<header><CREATION_DATE>2020-01-01T00:00:00</CREATION_DATE>"
      "<ORIGINATOR>TEST</ORIGINATOR></header>\n<body><segment><metadata>"
      "<COMMENT>none</COMMENT><OBJECT_NAME>A</OBJECT_NAME><OBJECT_ID>B</OBJECT_ID>"
      "<REF_FRAME_A>LAB</REF_FRAME_A><REF_FRAME_B>SC_BODY_1</REF_FRAME_B>"
      "<ATTITUDE_DIR>A2B</ATTITUDE_DIR><TIME_SYSTEM>UTC</TIME_SYSTEM>"
      "<START_TIME>2020-01-01T00:00:00</START_TIME><STOP_TIME>2020-01-01T00:00:01</STOP_TIME>"
      "<ATTITUDE_TYPE>QUATERNION/DERIVATIVE</ATTITUDE_TYPE>"
      "<QUATERNION_TYPE>FIRST</QUATERNION_TYPE></metadata>\n<data>\n"
      "<attitudeState><quaternionDerivative><EPOCH>2020-01-01T00:00:00</EPOCH>"
      "<quaternion><QC>0.8</QC><Q1>0</Q1><Q2>0.6</Q2><Q3>0</Q3></quaternion>"
      "<quaternionRate><QC_DOT units=\"1/s\">0</QC_DOT><Q1_DOT>0</Q1_DOT><Q2_DOT>0</Q2_DOT>"
      "<Q3_DOT>0</Q3_DOT></quaternionRate></quaternionDerivative></attitudeState>\n"
      "</data></segment></body></aem>\n");
  EXPECT_TRUE(is_aem(xml));
  const auto attitudes = read_aem(xml).rows;
  ASSERT_EQ(attitudes.size(), 1u);
  EXPECT_LT(attitudes[0].lab_from_body.angularDistance(Quat(0.8, 0, 0.6, 0)), 1e-15);
  EXPECT_EQ(attitudes[0].line, 6);
  const auto torn = new_file("<?xml version=\"1.0\"?>\n<aem version=\"1.0\">\n<header>\n");
  EXPECT_THROW(read_aem(torn), InputError);
  std::string rows = file_text(xml);
  const size_t row = rows.find("<quaternionDerivative>"), end = rows.find("</attitudeState>");
  const auto empty = new_file(rows.erase(row, end - row));
  EXPECT_THAT(refusal_of([&] { read_aem(empty); }), testing::HasSubstr(":6: found an empty row"));
  std::string names = file_text(xml);
  for (const char* name : {"LAB", "SC_BODY_1", "A2B", "QUATERNION/DERIVATIVE"}) {
    names = replaced(names, std::string(">") + name + "<", ">\n " + lower_case(name) + "\n<");
  }
  const auto lower = new_file(names);
  EXPECT_EQ(read_aem(lower).rows[0].lab_from_body.coeffs(), attitudes[0].lab_from_body.coeffs());
}

// Messages of other kinds are named, since advice for columns of a table would not help.
TEST(Aem, OtherMessagesAreNoRecordings) {
  const auto kvn = new_file("COMMENT none\nCCSDS_APM_VERS = 2.0\nORIGINATOR = TEST\n"),
             xml = new_file("<?xml version=\"1.0\"?>\n<opm version=\"1.0\"/>\n"),
             table = new_file("t_s,rate_rad_s\n0,1\n1,1\n");
  EXPECT_THAT(refusal_of([&] { read_recording(kvn); }),
              testing::HasSubstr("a CCSDS message APM, expected a recording: of CCSDS messages an "
                                 "attitude ephemeris (AEM)"));
  EXPECT_THAT(refusal_of([&] { read_recording(xml); }), testing::HasSubstr("a CCSDS message OPM"));
  EXPECT_FALSE(is_aem(table));
}

// A file may combine messages of several kinds. The one that is asked for is read.
TEST(Aem, IsReadFromACombinationOfMessages) {
  const std::string aem =
      "<aem id=\"CCSDS_AEM_VERS\" version=\"2.0\"><header><CREATION_DATE>2020</CREATION_DATE>"
      "<ORIGINATOR>TEST</ORIGINATOR></header><body><segment><metadata><OBJECT_NAME>A</OBJECT_NAME>"
      "<OBJECT_ID>B</OBJECT_ID><REF_FRAME_A>LAB</REF_FRAME_A><REF_FRAME_B>SC_BODY</REF_FRAME_B>"
      "<TIME_SYSTEM>UTC</TIME_SYSTEM><START_TIME>2020-01-01T00:00:00</START_TIME>"
      "<STOP_TIME>2020-01-01T00:00:00</STOP_TIME><ATTITUDE_TYPE>QUATERNION</ATTITUDE_TYPE>"
      "</metadata><data><attitudeState><quaternionEphemeris><EPOCH>2020-01-01T00:00:00</EPOCH>"
      "<quaternion><Q1>0</Q1><Q2>0.6</Q2><Q3>0</Q3><QC>0.8</QC></quaternion>"
      "</quaternionEphemeris></attitudeState></data></segment></body></aem>\n";
  const std::string apm =
      "<apm id=\"CCSDS_APM_VERS\" version=\"2.0\"><header/><body><segment><metadata><TIME_SYSTEM>"
      "UTC</TIME_SYSTEM></metadata><data><EPOCH>2020-01-01T00:00:00</EPOCH><quaternionState>"
      "<REF_FRAME_A>LAB</REF_FRAME_A><REF_FRAME_B>SC_BODY</REF_FRAME_B><quaternion><Q1>0.6</Q1>"
      "<Q2>0</Q2><Q3>0</Q3><QC>0.8</QC></quaternion></quaternionState></data></segment></body>"
      "</apm>\n";
  const auto both = new_file("<?xml version=\"1.0\"?>\n<ndm>" + aem + apm + "</ndm>\n"),
             twice = new_file("<?xml version=\"1.0\"?>\n<ndm>" + aem + aem + "</ndm>\n");
  EXPECT_EQ(read_aem(both).rows[0].lab_from_body.y(), 0.6);
  EXPECT_EQ(read_apm(both).lab_from_body.x(), 0.6);
  EXPECT_THAT(refusal_of([&] { read_aem(twice); }),
              testing::HasSubstr("<ndm> with several <aem>, expected one <aem>"));
  EXPECT_THAT(refusal_of([&] { read_apm(twice); }),
              testing::HasSubstr("<ndm> without an <apm>, expected one <apm>"));
}

// The book permits texts in all lower case, and blanks for underscores. 0.8 + 0.6 j as the rotation
// from the body to the inertial frame.
TEST(Aem, NamesMayBeInLowerCase) {
  const std::string upper =
      replaced(replaced(replaced(small_aem, "REF_FRAME_A = LAB", "REF_FRAME_A = SC_BODY_1"),
                        "REF_FRAME_B = SC_BODY_1", "REF_FRAME_B = EME2000"),
               "1 0 0 0", "0.8 0 0.6 0");
  std::string lower = upper;
  for (const char* name : {"= SC_BODY_1", "EME2000", "A2B", "= QUATERNION", "FIRST"}) {
    lower = replaced(lower, name, lower_case(name));
  }
  // Several programs leave the identifier of the object out.
  for (const std::string& text : {upper, lower, replaced(lower, "sc_body_1", "sc body 1"),
                                  replaced(upper, "OBJECT_ID = B\n", "")}) {
    const auto file = new_file(text);
    const Quat found = read_aem(file).rows[0].lab_from_body;
    EXPECT_LT(found.angularDistance(Quat(0.8, 0, -0.6, 0)), 1e-15) << found;
  }
}

// Names of the SANA registry of spacecraft body reference frames.
TEST(Aem, EveryFrameOfTheBodyIsKnown) {
  for (const std::string frame :
       {"ACC_1", "ACTUATOR_2", "AST_1", "CSS_11", "DSS_1", "ESA_1", "GYRO_FRAME_1", "IMU_FRAME_1",
        "INSTRUMENT_A", "MTA_1", "RW_3", "SA_1", "SC_BODY", "SENSOR_1", "STARTRACKER_2", "TAM_1"}) {
    const auto file = new_file(
        replaced(replaced(replaced(small_aem, "REF_FRAME_A = LAB", "REF_FRAME_A = " + frame),
                          "REF_FRAME_B = SC_BODY_1", "REF_FRAME_B = ICRF"),
                 "1 0 0 0", "0.8 0 0.6 0"));
    EXPECT_EQ(read_aem(file).rows[0].lab_from_body.y(), -0.6) << frame;
  }
}

TEST(Aem, OneFrameIsOfTheBodyAndTheOtherOneAtRest) {
  for (const char* frame : {"SC_BODY_2", "ITRF-97", "LVLH", "SAT_FRAME", "ESAT"}) {
    const auto file = new_file(replaced(small_aem, "= LAB", std::string("= ") + frame));
    EXPECT_THAT(refusal_of([&] { read_aem(file); }),
                testing::HasSubstr(":4: found the frames \"" + std::string(frame) +
                                   "\" and \"SC_BODY_1\", expected one of the body"));
  }
}

TEST(Aem, ObjectsAreComparedWithoutCaseAndUnderscores) {
  const std::string one = replaced(small_aem, "OBJECT_NAME = A", "OBJECT_NAME = MY SATELLITE");
  const std::string segment = one.substr(one.find("META_START"));
  const auto written = new_file(one + replaced(segment, "MY SATELLITE", "my_satellite")),
             other = new_file(one + replaced(segment, "MY SATELLITE", "your satellite"));
  EXPECT_EQ(read_aem(written).rows.size(), 4u);
  EXPECT_THAT(refusal_of([&] { read_aem(other); }), testing::HasSubstr("one object"));
}

TEST(Aem, ScalarFirstAndDirectionAreHeeded) {
  const auto a2b = new_file(small_aem);
  const auto samples = read_aem(a2b).rows;
  EXPECT_EQ(samples[0].lab_from_body.w(), 1.0);
  EXPECT_EQ(samples[1].lab_from_body.x(), 1.0);
  EXPECT_EQ(samples[1].time_s, 1.5);
  const auto b2a = new_file(replaced(small_aem, "A2B", "B2A"));
  EXPECT_EQ(read_aem(b2a).rows[1].lab_from_body.x(), -1.0);
}

TEST(Aem, APropagatedPlatformIsRecovered) {
  std::vector<PlatformState> states(3);
  for (size_t i = 0; i < states.size(); ++i) {
    states[i].time_s = 86399.5 * static_cast<double>(i);
    states[i].lab_from_body =
        Quat(Eigen::AngleAxisd(0.4 * static_cast<double>(i), Vec3(1, -2, 3).normalized()));
  }
  const auto file = new_file("");
  write_aem(file, states, "1999-12-31T00:00:00", "STASIS", "a test");
  const auto samples = read_aem(file).rows;
  ASSERT_EQ(samples.size(), states.size());
  for (size_t i = 0; i < states.size(); ++i) {
    EXPECT_NEAR(samples[i].time_s, states[i].time_s, 1e-6);
    EXPECT_LT(samples[i].lab_from_body.angularDistance(states[i].lab_from_body), 1e-15);
  }
}

TEST(Aem, WrongMessagesAreRefused) {
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"CCSDS_AEM_VERS = 1.0\n", ""},
           {"OBJECT_NAME = A\n", ""},
           {"OBJECT_NAME", "OBJECT_NOME"},
           {"ATTITUDE_DIR = A2B", "ATTITUDE_DIR = AB"},
           {"QUATERNION_TYPE = FIRST", "QUATERNION_TYPE = MIDDLE"},
           {"1 0 0 0", "1 0 0"},
           {"1 0 0 0", "1 0 0 x"},
           {"DATA_STOP", ""},
           {"META_STOP", "DATA_STOP"},
           // Among the rows, a name with or without
           // a value, and a block:
           {"DATA_STOP", "X =\nDATA_STOP"},
           {"DATA_STOP", "X = 2020-01-01T00:00:02 0 0 0 1\nDATA_STOP"},
           {"DATA_STOP", "A_START\nA_STOP\nDATA_STOP"}}) {
    const auto file = new_file(replaced(small_aem, from, to));
    EXPECT_THROW(read_aem(file), InputError) << from << " -> " << to;
  }
  const auto long_quaternion = new_file(replaced(small_aem, "1 0 0 0", "1 1 0 0"));
  EXPECT_THROW(read_aem(long_quaternion), InputError);
}

// A body that spins about z at 0.1 rad/s: q_z = sin(0.05 t). Rows with the scalar last or first,
// from the lab to the body or back, in one segment or in two that share an instant.
TEST(Aem, IsReadAsARecording) {
  constexpr int rows = 101;
  for (const bool first : {false, true}) {
    for (const bool from_body : {false, true}) {
      for (const bool inverse : {false, true}) {
        const std::string meta =
            std::string("META_START\nOBJECT_NAME = BODY\nOBJECT_ID = 2026-001A\n") +
            "CENTER_NAME = EARTH\nREF_FRAME_A = " + (from_body ? "SC_BODY_1" : "EME2000") +
            "\nREF_FRAME_B = " + (from_body ? "EME2000" : "SC_BODY_1") +
            "\nATTITUDE_DIR = " + (inverse ? "B2A" : "A2B") +
            "\nTIME_SYSTEM = UTC\nSTART_TIME = 2026-11-27T00:00:00\n" +
            "STOP_TIME = 2026-11-27T00:00:10\nATTITUDE_TYPE = QUATERNION\nQUATERNION_TYPE = " +
            (first ? "FIRST" : "LAST") + "\nMETA_STOP\nDATA_START\n";
        std::string text =
            "CCSDS_AEM_VERS = 1.0\nCREATION_DATE = 2026-11-27T00:00:00\nORIGINATOR = TEST\n" + meta;
        for (int i = 0; i < rows; ++i) {
          const double time_s = 0.1 * i, sign = from_body == inverse ? 1.0 : -1.0;
          char row[160];
          const double w = std::cos(0.05 * time_s), z = sign * std::sin(0.05 * time_s);
          std::snprintf(row, sizeof row, "2026-11-27T00:00:%04.1f %.15g %.15g %.15g %.15g\n",
                        time_s, first ? w : 0.0, 0.0, first ? 0.0 : z, first ? z : w);
          text += row;
          if (i == 40) text += "DATA_STOP\n" + meta + row;
        }
        const auto file = new_file(text + "DATA_STOP\n");
        const Recording recording = read_recording(file);
        ASSERT_EQ(recording.rows(), static_cast<size_t>(rows));
        EXPECT_EQ(recording.report.repeated_times, 1);
        for (size_t i = 0; i < recording.rows(); ++i) {
          EXPECT_NEAR(recording.time_s[i], 0.1 * static_cast<double>(i), 1e-9);
          EXPECT_NEAR(recording.find("q_z")->values[i], std::sin(0.05 * recording.time_s[i]), 1e-9);
          EXPECT_NEAR(recording.find("q_w")->values[i], std::cos(0.05 * recording.time_s[i]), 1e-9);
        }
      }
    }
  }
}

TEST(CalendarTimes, CountDaysAsTheCalendarDoes) {
  const auto at = [](const char* text) { return *parse_epoch(text); };
  EXPECT_EQ(at("1970-01-01T00:00:00").day, 0);
  EXPECT_EQ(at("2000-03-01T00:00:00").day - at("2000-02-28T00:00:00").day, 2);
  EXPECT_EQ(at("1900-03-01T00:00:00").day - at("1900-02-28T00:00:00").day, 1);
  // Day 60 of a leap year is 29 February.
  EXPECT_EQ(at("2024-060T06:30:00.25").seconds_since(at("2024-02-29T00:00:00Z")), 23400.25);
  EXPECT_EQ(epoch_text(at("1999-12-31T23:59:59.9999996")), "2000-01-01T00:00:00.000000");
  EXPECT_EQ(epoch_text(at("2016-12-31T23:59:59").after(2.5)), "2017-01-01T00:00:01.500000");
  for (const char* text : {"", "2000", "2000-13-01T00:00:00", "2001-02-29T00:00:00",
                           "2000-01-01T24:00:00", "2000-01-01T00:61:00", "2000-366",
                           "2001-366T00:00:00", "2000-01-01 00:00:00", "2000-01-01T00:00:0x"}) {
    EXPECT_FALSE(parse_epoch(text)) << text;
  }
}

}  // namespace
}  // namespace photorque
