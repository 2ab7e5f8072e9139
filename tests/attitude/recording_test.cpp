#include "attitude/recordings/recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "attitude/recordings/text_lines.h"
#include "core/constants.h"
#include "core/errors.h"
#include "core/text/format.h"
#include "tests/attitude/settings_bench.h"
#include "tests/files.h"
#include "tests/noise.h"
#include "tests/outside.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Recording read(const std::string& text, const RecordingOptions& options = {}) {
  const auto file = new_file(text, ".csv");
  return read_recording(file, options);
}

std::string complaint(const std::string& text, const RecordingOptions& options = {}) {
  const auto file = new_file(text, ".csv");
  return refusal_of([&] { read_recording(file, options); });
}

const std::vector<double>& cells_of(const Recording& recording, std::string_view name) {
  return recording.find(name)->values;
}

bool is_empty(const Recording& recording, std::string_view name, size_t row) {
  return std::isnan(cells_of(recording, name).at(row));
}

std::string row_of(const std::vector<double>& numbers) {
  return joined_text(numbers, ",", [](double x) { return std::to_string(x); }) + "\n";
}

// 200 rows that are 1e15 s apart: the times are in nanoseconds or wrong. An estimate over such a
// time would not end.
TEST(Recording, TimesOverCenturiesAreRefused) {
  std::string text = "t_s,gyro_x_rad_s\n";
  for (int i = 0; i < 200; ++i) text += std::to_string(i) + "e15,0.1\n";
  EXPECT_THAT(complaint(text), HasSubstr("t_s: found times from 0 to"));
}

TEST(Recording, WrittenAndReadBackIsTheSameToTheBit) {
  Recording recording;
  Noise normal(3);
  for (const char* name : {"gyro_x_rad_s", "battery_current_A", "anything_else"}) {
    recording.channels.push_back({name, {}});
  }
  for (int i = 0; i < 500; ++i) {
    recording.time_s.push_back(0.1 * i);
    for (Channel& channel : recording.channels) channel.values.push_back(normal());
  }
  recording.channels[2].values[7] = NAN;
  for (const char* ending : {".csv", ".csv.gz"}) {
    const auto file = new_file("", ending);
    write_recording(file, recording, {"made by a test", "two lines"});
    const Recording back = read_recording(file);
    EXPECT_EQ(back.time_s, recording.time_s);
    EXPECT_EQ(back.report.preamble_lines, 2);
    EXPECT_EQ(back.report.empty_cells, 1);
    for (size_t c = 0; c < recording.channels.size(); ++c) {
      EXPECT_EQ(back.channels[c].name, recording.channels[c].name);
      EXPECT_THAT(back.channels[c].values, testing::Pointwise(testing::NanSensitiveDoubleEq(),
                                                              recording.channels[c].values));
    }
  }
}

TEST(Recording, CompressedFilesAreSmallerAndRepeatable) {
  const std::string text(100000, 'x');
  EXPECT_LT(gzip(text).size(), 1000u);
  EXPECT_EQ(gzip(text), gzip(text));
}

// A clock that runs freely at first, one wrong reading of it, two exchanged rows, and two runs.
TEST(Recording, AWrongTimeDoesNotDiscardTheRowsAfterIt) {
  const auto times = [](const std::string& column) {
    return read("t_s;gyro_x_rad_s\n" + column).time_s;
  };
  EXPECT_THAT(times("3936;1\n0.1;2\n0.2;3\n0.3;4\n"), ElementsAre(0.2, 0.3));
  EXPECT_THAT(times("0;1\n3936;2\n0.2;3\n0.3;4\n0.4;5\n"), ElementsAre(0.0, 0.3, 0.4));
  EXPECT_THAT(times("0;1\n0.2;2\n0.1;3\n0.3;4\n"), ElementsAre(0.0, 0.2, 0.3));
  EXPECT_THAT(times("0;1\n1;2\n2;3\n0;4\n1;5\n2;6\n"), ElementsAre(0.0, 1.0, 2.0));
}

