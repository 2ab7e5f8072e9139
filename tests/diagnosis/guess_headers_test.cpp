// Headers as people and instruments write them: the channel of each column and the factor to SI.
// The factors are definitions: 180° = π rad, 1 rpm = 2π rad / 60 s, 1 rev/s = 2π rad/s.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>

#include "attitude/recordings/recording.h"
#include "core/constants.h"
#include "core/errors.h"
#include "core/settings/settings.h"
#include "core/text/format.h"
#include "diagnosis/guess/guess.h"
#include "diagnosis/light/module/diagnose.h"
#include "scenes/experiment/toml.h"
#include "tests/files.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class Headers : public testing::Test {
 protected:
  // Four columns of numbers, or as many as the header has between semicolons.
  fs::path table(const std::string& header) const {
    std::string text = header + "\n";
    const auto columns = 1 + std::ranges::count(header, ';');
    for (int i = 0; i < 30; ++i) {
      for (int k = 0; k < columns; ++k) {
        text += (k > 0 ? ";" : "") + std::to_string(k == 0 ? 0.1 * i : std::cos(0.7 * i) * k);
      }
      text += "\n";
    }
    return test_file("headers.csv", text);
  }
  std::vector<std::string> channels(const std::string& header) const {
    return channels_in(table(header));
  }
  static std::vector<std::string> channels_in(const fs::path& file) {
    std::vector<std::string> all;
    for (const GuessedColumn& c : guess_columns(file)) all.push_back(c.channel);
    return all;
  }
};

struct Meaning {
  const char* stem;
  double to_SI;
  std::vector<const char*> headers;
};

void expect_meaning(const Meaning& meaning, const char* header, const std::string& channel) {
  EXPECT_EQ(unit_of_key(channel).stem, meaning.stem) << header;
  EXPECT_NEAR(unit_of_key(channel).to_SI, meaning.to_SI, 1e-12) << header;
}

constexpr double turn = 2.0 * pi, degree = pi / 180.0;

TEST_F(Headers, OfAnglesAndRates) {
  // 0xb0: the degree sign of Latin-1.
  const Meaning table[] = {
      {"rate",
       1.0,
       {"Winkelgeschwindigkeit / rad/s", "vitesse angulaire (rad/s)", "ω (rad/s)", "ω / s⁻¹",
        "ω in rad·s⁻¹", "ω / (rad/s)", "θ̇ [rad/s]", "dθ/dt (rad/s)", "omega_s",
        "velocità angolare (rad/s)", "velocidad angular [rad/s]", "omega_rads"}},
      {"angle",
       degree,
       {"Winkel / °", "angolo (gradi)", "θ (deg)", "Ausschlag [°]", "hoek (graden)", "kąt [deg]",
        "α [°]", "Ángulo (grados)", "ângulo [graus]", "posición angular (°)",
        "position angulaire (degrés)", "Winkel in Grad", "phi(t) / °", "angleDeg",
        "Winkel [\xb0]"}},
      {"rate",
       turn / 60.0,
       {"Drehzahl [1/min]", "rpm", "w [1/min]", "n [1/min]", "n / min⁻¹", "wheel_rpm", "drum_rpm",
        "Drehzahl [U/min]", "Umdrehungen pro Minute", "revolutions per minute", "régime (tr/min)",
        "velocità di rotazione (giri/min)", "Velocidad de giro (rev/min)", "Speed RPM"}},
      {"angle",
       1.0,
       {"phi/rad", "Auslenkung (rad)", "Amplitude (rad)", "position (rad)", "Winkel phi_1 / rad"}},
      {"rate",
       turn,
       {"n / s⁻¹", "ω (Hz)", "speed (rev/s)", "Vitesse de rotation (tours/s)",
        "fréquence de rotation (tr/s)", "Spin rate (rps)"}},
      {"rate",
       degree,
       {"theta_dot (deg/s)", "velocidade angular (graus por segundo)", "angular rate (°/s)"}},
      {"rate_magnitude", 1.0, {"Absolute (rad/s)", "|ω| (rad/s)"}},
      {"angle", turn, {"angle (rev)", "encoder [turns]", "Drehwinkel in Umdrehungen"}},
      {"rate", 1e-3, {"rate_mrad_s", "omega (mrad/s)", "omega_mrads"}},
      {"gyro_x", 1e-3 * degree, {"gyro_x_mdps"}},
      {"angle", 1e-3 * degree, {"angle_mdeg"}},
      {"angle", 1e-6, {"Winkel (µrad)"}},
      {"gyro_x", 1.0, {"ωₓ (rad/s)"}},
      {"gyro_y", degree, {"ωᵧ [°/s]", "q (deg/s)"}},
      {"gyro_z", 1.0, {"ωᶻ (rad/s)"}},
      {"velocity_x", 1e-3, {"speed_mm_s"}},
      {"velocity_x", 1.0, {"v_m_s", "Geschwindigkeit (m/s)"}},
      {"angle", 1e-3, {"Drehwinkel φ / mrad"}},
      {"gyro_z",
       degree,
       {"Angular velocity around z-axis (deg/s)", "Gierrate [°/s]", "yaw (deg/s)"}},
      {"gyro_x", degree, {"GyroX [dps]"}},
      {"gyro_y", 1.0, {"rotation rate y (rad/s)", "wy"}},
      {"tilt", degree, {"Neigung (°)"}},
      {"roll", degree, {"Rollwinkel [°]"}},
      {"yaw", degree, {"heading (deg)"}},
      {"velocity_x", 1.0 / 3.6, {"speed km/h"}},
      {"velocity_y", 0.01, {"Vy (cm/s)"}},
      {"x", 0.01, {"Distance (cm)"}},
      {"x", 1e-3, {"Abstand / mm"}},
      {"x", 1.0, {"Position(m)"}},
      {"accel_x", 1.0, {"accX"}},
  };
  for (const Meaning& meaning : table) {
    for (const char* header : meaning.headers) {
      expect_meaning(meaning, header, channels(std::string("t_s;") + header).at(1));
    }
  }
}

