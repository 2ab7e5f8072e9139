// Recordings that hold no motion of a platform are refused in one line that names the channel.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "attitude/disturbances/kind.h"
#include "attitude/estimation/segments.h"
#include "attitude/filtering/motion_model.h"
#include "attitude/observation/observation.h"
#include "core/errors.h"
#include "diagnosis/attitude/diagnose.h"
#include "diagnosis/attitude/recorded_data.h"
#include "tests/files.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

// A recording with this header and, from t = 0 on, every tenth of a second this rest of a row.
Recording repeated_row(const std::string& header, const std::string& row, int rows) {
  std::ostringstream out;
  out << header << "\n";
  for (int i = 0; i < rows; ++i) out << 0.1 * i << "," << row << "\n";
  return read_recording(test_file("bad_recording.csv", out.str()));
}

std::string complaint_of(const Recording& recording) {
  return refusal_of([&] { observe(recording, "run.csv"); });
}

TEST(BadRecording, WithoutAttitudeNamesTheMissingChannel) {
  const Recording currents = repeated_row("t_s,battery_current_A", "0.1", 100);
  EXPECT_EQ(complaint_of(currents),
            "run.csv: header: found neither an angle nor a rate (the columns battery_current_A), "
            "expected q_w, q_x, q_y, q_z or roll_rad, pitch_rad, yaw_rad; gyro_x_rad_s …; "
            "tilt_rad, rate_magnitude_rad_s; or [recording.columns], which photorque diagnose "
            "--guess writes");
  // A name without its unit.
  EXPECT_THAT(complaint_of(repeated_row("t_s,yaw", "0.1", 100)),
              testing::HasSubstr("yaw_deg or yaw_rad"));
  EXPECT_THAT(complaint_of(repeated_row("t_s,gyro_x", "0.1", 100)),
              testing::HasSubstr("gyro_x_deg_s"));
  const Recording three = repeated_row("t_s,q_w,q_x,q_y", "1,0,0", 100);
  EXPECT_THAT(complaint_of(three), testing::HasSubstr("no channel q_z"));
}

TEST(BadRecording, WithHardlyAnyAttitudeIsRefused) {
  EXPECT_THAT(complaint_of(repeated_row("t_s,q_w,q_x,q_y,q_z", "1,0,0,0", 19)),
              testing::HasSubstr("19 complete"));
  EXPECT_EQ(complaint_of(repeated_row("t_s,q_w,q_x,q_y,q_z", "1,0,0,0", 20)), "");
}

// A clock that was set to another epoch while it recorded; a pause as long as what was recorded is
// none.
TEST(BadRecording, ClockJumpsAreReportedWithTheirTimes) {
  const auto with_pause = [](double pause_s) {
    Recording r = repeated_row("t_s,q_w,q_x,q_y,q_z", "1,0,0,0", 200);
    for (size_t row = 100; row < 200; ++row) r.time_s[row] += pause_s;
    r.report.gaps = {{r.time_s[99], r.time_s[100]}};
    return r;
  };
  EXPECT_NO_THROW(refuse_jump_of_clock(with_pause(20.0), "run.csv"));
  EXPECT_THAT(refusal_of([&] { refuse_jump_of_clock(with_pause(1e9), "run.csv"); }),
              testing::HasSubstr("t_s: found nothing from t_s = 9.9 to 1000000010"));
}

// A first row of zeros, before the clock runs, is left out and counted. The other rows are used.
TEST(BadRecording, RowsBeyondAJumpOfTheClockAreCounted) {
  std::ostringstream out;
  out << "t_s,rate_rad_s\n0,0\n";
  for (int i = 0; i < 30; ++i) out << 1733.1 + 0.1 * i << ",1\n";
  const Recording r = read_recording(test_file("zeros.csv", out.str()));
  EXPECT_NO_THROW(refuse_jump_of_clock(r, "zeros.csv"));
  const DataQuality quality = quality_of({{"zeros.csv", r}}, {}, {});
  EXPECT_EQ(quality.rejected.at("isolated_row"), 1);
  EXPECT_EQ(quality.used, 30);
  EXPECT_EQ(quality.rows, 31);
}

// 200 rows of a platform whose rate is read as 0.05 rad/s about its vertical axis.
Recording slowly_turning(double interval_s) {
  std::ostringstream out;
  out << "t_s,q_w,q_x,q_y,q_z,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s\n";
  for (int i = 0; i < 200; ++i) {
    const double half_rad = 0.5 * std::remainder(0.05 * interval_s * i, 6.283185307179586);
    out << interval_s * i << "," << std::cos(half_rad) << ",0,0," << std::sin(half_rad)
        << ",0,0,0.05\n";
  }
  return read_recording(test_file("slowly_turning.csv", out.str()));
}

// Times in microseconds that are read as seconds: between two rows the platform rotates through
// 0.05 rad/s × 1e5 s, and swings at the square root of m g h / I.
TEST(BadRecording, RowsFarApartForTheMotionAreRefused) {
  const auto refuse = [](double interval_s, const AttitudeModel& model) {
    return refusal_of([&] {
      MotionModel::refuse_rows_far_apart(observe(slowly_turning(interval_s), "run.csv"), model);
    });
  };
  AttitudeModel model;
  model.platform.mass_kg = 7.0;
  model.platform.inertia_kg_m2 = Vec3(0.11, 0.11, 0.19).asDiagonal();
  // A day of rows once a minute, and rows of 1000 rad / (0.05 rad/s) = 20,000 s.
  EXPECT_EQ(refuse(60.0, model), "");
  EXPECT_EQ(refuse(19000.0, model), "");
  EXPECT_THAT(refuse(1e5, model),
              testing::AllOf(testing::HasSubstr("run.csv: t_s: found rows 1e+05 s apart, between "
                                                "which the platform rotates or oscillates through "
                                                "5e+03 rad, expected at most 1000 rad"),
                             testing::HasSubstr("t_us")));
  // Without motion the interval is not limited: 12 days.
  Observation at_rest = observe(slowly_turning(1e6), "run.csv");
  for (Vec3& rate : at_rest.gyro_rad_s) rate.setZero();
  EXPECT_NO_THROW(MotionModel::refuse_rows_far_apart(at_rest, model));
  model.disturbances = {make_disturbance_of("static_unbalance", {{"offset_m", {0, 0, -1e-3}}},
                                            {model.platform, model.environment})};
  const double swing_rad_s = std::sqrt(7.0 * 9.80665 * 1e-3 / 0.11);
  EXPECT_EQ(refuse(800.0 / swing_rad_s, model), "");
  EXPECT_THAT(refuse(1100.0 / swing_rad_s, model), testing::HasSubstr("rows 1392 s apart"));
  NominalModel nominal;
  nominal.model = model;
  EXPECT_THAT(refusal_of([&] {
                diagnose(nominal, {{"run.csv", slowly_turning(1e5)}}, {});
              }),
              testing::HasSubstr("rows 1e+05 s apart"));
}

TEST(BadRecording, NoneAtAllIsRefused) {
  EXPECT_THROW(diagnose({}, {}, {}), InputError);
}

}  // namespace
}  // namespace photorque