TEST(Recording, RealFilesAreMendedAndEverythingIsCounted) {
  const Recording r = read(
      "\xef\xbb\xbfLab notebook, 3 May\r\n# a comment, with commas\r\n"
      "t_s;\"gyro_x_rad_s\"; battery_current_A \r\n"
      "0.0;1;5\r\n"
      "0.1;;5\r\n"       // an empty cell
      "0.1;2;5\r\n"      // a repeated time
      "0.2;abc;nan\r\n"  // no number; "nan" is empty
      "\r\n# another comment\r\n"
      "0.15;3;5\r\n"       // earlier than before
      ";3;5\r\n"           // no time
      "0.3;+1e-3;5;9\r\n"  // a cell too many
      "0.4;4e0;6\r\n"
      "2.0;5;6\r\n"  // after a gap
      "2.1;6");      // incomplete last row
  EXPECT_THAT(r.time_s, ElementsAre(0.0, 0.1, 0.2, 0.4, 2.0));
  EXPECT_EQ(cells_of(r, "gyro_x_rad_s")[0], 1.0);
  EXPECT_TRUE(is_empty(r, "gyro_x_rad_s", 1));
  EXPECT_TRUE(is_empty(r, "gyro_x_rad_s", 2));
  EXPECT_EQ(cells_of(r, "gyro_x_rad_s")[3], 4.0);
  const RecordingReport& report = r.report;
  EXPECT_EQ(report.preamble_lines, 4);
  EXPECT_EQ(report.rows_read, 10);
  EXPECT_EQ(report.rows_kept, 5);
  EXPECT_EQ(report.repeated_times, 1);
  EXPECT_EQ(report.backward_times, 1);
  EXPECT_EQ(report.first_backward_line, 10);
  EXPECT_EQ(report.rows_without_time, 1);
  EXPECT_EQ(report.malformed_rows, 2);
  EXPECT_EQ(report.empty_cells, 2);
  EXPECT_EQ(report.unreadable_cells, 1);
  ASSERT_EQ(report.gaps.size(), 1u);
  EXPECT_EQ(report.gaps[0].from_s, 0.4);
  EXPECT_EQ(report.gaps[0].to_s, 2.0);
  EXPECT_THAT(report.text(), HasSubstr("1 gaps"));
  // The numbers of rows that were kept and left out add up to that of the rows read.
  EXPECT_EQ(report.rows_read, report.rows_kept + report.repeated_times + report.backward_times +
                                  report.rows_without_time + report.malformed_rows);
}

// A row of zeros before the clock runs, and two rows after it was set. Three rows are a segment.
TEST(Recording, SingleRowsBeyondAJumpOfTheClockAreLeftOut) {
  const auto with = [](const std::string& before, const std::string& after) {
    std::string text = "t_s,rate_rad_s\n" + before;
    for (int i = 0; i < 30; ++i) text += std::to_string(1733.0 + 0.1 * i) + ",1\n";
    return read(text + after);
  };
  const Recording zeros = with("0,0\n", ""), both = with("0,0\n", "9000,0\n9000.1,0\n");
  for (const Recording& r : {zeros, both}) {
    EXPECT_EQ(r.rows(), 30u);
    EXPECT_EQ(r.report.rows_kept, 30);
    EXPECT_EQ(cells_of(r, "rate_rad_s").size(), 30u);
    EXPECT_EQ(cells_of(r, "rate_rad_s")[0], 1.0);
    EXPECT_TRUE(r.report.gaps.empty());
  }
  EXPECT_EQ(zeros.report.isolated_rows, 1);
  EXPECT_EQ(both.report.isolated_rows, 3);
  EXPECT_THAT(both.report.text(), HasSubstr("3 rows at an end beyond a jump of the clock"));
  EXPECT_EQ(with("0,0\n0.1,0\n0.2,0\n", "").report.isolated_rows, 0);
  EXPECT_EQ(with("1710,0\n", "").report.isolated_rows, 0);  // less than ten times 2.9 s
}

