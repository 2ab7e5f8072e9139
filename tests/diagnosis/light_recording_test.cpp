// Readers of scans, sweeps and runs: recognised by their headers, with dropped rows counted.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <regex>

#include "core/errors.h"
#include "diagnosis/light/model/recording.h"
#include "tests/files.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

LightRecording read(const std::string& text, const DefaultConditions& usual = {}) {
  return read_light_recording(new_file(text, ".csv"), usual);
}

std::string refusal(const std::string& text) {
  return refusal_of([&] { read(text); });
}

TEST(LightRecordings, AScanAmongCommentsAndTornRows) {
  const auto scan = read(
      "# operator: none\nsome words of an instrument\n"
      "u_m,v_m,irradiance_W_m2,tilt_deg,heading_deg\n"
      "0.01,0.02,300.5,12,60\n0.01,0.03\n0.02,0.02,nan,12,60\n0.03,0.02,301,12,60\n");
  EXPECT_EQ(scan.kind, LightRecording::Kind::scan);
  ASSERT_EQ(scan.rows(), 2u);
  EXPECT_EQ(scan.rows_read, 4);
  EXPECT_EQ(scan.irradiance_W_m2[1], 301.0);
  // 12 deg of tilt: the body's z axis leans by its cosine.
  EXPECT_NEAR((scan.lab_from_body[0] * Vec3::UnitZ()).z(), 0.97814760073380564, 1e-12);
  EXPECT_EQ(scan.rejected.at("wrong number of cells"), 1);
  EXPECT_EQ(scan.rejected.at("unreadable number"), 1);
}

TEST(LightRecordings, SweepsAndRunsByTheirHeaders) {
  const auto sweep = read("voltage_mV,current_mA\n1000,250\n", {Quat::Identity(), 310.0});
  EXPECT_EQ(sweep.kind, LightRecording::Kind::sweep);
  EXPECT_NEAR(sweep.voltage_V[0], 1.0, 1e-12);
  EXPECT_NEAR(sweep.current_A[0], 0.25, 1e-12);
  EXPECT_EQ(sweep.temperature_K[0], 310.0);
  const auto run = read(
      "t_s,q_w,q_x,q_y,q_z,array_voltage_V,array_current_A,array_power_W,"
      "cell_temperature_K,led_current_A\n0,1,0,0,0,8,0.3,2.4,297,0.7\n"
      "1,2,0,0,0,8,0.3,2.4,297,0.7\n");
  EXPECT_EQ(run.kind, LightRecording::Kind::run);
  EXPECT_EQ(run.rows(), 1u);
  EXPECT_EQ(run.rejected.at("unreadable attitude"), 1);
}

TEST(LightRecordings, SemicolonsAndTabsSeparateToo) {
  for (const char* text : {"u_m;v_m;irradiance_W_m2\n0,01;0,02;300,5\n0,03;0,02;301\n",
                           "u_m\tv_m\tirradiance_W_m2\n0.01\t0.02\t300.5\n0.03\t0.02\t301\n"}) {
    const auto scan = read(text);
    EXPECT_EQ(scan.kind, LightRecording::Kind::scan);
    EXPECT_THAT(scan.u_m, testing::ElementsAre(0.01, 0.03));
    EXPECT_THAT(scan.irradiance_W_m2, testing::ElementsAre(300.5, 301.0));
  }
  const auto sweep = read("voltage_V;current_A;cell_temperature_K\n1,5;0,25;310\n");
  EXPECT_EQ(sweep.kind, LightRecording::Kind::sweep);
  EXPECT_EQ(sweep.current_A[0], 0.25);
  EXPECT_EQ(sweep.temperature_K[0], 310.0);
}

// One reading written fifty times is one reading: its noise is not that of a mean of fifty.
TEST(LightRecordings, CopiesOfARowAreLeftOut) {
  std::string rows = "u_m,v_m,irradiance_W_m2\n0.01,0.02,300\n0.01,0.02,301\n";
  for (int i = 0; i < 50; ++i) rows += "0.02,0.02,310.5\n";
  const auto scan = read(rows);
  EXPECT_EQ(scan.irradiance_W_m2, (std::vector<double>{300.0, 301.0, 310.5}));
  EXPECT_EQ(scan.rejected.at("repeated row"), 49);
  const auto sweeps = read("sweep,voltage_V,current_A\n0,1,0.2\n1,1,0.2\n1,1,0.2\n");
  EXPECT_EQ(sweeps.rows(), 2u);
}