TEST_F(Headers, OfTimes) {
  const Meaning table[] = {
      {"t",
       1.0,
       {"Zeit t / s", "t/s", "Time ( s )", "Tiempo [seg]", "Tempo (secondi)",
        "TimeSinceFirstFrame(s)", "tijd (s)"}},
      {"t", 60.0, {"t / min", "t [min]", "tempo em minutos", "vrijeme / min"}},
      {"t", 1e-3, {"Zeit/ms", "temps (ms)", "timeMs", "čas [ms]"}},
      {"t", 1e-6, {"Timestamp (µs)"}},
      {"t", 3600.0, {"Elapsed Time (h)"}},
  };
  for (const Meaning& meaning : table) {
    for (const char* header : meaning.headers) {
      expect_meaning(meaning, header, channels(header + std::string(";rate_rpm")).at(0));
    }
  }
}

// Units of another quantity, errors, targets, frequencies and other columns are no motion.
TEST_F(Headers, OfOtherQuantitiesAreNoMotion) {
  for (const char* header :
       {"Frequenz f / Hz", "FFT f_3 / rad", "angle error (deg)", "temperature (°C)",
        "Angular acceleration (rad/s²)", "Unsicherheit / rad", "dTime(s)", "Time step (s)",
        "d theta (deg)", "frame rate (1/s)"}) {
    EXPECT_EQ(channels(std::string("t_s;") + header).at(1), "") << header;
  }
}

// Channels of the program, in all units that its keys have, are themselves.
TEST_F(Headers, OfChannelsAreThoseChannels) {
  const std::pair<const char*, std::vector<const char*>> known[] = {
      {"angle", {"angle", "roll", "pitch", "yaw", "tilt"}},
      {"angular rate", {"rate", "gyro_x", "gyro_y", "gyro_z", "rate_magnitude"}},
      {"length", {"x", "y"}},
      {"speed", {"velocity_x", "velocity_y"}},
      {"acceleration", {"accel_z"}},
      {"magnetic field", {"mag_y"}}};
  for (const auto& [dimension, stems] : known) {
    for (const KeyUnit& unit : units_of(dimension)) {
      if (unit.unit == "au") continue;  // refused: also an arbitrary unit
      for (const char* stem : stems) {
        const std::string channel = std::string(stem) + "_" + unit.unit;
        EXPECT_EQ(channels("t_s;" + channel).at(1), channel);
      }
    }
  }
}