TEST(Recording, ColumnsMayHaveOtherNamesAndUnits) {
  RecordingOptions options;
  options.columns = {{"t_ms", "Stamp"}, {"gyro_z_deg_s", "wz"}};
  const Recording r = read("Stamp,wz,gyro_x_rpm\n1000,90,60\n1500,180,30\n", options);
  EXPECT_THAT(r.time_s, ElementsAre(1.0, 1.5));
  EXPECT_THAT(cells_of(r, "gyro_z_rad_s"),
              ElementsAre(testing::DoubleEq(pi / 2), testing::DoubleEq(pi)));
  EXPECT_DOUBLE_EQ(cells_of(r, "gyro_x_rad_s")[0], 2 * pi);
  const RecordingOptions from_file =
      read_recording_options(settings_of("columns = {t_ms = 'Stamp', gyro_z_deg_s = 'wz'}"));
  EXPECT_EQ(from_file.columns, options.columns);
  EXPECT_THAT(refusal_of([] { read_recording_options(settings_of("columns = {x_m = 'x (mm)'}")); }),
              testing::HasSubstr("found \"x (mm)\", a column in mm, expected x_mm = \"x (mm)\""));
}

TEST(Recording, OldNameOfTheYawIsReadWithANotice) {
  const Recording old = read("t_s,heading_deg\n0,90\n1,91\n");
  ASSERT_NE(old.find("yaw_rad"), nullptr);
  EXPECT_DOUBLE_EQ(old.find("yaw_rad")->values[0], pi / 2);
  EXPECT_THAT(old.report.text(), testing::HasSubstr("read as yaw"));
  // In a file with a yaw, the heading is the direction of the tilt.
  const Recording both = read("t_s,heading_deg,yaw_deg\n0,90,10\n1,91,11\n");
  EXPECT_DOUBLE_EQ(both.find("yaw_rad")->values[0], 10 * degree_rad);
  EXPECT_DOUBLE_EQ(both.find("heading_rad")->values[0], pi / 2);
  RecordingOptions named;
  named.columns = {{"heading_rad", "psi"}};
  const Recording renamed = read("t_s,psi\n0,1.5\n1,1.6\n", named);
  EXPECT_DOUBLE_EQ(renamed.find("yaw_rad")->values[0], 1.5);
  EXPECT_TRUE(renamed.report.absent_columns.empty());
}

TEST(Recording, FlippedAndBadQuaternionsAreMended) {
  std::string text = "t_s,q_w,q_x,q_y,q_z\n";
  for (int i = 0; i < 100; ++i) {
    const double angle = 0.01 * i, sign = i % 3 == 1 ? -1.001 : 1.001;
    text +=
        row_of({0.1 * i, sign * std::cos(angle), sign * std::sin(angle), 0.0, i == 50 ? 0.9 : 0.0});
  }
  const Recording r = read(text);
  EXPECT_EQ(r.report.flipped_quaternions, 33);
  EXPECT_EQ(r.report.bad_quaternions, 1);
  for (size_t i = 0; i < r.rows(); ++i) {
    if (i == 50) {
      EXPECT_TRUE(is_empty(r, "q_w", i));
      continue;
    }
    EXPECT_NEAR(cells_of(r, "q_w")[i], std::cos(0.01 * static_cast<double>(i)), 2e-6);
    EXPECT_NEAR(cells_of(r, "q_x")[i], std::sin(0.01 * static_cast<double>(i)), 2e-6);
  }
}

