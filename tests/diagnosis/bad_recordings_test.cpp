// Recordings that hold no motion of a platform are refused in one line that names the channel.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "attitude/estimation/segments.h"
#include "attitude/observation/observation.h"
#include "core/errors.h"
#include "diagnosis/attitude/diagnose.h"
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

TEST(BadRecording, QuaternionsWithoutLengthAreNoAttitude) {
  EXPECT_THAT(complaint_of(repeated_row("t_s,q_w,q_x,q_y,q_z", "0,0,0,0", 200)),
              testing::HasSubstr("0 complete"));
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

TEST(BadRecording, NoneAtAllIsRefused) {
  EXPECT_THROW(diagnose({}, {}, {}), InputError);
}

}  // namespace
}  // namespace photorque