TEST_F(Headers, OfUnknownUnitsAreRefused) {
  for (const char* header : {"angle (gon)", "Encoder (counts)", "Winkel / Skt", "Winkel (rad/s)"}) {
    EXPECT_THAT(refusal_of([&] { channels(std::string("t_s;") + header); }),
                AllOf(HasSubstr("the unit"), HasSubstr("rad, mrad, deg (°)")))
        << header;
  }
  for (const char* header :
       {"speed (furlong)", "omega (deg)", "speed (1/s)", "ω [deg/min]", "rate_z_deg_min",
        "omega_rad_h", "rate_z_gon_s", "gyro_x_lsb", "rate (kHz)"}) {
    EXPECT_THAT(refusal_of([&] { channels(std::string("t_s;") + header); }),
                AllOf(HasSubstr("the unit"), HasSubstr("rpm (1/min")))
        << header;
  }
  EXPECT_THAT(refusal_of([&] { channels("time (days);rate_rpm"); }),
              HasSubstr("s, ms, µs, min or h"));
  // One column of the quantity in a known unit is enough.
  EXPECT_EQ(channels("t_s;angle (raw);angle (deg)").at(2), "angle_deg");
}

// A gain, a counter or a flag beside a motion is left out with a note. A gyro axis is not.
TEST_F(Headers, OfUnknownUnitsBesideAMotionAreLeftOut) {
  std::string text = "%t [ms]\tPosition [rad]\tDerivative Gain [Kd]\tSpeed flag [bool]\n";
  for (int i = 0; i < 40; ++i) text += printed("%d\t%.4f\t0.5\t1\n", 20 * i, 0.1 * i);
  const std::string guessed = guess_experiment({test_file("gains.txt", text)}, ".");
  EXPECT_THAT(guessed, AllOf(HasSubstr("CONFIRM: the column \"Derivative Gain [Kd]\" is left out"),
                             HasSubstr("angle_rad = \"Position [rad]\"")));
  EXPECT_THAT(refusal_of([&] { channels("t_s;gyro_x_rad_s;gyro_y [foo]"); }),
              HasSubstr("--columns t_s,gyro_x_rad_s,gyro_y_rad_s ("));
  EXPECT_THAT(refusal_of([&] { channels("t_s;lux;speed [Kd];flag"); }),
              AllOf(HasSubstr("the unit \"Kd\""),
                    HasSubstr("--columns t_s,column_2,rate_rad_s,column_4 (")));
}

TEST_F(Headers, StateTheirUnitOrAreMarked) {
  const auto columns = guess_columns(table("t / s;Winkel / °;Auslenkung 2;rate"));
  EXPECT_TRUE(columns[0].is_sure);
  EXPECT_TRUE(columns[1].is_sure);
  EXPECT_FALSE(columns[3].is_sure);
  EXPECT_FALSE(guess_columns(table("t_s;position (rad)"))[1].is_sure);
}

// Coordinates in pixels or millimetres would be of a table of hundreds of metres.
TEST_F(Headers, LargeCoordinatesWithoutAUnitAreMillimetres) {
  const auto names = [&](const std::string& rows) {
    return channels_in(test_file("place.csv", "t,x,y\n" + rows));
  };
  EXPECT_THAT(names("0,310,4\n0.1,312,5\n"), testing::ElementsAre("t_s", "x_mm", "y_mm"));
  EXPECT_THAT(names("0,0.31,0.4\n0.1,0.32,0.5\n"), testing::ElementsAre("t_s", "x_m", "y_m"));
}