// Currents read to a hundredth where the lamps are darkest: the light of a steady interval is that
// of their mean, 0.7 A and 0.07 A but for ± 1 mA in turn.
TEST(LightRecordings, NoiseOfTheLampsCurrentIsNoneOfTheirLight) {
  std::string rows = "t_s,q_w,q_x,q_y,q_z,array_voltage_V,array_current_A,led_current_A\n";
  for (int i = 0; i < 40; ++i) {
    rows += std::to_string(i) + ",1,0,0,0,8,0.3," +
            std::to_string((i < 20 ? 0.7 : 0.07) + (i % 2 == 0 ? 1e-3 : -1e-3)) + "\n";
  }
  const LightRecording noisy = read(rows);
  ASSERT_EQ(noisy.lamp_light.size(), 40u);
  for (size_t i = 0; i < 40; ++i) {
    EXPECT_NEAR(noisy.lamp_light[i], i < 20 ? 1.0 : 0.1, 1e-12) << i;
  }
}

// Lamps that are dimmed say so by their current; a constant one says nothing. Rows chosen keep what
// is theirs.
TEST(LightRecordings, DimmedLampsAreRelativeToTheirBrightest) {
  const auto with_current = [](const std::string& second) {
    return read(
        "t_s,q_w,q_x,q_y,q_z,array_voltage_V,array_current_A,led_current_A\n"
        "0,1,0,0,0,8,0.3,0.7\n1,1,0,0,0,7,0.1," +
        second + "\n2,1,0,0,0,8,0.3,\n");
  };
  const LightRecording dimmed = with_current("0.175");
  ASSERT_EQ(dimmed.lamp_light.size(), 3u);
  EXPECT_NEAR(dimmed.lamp_light[0], 1.0, 1e-12);
  EXPECT_NEAR(dimmed.lamp_light[1], 0.25, 1e-12);
  EXPECT_NEAR(dimmed.lamp_light[2], 0.25, 1e-12);
  EXPECT_TRUE(with_current("0.69").lamp_light.empty());
  const LightRecording last = dimmed.part({1, 2});
  ASSERT_EQ(last.rows(), 2u);
  EXPECT_EQ(last.time_s, (std::vector<double>{1.0, 2.0}));
  EXPECT_EQ(last.voltage_V[0], 7.0);
  EXPECT_EQ(last.lamp_light.size(), 2u);
}

// Once a conversion without a meaning.
TEST(LightRecordings, NumbersOfSweepsBeyondAllCountingAreLeftOut) {
  const auto sweep = read("sweep,voltage_V,current_A\n1e300,1,0.2\n-3,1,0.2\n");
  ASSERT_EQ(sweep.rows(), 1u);
  EXPECT_EQ(sweep.sweep[0], -3);
  EXPECT_EQ(sweep.rejected.at("unreadable number"), 1);
}

TEST(LightRecordings, RowsOfAnotherLengthThanTheHeaderAreNamedWhereMostAre) {
  EXPECT_THAT(refusal("voltage_V,current_A\n1,2\n0,5,0,2\n0,6,0,2\n0,7,0,2\n"),
              testing::HasSubstr(":3: found a row of 4 cells, expected 2"));
}

// A scan at a tilt without its heading was taken to be at the experiment's attitude.
TEST(LightRecordings, PartsOfAnAttitudeAreRefused) {
  for (const char* columns :
       {"tilt_deg", "heading_deg", "tilt_degrees,heading_deg", "q_w,q_x,q_y"}) {
    const std::string header = std::string("u_m,v_m,irradiance_W_m2,") + columns;
    const auto cells = static_cast<int>(std::ranges::count(header, ','));
    std::string row = "0.1,0.2,300";
    for (int i = 2; i < cells; ++i) row += ",0.5";
    EXPECT_THAT(refusal(header + "\n" + row + "\n"), testing::HasSubstr("alone of an attitude"))
        << columns;
  }
}

