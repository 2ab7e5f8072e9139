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

struct Expected {
  const char *header, *stem;
  double to_SI;

  void expect_of(const std::string& channel) const {
    EXPECT_EQ(unit_of_key(channel).stem, stem) << header;
    EXPECT_NEAR(unit_of_key(channel).to_SI, to_SI, 1e-12) << header;
  }
};

constexpr double turn = 2.0 * pi, degree = pi / 180.0;

TEST_F(Headers, OfAnglesAndRates) {
  const Expected table[] = {
      {"Winkelgeschwindigkeit / rad/s", "rate", 1.0},
      {"Winkel / °", "angle", degree},
      {"Drehzahl [1/min]", "rate", turn / 60.0},
      {"rpm", "rate", turn / 60.0},
      {"w [1/min]", "rate", turn / 60.0},
      {"angolo (gradi)", "angle", degree},
      {"vitesse angulaire (rad/s)", "rate", 1.0},
      {"phi/rad", "angle", 1.0},
      {"n [1/min]", "rate", turn / 60.0},
      {"n / min⁻¹", "rate", turn / 60.0},
      {"n / s⁻¹", "rate", turn},
      {"θ (deg)", "angle", degree},
      {"ω (rad/s)", "rate", 1.0},
      {"ω / s⁻¹", "rate", 1.0},
      {"ω in rad·s⁻¹", "rate", 1.0},
      {"ω / (rad/s)", "rate", 1.0},
      {"ω (Hz)", "rate", turn},
      {"θ̇ [rad/s]", "rate", 1.0},
      {"dθ/dt (rad/s)", "rate", 1.0},
      {"theta_dot (deg/s)", "rate", degree},
      {"Absolute (rad/s)", "rate_magnitude", 1.0},
      {"|ω| (rad/s)", "rate_magnitude", 1.0},
      {"Auslenkung (rad)", "angle", 1.0},
      {"Amplitude (rad)", "angle", 1.0},
      {"position (rad)", "angle", 1.0},
      {"Ausschlag [°]", "angle", degree},
      {"angle (rev)", "angle", turn},
      {"encoder [turns]", "angle", turn},
      {"Drehwinkel in Umdrehungen", "angle", turn},
      {"speed (rev/s)", "rate", turn},
      {"α [°]", "angle", degree},
      {"wheel_rpm", "rate", turn / 60.0},
      {"drum_rpm", "rate", turn / 60.0},
      {"Drehzahl [U/min]", "rate", turn / 60.0},
      {"Umdrehungen pro Minute", "rate", turn / 60.0},
      {"revolutions per minute", "rate", turn / 60.0},
      {"régime (tr/min)", "rate", turn / 60.0},
      {"Vitesse de rotation (tours/s)", "rate", turn},
      {"fréquence de rotation (tr/s)", "rate", turn},
      {"velocità di rotazione (giri/min)", "rate", turn / 60.0},
      {"velocità angolare (rad/s)", "rate", 1.0},
      {"velocidad angular [rad/s]", "rate", 1.0},
      {"Velocidad de giro (rev/min)", "rate", turn / 60.0},
      {"velocidade angular (graus por segundo)", "rate", degree},
      {"Ángulo (grados)", "angle", degree},
      {"ângulo [graus]", "angle", degree},
      {"posición angular (°)", "angle", degree},
      {"position angulaire (degrés)", "angle", degree},
      {"Winkel in Grad", "angle", degree},
      {"Drehwinkel φ / mrad", "angle", 1e-3},
      {"Winkel phi_1 / rad", "angle", 1.0},
      {"phi(t) / °", "angle", degree},
      {"angleDeg", "angle", degree},
      {"Speed RPM", "rate", turn / 60.0},
      {"Spin rate (rps)", "rate", turn},
      {"omega_rads", "rate", 1.0},
      {"angular rate (°/s)", "rate", degree},
      {"Angular velocity around z-axis (deg/s)", "gyro_z", degree},
      {"GyroX [dps]", "gyro_x", degree},
      {"rotation rate y (rad/s)", "gyro_y", 1.0},
      {"Gierrate [°/s]", "gyro_z", degree},
      {"yaw (deg/s)", "gyro_z", degree},
      {"q (deg/s)", "gyro_y", degree},
      {"Neigung (°)", "tilt", degree},
      {"Rollwinkel [°]", "roll", degree},
      {"heading (deg)", "yaw", degree},
      {"Winkel [\xb0]", "angle", degree},  // Latin-1
      {"Geschwindigkeit (m/s)", "velocity_x", 1.0},
      {"speed km/h", "velocity_x", 1.0 / 3.6},
      {"Vy (cm/s)", "velocity_y", 0.01},
      {"Distance (cm)", "x", 0.01},
      {"Abstand / mm", "x", 1e-3},
      {"Position(m)", "x", 1.0},
  };
  for (const Expected& expected : table) {
    expected.expect_of(channels(std::string("t_s;") + expected.header).at(1));
  }
}