// A swing over more than a turn, and an angle that starts again after 360, are in degrees.
TEST_F(Headers, AnglesWithoutAUnitThatReturnAreInDegrees) {
  const auto unit_of = [&](const std::function<double(int)>& angle) {
    std::string text = "Time,Angle\n";
    for (int i = 0; i < 100; ++i) text += std::to_string(i) + "," + std::to_string(angle(i)) + "\n";
    return channels_in(test_file("angle.csv", text)).at(1);
  };
  EXPECT_EQ(unit_of([](int i) { return 25.0 * std::cos(0.3 * i); }), "angle_deg");
  EXPECT_EQ(unit_of([](int i) { return std::fmod(31.0 * i, 360.0); }), "angle_deg");
  EXPECT_EQ(unit_of([](int i) { return 1.2 * std::cos(0.3 * i); }), "angle_rad");
  EXPECT_EQ(unit_of([](int i) { return 4.0 * i; }), "angle_rad");
}

TEST_F(Headers, NumbersAreAxesIfThereAreThree) {
  EXPECT_THAT(channels("t_s;gyroADC[0];gyroADC[1];gyroADC[2]"),
              testing::ElementsAre("t_s", "gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s"));
  EXPECT_EQ(channels("t_s;ω1 (rad/s)").at(1), "rate_rad_s");
}

// The guess reads the columns by the names of the file, in its units and bytes.
TEST_F(Headers, AreMappedByTheGuess) {
  const fs::path file = table("Zeit t / min;Winkel [\xb0]");
  const std::string toml = guess_experiment({file}, ".");
  EXPECT_THAT(
      toml, AllOf(HasSubstr("t_min = \"Zeit t / min\""), HasSubstr("angle_deg = \"Winkel [°]\"")));
  RecordingOptions options;
  options.columns = {{"t_min", "Zeit t / min"}, {"angle_deg", "Winkel [°]"}};
  const Recording recording = read_recording(file, options);
  EXPECT_NEAR(recording.time_s[1], 6.0, 1e-9);
  ASSERT_NE(recording.find("angle_rad"), nullptr);
  EXPECT_NEAR(recording.find("angle_rad")->values[0], degree, 1e-9);
}

// LOANA of ISFH: the names stand in lines, and a second voltage is beside the curve.
TEST_F(Headers, MayBeNumberedLines) {
  std::string rows;
  for (int i = 0; i <= 40; ++i) {
    rows += printed("%.4f\t%.5f\t25.03\t-2.67\n", 0.018 * i,
                    -0.158 * -std::expm1((0.018 * i - 0.7034) / 0.027));
  }
  const fs::path file =
      test_file("32_14.lgt",
                "[Sample]\nCell area:\t3.96\t[cm\xb2]\n[Measurement]\nLabel1:\tVoltage\t[V]\n"
                "Label2:\tCurrent\t[A]\nLabel3:\tTemperature\t[\xb0"
                "C]\nLabel4:\tMonitor\t[V]\n\n"
                "**Data**\n" +
                    rows);
  const std::string guessed = guess_experiment({file}, testing::TempDir());
  EXPECT_THAT(guessed,
              AllOf(HasSubstr("cells_in_series = 1\n"), HasSubstr("temperature_K = 298.18")));
  const Settings root(std::make_shared<const SettingsNode>(parse_toml(guessed, "guess.toml")));
  EXPECT_EQ(read_module(root, testing::TempDir()).references.at(0).rows(), 41u);
  // Such columns in a table, of which the voltage and the current are mapped.
  std::ranges::replace(rows, '\t', ',');
  EXPECT_THAT(guess_experiment({test_file("loana.csv",
                                          "Voltage (V),Current (A),Temperature (°C),"
                                          "Monitor (V)\n" +
                                              rows)},
                               testing::TempDir()),
              AllOf(HasSubstr("voltage_V = \"Voltage (V)\""), HasSubstr("temperature_K = 298.18")));
  std::string turning;
  for (int i = 0; i < 30; ++i) turning += printed("%.1f;%d\n", 0.1 * i, 1000 - i * i);
  EXPECT_THAT(channels_in(test_file("turning.txt",
                                    "Channel 1: Time (s)\nChannel 2: Speed (rpm)\n" + turning)),
              testing::ElementsAre("t_s", "rate_rpm"));
}