// Spikes are removed; noise, steps and fast motion are kept.
TEST(Recording, OutliersAreFoundAndNothingElse) {
  Noise noise(5, 2e-4);
  std::string text = "t_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s\n";
  for (int i = 0; i < 2000; ++i) {
    const double t = 0.01 * i;
    const double spike = i % 500 == 123 ? 0.5 : 0.0;
    const double x = std::sin(3 * t) + spike + noise();
    const double y = (t < 10 ? 0.1 : -0.2) + noise();
    const double z = 20 * std::sin(15 * t) + noise();
    text += row_of({t, x, y, z});
  }
  const Recording r = read(text);
  EXPECT_EQ(r.report.outlier_cells, 4);
  EXPECT_EQ(r.report.outliers.at("gyro_x_rad_s"), 4);
  for (const size_t row : {123u, 623u, 1123u, 1623u}) {
    EXPECT_TRUE(is_empty(r, "gyro_x_rad_s", row));
  }
  RecordingOptions keep;
  keep.remove_outliers = false;
  EXPECT_EQ(read(text, keep).report.outlier_cells, 0);
}

// A log of 2000 rows every 0.01 s, whose rate is read every `hold` rows (not necessarily a whole
// number) with noise and held in between. A command changes in every seventh row, and an angle, if
// there is one, in every row.
std::string held_log(double hold, bool has_angle) {
  Noise noise(3, 0.02);
  std::string text = "t_s,rate_rad_s,command_z_N_m";
  text += has_angle ? ",angle_rad\n" : "\n";
  double rate = 0.0;
  int readings = 0;
  for (int i = 0; i < 2000; ++i) {
    if (i >= hold * readings) {
      rate = std::sin(0.02 * i) + noise();
      ++readings;
    }
    std::vector<double> cells = {0.01 * i, rate, 1.0 * (i / 7)};
    if (has_angle) cells.push_back(0.001 * i * i);
    text += row_of(cells);
  }
  return text;
}

TEST(Recording, ReadingsHeldByTheLogAreReadOnce) {
  for (const auto& [hold, rows] : {std::pair(2.0, 2), {3.0, 3}, {10.0 / 3.0, 3}, {7.0, 7}}) {
    const Recording r = read(held_log(hold, true));
    const auto readings = static_cast<int64_t>(std::ceil(2000.0 / hold));
    EXPECT_EQ(r.report.held_readings, 2000 - readings) << hold;
    EXPECT_EQ(r.report.rows_per_reading.at("rate_rad_s"), rows);
    EXPECT_THAT(r.report.text(), HasSubstr("held readings left out"));
    // The angle is read in every row.
    EXPECT_EQ(r.report.rows_kept, 2000);
    EXPECT_FALSE(is_empty(r, "angle_rad", 1));
    // The first row of a reading has its time.
    EXPECT_FALSE(is_empty(r, "rate_rad_s", 0));
    EXPECT_TRUE(is_empty(r, "rate_rad_s", 1));
    EXPECT_FALSE(is_empty(r, "rate_rad_s", static_cast<size_t>(std::ceil(hold))));
  }
}

// The rows without a reading are omitted, except those that change a command.
TEST(Recording, CommandsAreKeptBetweenHeldReadings) {
  const Recording r = read(held_log(3.0, false));
  EXPECT_EQ(r.report.held_readings, 1333);
  EXPECT_EQ(r.report.rows_kept, static_cast<int64_t>(r.rows()));
  for (size_t row = 0; row < r.rows(); ++row) {
    const auto i = static_cast<int>(std::lround(r.time_s[row] / 0.01));
    EXPECT_TRUE(i % 3 == 0 || i % 7 == 0) << i;
    EXPECT_EQ(is_empty(r, "rate_rad_s", row), i % 3 != 0);
    EXPECT_EQ(cells_of(r, "command_z_N_m")[row], i / 7);
  }
  EXPECT_EQ(r.rows(), 667u + 286u - 96u);
}