TEST_F(Headers, OfTimes) {
  const Expected table[] = {{"Zeit t / s", "t", 1.0},
                            {"t/s", "t", 1.0},
                            {"t / min", "t", 60.0},
                            {"t [min]", "t", 60.0},
                            {"Time ( s )", "t", 1.0},
                            {"Zeit/ms", "t", 1e-3},
                            {"Timestamp (µs)", "t", 1e-6},
                            {"temps (ms)", "t", 1e-3},
                            {"Tiempo [seg]", "t", 1.0},
                            {"Tempo (secondi)", "t", 1.0},
                            {"tempo em minutos", "t", 60.0},
                            {"timeMs", "t", 1e-3},
                            {"Elapsed Time (h)", "t", 3600.0},
                            {"TimeSinceFirstFrame(s)", "t", 1.0}};
  for (const Expected& expected : table) {
    expected.expect_of(channels(expected.header + std::string(";rate_rpm")).at(0));
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

TEST_F(Headers, OfUnknownUnitsAreRefused) {
  for (const char* header : {"angle (gon)", "Encoder (counts)", "Winkel / Skt", "Winkel (rad/s)"}) {
    EXPECT_THAT(refusal_of([&] { channels(std::string("t_s;") + header); }),
                AllOf(HasSubstr("the unit"), HasSubstr("rad, mrad, deg (°)")))
        << header;
  }
  for (const char* header : {"speed (furlong)", "omega (deg)", "speed (1/s)", "ω [deg/min]"}) {
    EXPECT_THAT(refusal_of([&] { channels(std::string("t_s;") + header); }),
                AllOf(HasSubstr("the unit"), HasSubstr("rpm (1/min")))
        << header;
  }
  EXPECT_THAT(refusal_of([&] { channels("time (days);rate_rpm"); }),
              HasSubstr("s, ms, µs, min or h"));
  // One column of the quantity in a known unit is enough.
  EXPECT_EQ(channels("t_s;angle (raw);angle (deg)").at(2), "angle_deg");
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

TEST_F(Headers, OfCurvesOfAModule) {
  const auto curve = [&](const std::string& header, double scale) {
    std::string text = header + "\n";
    const bool is_numbered = std::ranges::count(header, ';') > 1;
    for (int i = 0; i <= 40; ++i) {
      const double volt = 0.015 * i;
      const double ampere = scale * (1.0 - std::exp((volt - 0.6) / 0.03));
      text += (is_numbered ? std::to_string(i) + ";" : "") + std::to_string(volt) + ";" +
              std::to_string(ampere) + "\n";
    }
    return guess_experiment({test_file("curve.csv", text)}, testing::TempDir());
  };
  for (const char* header : {"U/V;I/A", "U / V;I / A", "No.;U;I", "Nr.;Spannung (V);Strom (A)",
                             "Panel Voltage;Panel Current", "U_mod [V];I_mod [A]"}) {
    EXPECT_THAT(curve(header, 2.0), AllOf(HasSubstr("[module]"), Not(HasSubstr("density"))))
        << header;
  }
  EXPECT_THAT(curve("V;J (mA/cm2)", 20.0),
              AllOf(HasSubstr("current_mA = \"J (mA/cm2)\""), HasSubstr("current density")));
  EXPECT_THAT(curve("V;J", 0.02), HasSubstr("in A/cm² by its size"));
  EXPECT_THAT(refusal_of([&] { curve("U;K", 1.0); }), HasSubstr("one voltage and one current"));
}

// 36 cells of 0.65 V whose meter stays at −0.01 A, or at 0, beyond open circuit, and whose current
// may be counted into the module: what a guess accepts, a diagnosis reads.
TEST_F(Headers, OfCurvesThatAMeterMade) {
  for (const auto& [sign, beyond_A] : {std::pair{1.0, -0.01}, {1.0, 0.0}, {-1.0, 0.0}}) {
    std::string text = "V,I\n";
    for (int i = 0; i <= 52; ++i) {
      const double volt = 0.5 * i, ampere = 5.0 * (1.0 - std::exp((volt - 23.4) / 1.08));
      text += std::to_string(volt) + "," +
              std::to_string(volt < 23.4 ? sign * ampere : sign * beyond_A) + "\n";
    }
    const fs::path file = test_file("meter.csv", text);
    const std::string guessed = guess_experiment({file}, testing::TempDir());
    EXPECT_THAT(guessed, HasSubstr("cells_in_series = 36\n")) << sign << ", " << beyond_A;
    const Settings root(std::make_shared<const SettingsNode>(parse_toml(guessed, "guess.toml")));
    const ModuleDesign design = read_module(root, testing::TempDir());
    EXPECT_EQ(diagnose_module(design, {read_light_recording(file, {})}, {}).verdict,
              Verdict::consistent)
        << sign << ", " << beyond_A;
  }
  const auto refusal = [](const std::string& text) {
    return refusal_of([&] { guess_experiment({test_file("few.csv", text)}, testing::TempDir()); });
  };
  EXPECT_THAT(refusal("V,I\n0,5\n10,4\n20,0\n"), HasSubstr("at least 12 points"));
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

}  // namespace
}  // namespace photorque