TEST_F(Headers, OfAMachineWithItsVoltageAreOfMotion) {
  std::string text = "t_s,rate_rpm,current_A,voltage_V\n";
  for (int i = 0; i < 60; ++i) {
    text += printed("%.2f,%.1f,0.5,12\n", 0.1 * i, 1000.0 * std::exp(-0.02 * i) + i % 2);
  }
  EXPECT_THAT(guess_experiment({test_file("motor.csv", text)}, "."), HasSubstr("one_axis"));
}

// A text beside the first row of numbers only.
TEST_F(Headers, RowsWithATextAreNoHeader) {
  std::string text = "run;t (s);phi (deg)\nfirst;0;10\n";
  for (int i = 1; i < 30; ++i) text += printed(";%.1f;%.3f\n", 0.1 * i, 10.0 * std::cos(0.3 * i));
  EXPECT_THAT(channels_in(test_file("texts.csv", text)),
              testing::ElementsAre("", "t_s", "angle_deg"));
}

TEST_F(Headers, OfNeitherMotionNorACurveStateTheNeededColumns) {
  for (const char* header : {"lux;voltage (V)", "R (cm);signal"}) {
    EXPECT_THAT(
        refusal_of([&] { guess_experiment({table(header)}, "."); }),
        AllOf(HasSubstr("u_m, v_m and irradiance_W_m2"), HasSubstr("one voltage and one current")))
        << header;
  }
}

TEST_F(Headers, AreAskedForWithACommandForAShell) {
  std::string rows;
  for (int i = 0; i < 30; ++i) {
    rows += std::to_string(1276228840 + 880000 * i) + ",1,2,3,4\n";
  }
  EXPECT_THAT(refusal_of([&] { guess_columns(test_file("Run (1) - it's.csv", rows)); }),
              AllOf(HasSubstr("it'\\''s.csv'"),
                    HasSubstr("--columns t_us,column_2,column_3,column_4,column_5")));
  EXPECT_THAT(refusal_of([&] {
                guess_columns(test_file("prose.txt", "Symmetric mode\n19.2\n0 1 2\n1 2 3\n"));
              }),
              AllOf(HasSubstr("prose.txt:3"), HasSubstr("--columns t_s,x_m,y_m")));
  EXPECT_THAT(refusal_of([&] { guess_columns(test_file("two.txt", "a b\n0 1 2\n1 2 3\n")); }),
              AllOf(HasSubstr("2 cells above rows of 3"), HasSubstr("--columns t_s,x_m,y_m")));
}

// As Tracker and LabVIEW write them. The rows are read without the line of units.
TEST_F(Headers, UnitsInALineBelowAreRead) {
  std::string text = "made by a camera\nt,angle\n\"ms\",(deg)\n";
  for (int i = 0; i < 40; ++i) text += printed("%d,%.3f\n", 40 * i, 0.1 * i);
  const fs::path file = test_file("below.csv", text);
  const std::string toml = guess_experiment({file}, ".");
  EXPECT_THAT(toml, AllOf(HasSubstr("t_ms = \"t\""), HasSubstr("angle_deg = \"angle\"")));
  RecordingOptions options;
  options.columns = {{"t_ms", "t"}, {"angle_deg", "angle"}};
  const Recording read = read_recording(file, options);
  ASSERT_EQ(read.rows(), 40U);
  EXPECT_NEAR(read.time_s[10], 0.4, 1e-12);
  EXPECT_NEAR(read.find("angle_rad")->values[10], 1.0 * degree, 1e-12);
}