// Equal neighbours that are no held readings: an encoder that turns slowly and steadily, one that
// swings, a body at rest, and coarse digits with noise. Commands are held by definition.
TEST(Recording, ReadingsThatAreEqualByChanceAreKept) {
  const std::function<double(int)> slow[] = {
      [](int i) { return 0.001 * (i / 3); },
      [](int i) { return 0.01 * std::round(100 * std::sin(0.003 * i)); },
      [](int i) { return i < 1900 ? 0.5 : std::sin(0.1 * i); },
      [noise = Noise(4)](int) mutable { return 0.5 * std::round(noise()); }};
  for (const auto& angle_rad : slow) {
    std::string text = "t_s,angle_rad,command_z_N_m\n";
    for (int i = 0; i < 2000; ++i) {
      text += row_of({0.01 * i, angle_rad(i), std::sin(0.1 * (i / 2))});
    }
    const Recording r = read(text);
    EXPECT_EQ(r.report.held_readings, 0);
    EXPECT_EQ(r.report.rows_kept, 2000);
  }
}

// The first gyro saturates at 0.1 rad/s about x, reports exactly that about z at all times, and
// repeats its last reading for 2 s about y. The second gyro has no fault: a motion without noise
// that comes to rest about y, and zeros about z, as from an axis that it does not have.
TEST(Recording, ReadingsOfASensorThatStandsStillAreLeftOut) {
  Noise noise(9, 2e-4);
  const std::string header = "t_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s\n";
  std::string faulty = header, sound = header;
  double y = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const double t = 0.01 * i;
    const double x = std::min(0.1, 0.12 * std::sin(0.5 * t) + noise());
    if (i <= 500 || i > 700) y = 0.03 * std::cos(t) + noise();
    faulty += row_of({t, x, y, 0.1});
    sound += row_of({t, 0.05 + noise(), t < 5.0 ? 0.1 * std::exp(-t) : 0.0, 0.0});
  }
  const Recording r = read(faulty);
  for (size_t i = 0; i < 2000; ++i) {
    const double rate = 0.12 * std::sin(0.005 * static_cast<double>(i));
    if (rate > 0.101 || rate < 0.099) {
      EXPECT_EQ(is_empty(r, "gyro_x_rad_s", i), rate > 0.101) << i;
    }
    // The rows beside a repeated reading may be left out, too.
    const bool repeats = i > 500 && i <= 700, is_next = i >= 499 && i <= 701;
    if (repeats || !is_next) {
      EXPECT_EQ(is_empty(r, "gyro_y_rad_s", i), repeats) << i;
    }
    EXPECT_TRUE(is_empty(r, "gyro_z_rad_s", i)) << i;
  }
  const Recording rests = read(sound);
  for (size_t i = 510; i < 2000; ++i) {
    EXPECT_EQ(cells_of(rests, "gyro_y_rad_s")[i], 0.0) << i;
    EXPECT_EQ(cells_of(rests, "gyro_z_rad_s")[i], 0.0) << i;
  }
}

TEST(Recording, JitterAndIntervalAreMeasured) {
  Noise jitter(7, 1e-3);
  std::string text = "t_s,gyro_x_rad_s\n";
  for (int i = 0; i < 5000; ++i) text += std::to_string(0.1 * i + jitter()) + ",0\n";
  const RecordingReport report = read(text).report;
  EXPECT_NEAR(report.median_interval_s, 0.1, 2e-4);
  // The jitter of an interval is that of the difference of two times.
  EXPECT_NEAR(report.jitter_s, std::sqrt(2.0) * 1e-3, 6e-5);
}

TEST(Recording, HeldChannelsBecomeASchedule) {
  const Schedule schedule = read(
                                "t_s,command_x_N_m,command_z_N_m,battery_current_A\n"
                                "0,0,0,2\n1,1e-3,0,2\n2,1e-3,,2\n3,1e-3,5e-4,\n4,1e-3,5e-4,2\n")
                                .schedule();
  EXPECT_THAT(schedule.time_s, ElementsAre(0.0, 1.0, 3.0));
  EXPECT_EQ(schedule.at(0.999).command_body_N_m.x(), 0.0);
  EXPECT_EQ(schedule.at(1.0).command_body_N_m.x(), 1e-3);
  EXPECT_EQ(schedule.at(100.0).command_body_N_m.z(), 5e-4);
  EXPECT_EQ(schedule.at(100.0).battery_current_A, 2.0);
  EXPECT_EQ(schedule.at(-1.0).battery_current_A, 0.0);
}