TEST(LightRecordings, LampsWithoutAnyCurrentAreRefused) {
  EXPECT_THROW(read("t_s,q_w,q_x,q_y,q_z,array_voltage_V,array_current_A,led_current_A\n"
                    "0,1,0,0,0,8,0.3,0\n1,1,0,0,0,8,0.3,0\n"),
               InputError);
}

TEST(LightRecordings, SweepsAreReadAsInstrumentsWriteThem) {
  const auto german = read(
      "Modul 17\nSpannung [V];Strom [mA];Zelltemperatur [°C]\n"
      "0,1;500;24\n0,2;NaN;24\n0,3;400;26\n");
  EXPECT_EQ(german.kind, LightRecording::Kind::sweep);
  ASSERT_EQ(german.rows(), 2u);
  EXPECT_NEAR(german.voltage_V[1], 0.3, 1e-15);
  EXPECT_NEAR(german.current_A[0], 0.5, 1e-15);
  EXPECT_TRUE(german.has_temperatures);
  EXPECT_NEAR(german.temperature_K[0], 298.15, 1e-9);
  EXPECT_EQ(german.rejected.at("unreadable number"), 1);
  const auto several = read("Curve\tVolts\tAmps\n7\t0\t5\n7\t30\t0\n9\t0\t4\n");
  EXPECT_EQ(several.sweep, (std::vector{0, 0, 1}));
}

// 36 cells in closed form: V = 36 · 0.0283 V · ln((5.6 A − I)/4e-9 A + 1) − 0.2 Ω · I, which
// is 21.4 V at no current. `sign`: −1 for a current that is counted into the module.
std::string curve_of_36_cells(int sign, const std::string& beyond) {
  std::string rows = "voltage_V,current_A\n";
  const auto row = [&](double current_A) {
    const double voltage_V =
        36.0 * 0.0283 * std::log((5.6 - current_A) / 4e-9 + 1.0) - 0.2 * current_A;
    rows += std::to_string(voltage_V) + "," + std::to_string(sign * current_A) + "\n";
  };
  for (int i = 0; i < 30; ++i) row(5.598 * (1.0 - std::pow(i / 30.0, 3)));
  return rows + beyond;
}

TEST(LightRecordings, CurvesAreCleanedAsFitsOfCellsCleanThem) {
  const auto floor = read(curve_of_36_cells(1, "21.6,-0.01\n22,-0.01\n22.4,-0.01\n22.8,-0.01\n"));
  EXPECT_EQ(floor.rows(), 30u);
  EXPECT_EQ(floor.rows_read, 34);
  EXPECT_EQ(floor.rejected.at("beyond open circuit"), 4);
  const auto dead = read(curve_of_36_cells(1, "0.1,0\n0.2,0.0\n14,0\n"));
  EXPECT_EQ(dead.rows(), 30u);
  EXPECT_EQ(dead.rejected.at("no current where others flow"), 2);
  EXPECT_EQ(dead.rejected.at("outlier"), 1);
  const auto reversed = read(curve_of_36_cells(-1, ""));
  EXPECT_TRUE(reversed.is_reversed);
  EXPECT_NEAR(reversed.current_A[0], 5.598, 1e-12);
}

// With a dark cell the current vanishes far below the last voltage.
TEST(LightRecordings, TheTailOfADarkCellIsKept) {
  const auto dark = read(curve_of_36_cells(1, "26,0.008\n28,0.006\n30,0.004\n32,0.002\n"));
  EXPECT_EQ(dark.rows(), 34u);
}