// Headers as numpy.savetxt and telephones write them: the guess states the names, and the recording
// has the values of the first row.
TEST_F(Headers, MayBeCommentsOrSeparatedOtherwise) {
  const std::pair<const char*, const char*> files[] = {
      {"# t [s], x [cm], y [cm]\n", "%d,%d,%d\n"},
      {"# made by hand\n# t [s] x [cm] y [cm]\n", "%d %d %d\n"},
      {"# t x y\n# s cm cm\n", "%d\t%d\t%d\n"},
      {"t [s];x [cm];y [cm]\n", "%d %d %d\n"},
      {"//run 3\n//Time ( s )  x ( cm )  y ( cm )\n", "%d  %d  %d\n"},
      {"t / s  x / cm  y / cm\n# 0 1 2\n", "%d  %d  %d\n"},
      {"%t [s]\tx [cm]\ty [cm]\n%3/2/2017 4:35 PM\n", "%d\t%d\t%d\n"},
      {"t [s]\tx [cm]\ty [cm]\n\t\tDate: 3/2/2017\n", "%d\t%d\t%d\n"},
      {"t [s],x [cm],y [cm],comment\n", "%d,%d,%d\n"},
      {"id,t [s],state,x [cm],y [cm]\n", "7,%d,COAST,%d,%d\n"}};
  for (const auto& [header, row] : files) {
    std::string text = header;
    for (int i = 0; i < 30; ++i) text += printed(row, i, i * i, 100 - i);
    const fs::path file = test_file("comment.txt", text);
    const std::string toml = guess_experiment({file}, ".");
    const Settings root(parse_toml(toml, "guess.toml"));
    const Recording read = read_recording(file, read_recording_options(root.table("recording")));
    ASSERT_EQ(read.rows(), 30U) << header;
    ASSERT_NE(read.find("y_m"), nullptr) << header;
    EXPECT_NEAR(read.time_s[3], 3.0, 1e-12) << header;
    EXPECT_NEAR(read.find("x_m")->values[3], 0.09, 1e-12) << header;
    EXPECT_NEAR(read.find("y_m")->values[3], 0.97, 1e-12) << header;
  }
  EXPECT_THAT(
      refusal_of([&] { guess_columns(test_file("p.txt", "# by hand, at home, 2\n0 1\n1 2\n")); }),
      HasSubstr("rows of 2 numbers without names"));
}

TEST_F(Headers, OfDistancesAndSpeedsBesideATime) {
  const auto names = [&](const std::string& header) {
    return channels_in(test_file("s.csv", header + "\n0,0,2,-2\n0.1,0.19,1.8,-2\n"));
  };
  EXPECT_THAT(names("t,s,v,a"), testing::ElementsAre("t_s", "x_m", "", ""));
  EXPECT_THAT(names("Time,Position,Velocity,a"), testing::ElementsAre("t_s", "x_m", "", ""));
  EXPECT_THAT(names("time,height,ignored,a"), testing::ElementsAre("t_s", "x_m", "", ""));
  EXPECT_THAT(names("s,x,y,a"), testing::ElementsAre("t_s", "x_m", "y_m", ""));
}

// Roll over 40° is in degrees, and so is a yaw of 3°.
TEST_F(Headers, AnglesOfAFileHaveOneUnit) {
  std::string text = "time,roll,yaw\n";
  for (int i = 0; i < 40; ++i) text += printed("%d,%.3f,%.3f\n", i, 20.0 * std::cos(i), 0.1 * i);
  EXPECT_THAT(channels_in(test_file("angles.csv", text)),
              testing::ElementsAre("t_s", "roll_deg", "yaw_deg"));
}

// Rows of a time alone, as of frames without a mark, outnumber the readings.
TEST_F(Headers, OfRowsThatEndBehindTheTime) {
  std::string text = "mass A\nt,x,y\n0\n";
  for (int i = 1; i <= 90; ++i) {
    text += i % 3 == 0 ? printed("%.1f,%d,2\n", 0.1 * i, i * i) : printed("%.1f\n", 0.1 * i);
  }
  const fs::path file = test_file("tracker.csv", text);
  EXPECT_THAT(channels_in(file), testing::ElementsAre("t_s", "x_mm", "y_mm"));
  RecordingOptions options;
  options.columns = {{"t_s", "t"}, {"x_mm", "x"}, {"y_mm", "y"}};
  const Recording read = read_recording(file, options);
  EXPECT_EQ(read.rows(), 30U);
  EXPECT_NEAR(read.find("x_m")->values[1], 0.036, 1e-12);
}