// A table of pandas begins with row numbers without a name; lines of Tracker end with a tab.
TEST(Recording, ColumnsWithoutANameAreLeftOut) {
  const Recording read = read_recording(test_file("index.csv", ",t_s,a,\n0,1,2\n1,2,3,\n"));
  ASSERT_EQ(read.channels.size(), 1U);
  EXPECT_THAT(read.channels[0].values, testing::ElementsAre(2.0, 3.0));
}

TEST(Recording, HopelessFilesAreRefusedInOneLine) {
  for (const auto& [text, words] : {std::pair("", "expected a header with t_s"),
                                    {"a,b\n1,2\n", "t_s"},
                                    {"t_s,gyro_x_rad_s\n", "0 usable rows"},
                                    {"t_s,gyro_x_rad_s\n1,2\n", "1 usable rows"},
                                    {"t_s,gyro_x_rad_s\n1,nan\n2,\n", "no number in any channel"},
                                    {"t_s,a,a\n1,2,3\n2,3,4\n", "twice"},
                                    {"t_s,a\n5,1\n4,1\n3,1\n2,1\n", "times that fall in 3 rows"}}) {
    const std::string line = complaint(text);
    EXPECT_THAT(line, HasSubstr(words));
    EXPECT_EQ(std::ranges::count(line, '\n'), 0);
  }
  RecordingOptions small;
  small.max_cells = 10;
  std::string long_file = "t_s,a\n";
  for (int i = 0; i < 6; ++i) long_file += std::to_string(i) + ",1\n";
  EXPECT_THAT(complaint(long_file, small), HasSubstr("more than 10 numbers"));
  EXPECT_THAT(complaint("t_s,a\n" + std::string(3 << 20, '1')), HasSubstr("megabyte"));
  EXPECT_THROW(read_recording("/no/such/file.csv"), InputError);
  EXPECT_THROW(read_recording(testing::TempDir()), InputError);
}

TEST(Recording, DecimalCommasAreReadWhereTheyDoNotSeparateCells) {
  const Recording semicolons = read("t_s;gyro_x_rad_s\n0,0;1\n0,1;0,25\n0,2;3\n");
  EXPECT_EQ(cells_of(semicolons, "gyro_x_rad_s"), (std::vector<double>{1.0, 0.25, 3.0}));
  EXPECT_EQ(semicolons.time_s, (std::vector<double>{0.0, 0.1, 0.2}));
  EXPECT_TRUE(semicolons.report.has_decimal_commas);
  const Recording blanks = read("t_s  gyro_x_rad_s\n 0,0   1\n 0,1\t0,25\n");
  EXPECT_EQ(cells_of(blanks, "gyro_x_rad_s"), (std::vector<double>{1.0, 0.25}));
  // With decimal commas and commas between cells, every row has more cells than the header.
  EXPECT_THAT(complaint("t_s,gyro_x_rad_s\n0,0,1,5\n0,1,2,5\n0,2,2,5\n"),
              HasSubstr(":2: found a row of 4 cells, expected 2, as in the header"));
  // Cells that are not numbers are left out, also if they contain commas.
  EXPECT_EQ(complaint("t_s;a\n0;1\n1;x,5\n2;1,2,3\n3;2\n"), "");
}

TEST(Recording, WhereMostRowsAreWrongTheFirstIsNamed) {
  EXPECT_THAT(complaint("t_s,a\n0,1\n1,2\n2,3,4\n3,4,5\n4,5,6\n"),
              HasSubstr(":4: found a row of 3 cells, expected 2"));
  EXPECT_THAT(complaint("t_s,a\n0,1\n1,2\nnoon,3\nlater,3\nlater,3\n"),
              HasSubstr(":4: t_s: found \"noon\", expected a number"));
}