TEST(LightRecordings, ColumnsMayHaveNamesOfTheFiles) {
  const fs::path file = test_file("named.csv", "ch1,ch2,ref\n0.1,500,900\n0.2,400,900\n");
  EXPECT_FALSE(is_light_recording(file));
  const RecordingOptions columns{
      .columns = {{"voltage_V", "ch1"}, {"current_mA", "ch2"}, {"irradiance_W_m2", "ref"}}};
  EXPECT_TRUE(is_light_recording(file, columns));
  const auto sweep = read_light_recording(file, {}, columns);
  ASSERT_EQ(sweep.rows(), 2u);
  EXPECT_NEAR(sweep.current_A[1], 0.4, 1e-15);
  EXPECT_EQ(sweep.irradiance_W_m2[0], 900.0);
  EXPECT_TRUE(sweep.absent_columns.empty());
  RecordingOptions misspelt = columns;
  misspelt.columns["irradiance_W_m2"] = "reff";
  EXPECT_TRUE(read_light_recording(file, {}, misspelt).absent_columns.contains("reff"));
}

TEST(LightRecordings, AFileWithoutHeaderHasStatedNames) {
  const fs::path file = test_file("bare.txt", "made by hand\n0.1 500\n0.2 400\n");
  EXPECT_FALSE(is_light_recording(file));
  const RecordingOptions names{.header = {"voltage_V", "current_mA"}};
  EXPECT_TRUE(is_light_recording(file, names));
  const auto sweep = read_light_recording(file, {}, names);
  ASSERT_EQ(sweep.rows(), 2u);
  EXPECT_NEAR(sweep.current_A[1], 0.4, 1e-15);
}

TEST(LightRecordings, AMisspeltColumnIsAbsentBesideOneOfItsQuantity) {
  const RecordingOptions misspelt{.columns = {{"current_A", "I_ture"}}};
  const fs::path plain = test_file("plain.csv", "voltage_V,current_A\n0.1,5\n0.2,4\n"),
                 instrument =
                     test_file("instrument.csv", "note I_ture\nVolts;Amps\n0.1;5\n0.2;4\n");
  for (const fs::path& file : {plain, instrument}) {
    EXPECT_TRUE(read_light_recording(file, {}, misspelt).absent_columns.contains("I_ture"));
  }
}

TEST(LightRecordings, ANamedColumnCountsBeforeOthersOfItsQuantity) {
  const fs::path file =
      test_file("both.csv", "voltage_V,current_A,corrected\n0.1,5,5.1\n0.2,4,4.1\n");
  for (const auto& [name, scale] :
       std::map<std::string, double>{{"current_A", 1.0}, {"current_mA", 1e-3}}) {
    const auto sweep = read_light_recording(file, {}, {.columns = {{name, "corrected"}}});
    EXPECT_NEAR(sweep.current_A[1], 4.1 * scale, 1e-15) << name;
    EXPECT_TRUE(sweep.absent_columns.empty());
  }
}

TEST(LightRecordings, CurvesOneBelowTheOtherAreSeparated) {
  const std::string one = curve_of_36_cells(1, ""), rows = one.substr(one.find('\n') + 1);
  const auto stacked = read("voltage_V,current_A,cell_temperature_K\n" +
                            std::regex_replace(rows, std::regex("\n"), ",298\n") +
                            std::regex_replace(rows, std::regex("\n"), ",299\n"));
  EXPECT_EQ(sweeps_of(stacked).size(), 2u);
  EXPECT_THAT(reading_notes({stacked}), testing::ElementsAre(testing::HasSubstr("2 curves")));
  EXPECT_TRUE(reading_notes({read(one)}).empty());
}

TEST(LightRecordings, AMissingColumnIsNamed) {
  EXPECT_THAT(refusal("x,y,irradiance_W_m2\n0,0,800\n"), testing::HasSubstr("no column u_m, v_m"));
  EXPECT_THAT(refusal("t_s,array_voltage_V,array_current_A\n0,8,1\n"),
              testing::HasSubstr("no column q_w"));
}

TEST(LightRecordings, OthersAreRefused) {
  const fs::path motion =
      test_file("motion.csv", "t_s,q_w,q_x,q_y,q_z,gyro_x_rad_s\n0,1,0,0,0,0\n");
  EXPECT_FALSE(is_light_recording(motion));
  EXPECT_THROW(read_light_recording(motion, {}), InputError);
  EXPECT_THROW(read("voltage_V,current_A\n"), InputError);
}

}  // namespace
}  // namespace photorque