TEST_F(Headers, OfOneColumnWithAStatedRate) {
  std::string text = "Drehzahl (1/min)\n";
  for (int i = 0; i < 30; ++i) text += printed("%d\n", 1000 - i * i);
  const fs::path file = test_file("one.csv", text);
  EXPECT_THAT(refusal_of([&] { guess_columns(file); }), HasSubstr("one column of numbers"));
  RecordingOptions reading;
  reading.rate_Hz = 20.0;
  EXPECT_EQ(guess_columns(file, reading).at(0).channel, "rate_rpm");
}

TEST_F(Headers, OfTwoBodiesAreRefusedWithACommandForOne) {
  std::string text = "t (s),x1 (m),x2 (m)\n";
  for (int i = 0; i < 40; ++i)
    text += printed("%.2f,%.3f,%.3f\n", 0.04 * i, 0.1 * i, 1.0 - 0.1 * i);
  const fs::path file = test_file("gliders.csv", text);
  EXPECT_THAT(refusal_of([&] { guess_experiment({file}, "."); }),
              AllOf(HasSubstr("several columns that may be x_m"), HasSubstr("\"x2 (m)\""),
                    HasSubstr("gliders.csv --columns t_s,x_m,column_3 ")));
  EXPECT_THAT(refusal_of([&] {
                guess_columns(test_file("counts.csv", "t (s),encoder (counts)\n0,1\n1,2\n"));
              }),
              AllOf(HasSubstr("the unit \"counts\""), HasSubstr("rev (the counts of an encoder")));
}

TEST_F(Headers, CountsOfAnEncoderAreNoRadians) {
  std::string whole = "Time,Encoder\n", named = "time(ms),position(counts)\n";
  for (int i = 0; i < 40; ++i) {
    whole += printed("%.2f,%d\n", 0.02 * i, 68 * i);
    named += printed("%d,%d\n", 20 * i, 200 - 9 * i);
  }
  for (const std::string& text : {whole, named}) {
    EXPECT_THAT(
        refusal_of([&] { guess_experiment({test_file("encoder_counts.csv", text)}, "."); }),
        HasSubstr("divide the counts of an encoder by those of a turn, and name the column"));
  }
}

TEST_F(Headers, OfFewRowsAreNamedInTheRefusal) {
  EXPECT_THAT(refusal_of([&] {
                guess_experiment(
                    {test_file("few.txt", "t [min]\tw [1/min]\n0\t1000\n2\t920\n4\t850\n")}, ".");
              }),
              AllOf(HasSubstr("w [1/min]"), HasSubstr("3 rows"), HasSubstr("at least 20")));
}

// A pendulum of 1.5 m about (0.2, 0.1) m, and a body thrown across a table.
TEST_F(Headers, PlacesOnACircleAreRemarked) {
  std::string swing = "t\tx\ty\n", parabola = swing;
  for (int i = 0; i < 200; ++i) {
    const double at = 0.3 * std::cos(0.1 * i), t = 0.01 * i;
    swing += std::to_string(0.03 * i) + "\t" + std::to_string(0.2 + 1.5 * std::sin(at)) + "\t" +
             std::to_string(0.1 - 1.5 * std::cos(at)) + "\n";
    parabola += std::to_string(t) + "\t" + std::to_string(t) + "\t" +
                std::to_string(0.2 * t * (2.0 - t)) + "\n";
  }
  const std::string remarked = guess_experiment({test_file("swing.txt", swing)}, ".");
  EXPECT_THAT(remarked, AllOf(HasSubstr("radius 1.5 m"), HasSubstr("pivot_m = [0.2, ")));
  EXPECT_THAT(guess_experiment({test_file("parabola.txt", parabola)}, "."),
              Not(HasSubstr("radius")));
  // An angle beside them, here about another origin, is not used.
  std::string both = "t\tx\ty\tangle (rad)\n";
  for (int i = 0; i < 200; ++i) {
    const double at = 0.3 * std::cos(0.1 * i);
    both += printed("%.2f\t%.5f\t%.5f\t%.5f\n", 0.03 * i, 1.5 * std::sin(at), 1.5 * std::cos(at),
                    1.3 * at);
  }
  EXPECT_THAT(guess_experiment({test_file("both.txt", both)}, "."),
              AllOf(HasSubstr("pivot_m"), Not(HasSubstr("angle_rad ="))));
}