// 1e305 h in seconds is infinite.
TEST(Recording, NumbersThatOverflowInSiUnitsAreLeftOut) {
  const Recording recording = read("t_h,x_m\n0,1\n1,1\n2,1\n1e305,1\n");
  EXPECT_THAT(recording.time_s, ElementsAre(0.0, 3600.0, 7200.0));
  EXPECT_EQ(recording.report.rows_without_time, 1);
  const Recording lengths = read("t_s,x_km\n0,1\n1,1e306\n2,1\n");
  EXPECT_TRUE(is_empty(lengths, "x_m", 1));
  EXPECT_EQ(lengths.report.unreadable_cells, 1);
}

TEST(Recording, DamagedCompressedFilesAreRefused) {
  std::string text = "t_s,a\n";
  for (int i = 0; i < 5000; ++i)
    text += std::to_string(i) + "," + std::to_string(i * i % 997) + "\n";
  const std::string whole = gzip(text);
  const auto read_bytes = [](const std::string& bytes) {
    return read_recording(new_file(bytes, ".csv.gz"));
  };
  EXPECT_EQ(read_bytes(whole).rows(), 5000u);
  EXPECT_THROW(read_bytes(whole.substr(0, whole.size() / 2)), InputError);
  std::string broken = whole;
  for (size_t i = whole.size() / 2; i < whole.size() / 2 + 20; ++i) broken[i] = '\x55';
  EXPECT_THROW(read_bytes(broken), InputError);
}

TEST(Commands, MustBeInOrderAndCommandSomething) {
  const auto complaint_of = [](const std::string& text) -> std::string {
    const auto file = new_file(text, ".csv");
    return refusal_of([&] { read_command_file(file); });
  };
  EXPECT_EQ(complaint_of("t_s,command_x_N_m\n0,1\n1,0\n"), "");
  EXPECT_THAT(complaint_of("t_s,command_x_N_m\n0,1\n2,0\n1,0\n"),
              HasSubstr(":4: t_s: found times that do not rise"));
  EXPECT_THAT(complaint_of("t_s,command_x_N_m\n0,1\n1,0\n1,2\n"), HasSubstr(":4: t_s"));
  EXPECT_THAT(complaint_of("t_s,gyro_x_rad_s\n0,1\n1,0\n"), HasSubstr("no command"));
}

TEST(Recording, CleanRecordingOfAnotherProgramIsReadWhole) {
  const Recording recording = read_recording(outside::reference_data("cases/02/run1.csv.gz"));
  EXPECT_EQ(recording.rows(), 4000u);
  EXPECT_EQ(recording.report.outlier_cells, 0);
}

TEST(Recording, RecordingsOfRealHardwareAreRead) {
  PHOTORQUE_NEEDS_THIRD_PARTY("recordings");
  const std::filesystem::path folder = outside::third_party("recordings");
  int read_files = 0;
  for (const char* set : {"throw_flywheel", "racquet_tumble", "wheel_coastdown"}) {
    for (const auto& entry : std::filesystem::directory_iterator(folder / set)) {
      const Recording recording = read_recording(entry.path());
      EXPECT_GT(recording.report.rows_kept, 30);
      EXPECT_EQ(recording.report.held_readings, 0) << entry.path();
      // At most a few repeated times and outliers.
      EXPECT_GT(recording.report.rows_kept, 0.98 * recording.report.rows_read) << entry.path();
      EXPECT_LT(recording.report.outlier_cells, 0.02 * 3 * recording.report.rows_read)
          << entry.path() << recording.report.text();
      ++read_files;
    }
  }
  EXPECT_GT(read_files, 10);
}

}  // namespace
}  // namespace photorque