TEST(Guess, AClockThatCountsMilliseconds) {
  const fs::path file = test_file("clock.csv", "timestamp;gyro_z\n0;1\n20;1\n40;1\n60;1\n");
  EXPECT_EQ(guess_columns(file).front().channel, "t_ms");
  const fs::path fast = test_file("fast.csv", "timestamp;gyro_z\n0;1\n4000;1\n8000;1\n");
  EXPECT_EQ(guess_columns(fast).front().channel, "t_us");
}

TEST(Guess, FilesThatCannotBeReadNameTheCure) {
  const auto refusal = [&](const std::string& text) -> std::string {
    return refusal_of([&] { guess_columns(test_file("bad.csv", text)); });
  };
  EXPECT_THAT(refusal("0,0;1,5;2\n0,1;1,6;3\n"), HasSubstr("bad.csv --columns t_s,x_m,y_m ("));
  EXPECT_THAT(refusal("0,1\n0.1,2\n"), HasSubstr("--columns t_s,angle_rad ("));
  EXPECT_THAT(refusal(std::string("\xff\xfet\0_\0s\0", 8)),
              AllOf(HasSubstr("UTF-16"), HasSubstr("iconv -f UTF-16")));
  EXPECT_THAT(refusal("nothing here\n"), HasSubstr("no rows of numbers"));
  EXPECT_THAT(refusal("2.6\n-61.2\n-3.1\n63.2\n"), HasSubstr("--columns angle_deg --rate-Hz 10"));
  EXPECT_THAT(refusal("0.26\n-0.62\n0.31\n"), HasSubstr("--columns angle_rad --rate-Hz 10"));
  EXPECT_THAT(refusal("0,1,2,3,4,5,6,7,8\n1,1,2,3,4,5,6,7,8\n"),
              HasSubstr("--columns t_s,column_2,column_3,column_4,column_5,column_6,column_7,"
                        "column_8,column_9 ("));
  EXPECT_THAT(refusal_of([&] {
                guess_columns(test_file("five.csv", "a,b,c,d,e\n0,1,2,3,4\n1,2,3,4,5\n"),
                              {.header = {"t_s", "angle_rad"}});
              }),
              HasSubstr("as many names as the file has columns: 5"));
  EXPECT_THAT(refusal_of([&] {
                guess_experiment({test_file("lamp.ies",
                                            "IESNA:LM-63-1995\nTILT=NONE\n1 1000 1 3 1 1 2 0 0 0\n"
                                            "1 1 50\n0 45 90\n0\n100 50 0\n")},
                                 ".");
              }),
              AllOf(HasSubstr("a lamp file (IESNA:LM-63-1995)"), HasSubstr("kind = \"ies\""),
                    Not(HasSubstr("--columns"))));
  EXPECT_THAT(
      refusal("speed\n29.1\n28.8\n28.6\n"),
      AllOf(HasSubstr("one column of numbers"), HasSubstr("--columns rate_rad_s --rate-Hz 10")));
}

// Tables as programs of other countries and calculators write them.
TEST(Guess, BlanksAndDecimalCommasAreRead) {
  const fs::path blanks = test_file("blanks.txt", "time  theta\n 0.0   1.5\n 0.1   1.6\n");
  EXPECT_EQ(guess_columns(blanks)[1].channel, "angle_rad");
  const fs::path german =
      test_file("messung.csv", "Messung vom Montag\nZeit (s);Winkel (degrees)\n0,0;1,5\n0,1;1,6\n");
  EXPECT_EQ(guess_columns(german)[0].channel, "t_s");
  EXPECT_EQ(guess_columns(german)[1].channel, "angle_deg");
}

}  // namespace
}  // namespace photorque
