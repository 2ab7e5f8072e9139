// The commands camera and estimate as a user meets them.
#include <nlohmann/json.hpp>

#include "tests/tools/command_test.h"

namespace photorque {
namespace {

using nlohmann::json;
using testing::HasSubstr;

const fs::path source = PHOTORQUE_SOURCE_DIR;
const std::string tracked = (source / "scenes/stasis/camera.toml").string();

class TrackingCommands : public CommandTest {};

TEST_F(TrackingCommands, TheStatedBoardAndLensGiveThePapersErrors) {
  const Outcome got =
      succeed("camera " + tracked +
              " --set camera_study.images=100 --set camera_study.grid=5 --json --out " + at("o"));
  const json summary = json::parse(got.out);
  EXPECT_NEAR(value(summary, "in_plane_error_arcsec"), 12.0, 1.0);
  EXPECT_NEAR(value(summary, "out_of_plane_error_arcsec"), 37.0, 2.0);
  const auto all = files("o");
  for (const char* name : {"design.png", "error_over_tilt.png", "out_of_plane_error.png",
                           "degradation.csv", "images.csv", "markers.csv"}) {
    EXPECT_TRUE(all.contains(name)) << name;
  }
}

TEST_F(TrackingCommands, ACameraWithoutMarkersIsNoneToStudy) {
  EXPECT_THAT(refused("camera " + attitude_file + " --out " + at("o")),
              HasSubstr("sensors.camera.markers_m"));
}

// The platform's own plate stands between a camera below it and the markers above.
TEST_F(TrackingCommands, ThePlatformHidesItsMarkers) {
  succeed("propagate " + tracked +
          " --set propagate.duration_s=1 --set propagate.initial_tilt_deg=0 --set "
          "'sensors.camera.position_m=[0.9,0,-0.35]' --set "
          "'sensors.camera.marker_normal=[1,0,0]' --set "
          "sensors.camera.exposure_us=5 --out " +
          at("o"));
  EXPECT_THAT(file_text(at("o/recording.csv")), HasSubstr("0.5,,,,,"));
}

TEST_F(TrackingCommands, EstimatesAreRecordingsThatOthersRead) {
  const std::string brief =
      " --set propagate.duration_s=30 --set propagate.output_rate_Hz=5 --set estimate.runs=2 ";
  const Outcome simulated = succeed("estimate " + tracked + brief + "--out " + at("s"));
  EXPECT_THAT(simulated.out, HasSubstr("95 % band"));
  succeed("propagate " + tracked + brief + "--out " + at("p"));
  const Outcome got = succeed("estimate " + tracked + " --recording " + at("p/recording.csv") +
                              " --truth " + at("p/time_history.csv") + " --json --out " + at("e"));
  const json summary = json::parse(got.out);
  EXPECT_LT(value(summary, "smoother_error_arcsec"), value(summary, "filter_error_arcsec"));
  EXPECT_LT(value(summary, "filter_error_arcsec"), 40.0);
  // A truth of another time contains no row of these.
  const std::string later = write("later.csv",
                                  "t_s,q_w,q_x,q_y,q_z\n1e9,1,0,0,0\n1000000001,1,0,0,0\n"
                                  "1000000002,1,0,0,0\n");
  EXPECT_THAT(refused("estimate " + tracked + " --recording " + at("p/recording.csv") +
                      " --truth " + later + " --out " + at("l")),
              HasSubstr("later.csv: t_s: found no time of the recording"));
  EXPECT_THAT(refused("estimate " + tracked + " --recording " + at("p/recording.csv") +
                      " --set recording.foo=1 --out " + at("m")),
              HasSubstr("recording.foo"));
  succeed("balance " + tracked + " --set balance.moving_mass_kg=0.25 --set " +
          "balance.lead_mm=2 --recording " + at("e/smoothed.csv") + " --out " + at("b"));
}

// Notes on a recording, and channels that cannot be compared.
TEST_F(TrackingCommands, AnEstimateListsUnreadableRows) {
  std::string rows = "t_s,q_w,q_x,q_y,q_z,wx,gyro_y_rad_s,gyro_z_rad_s\n",
              truth = "t_s,q_w,q_x,q_y,q_z\n";
  for (int i = 0; i < 100; ++i) {
    const std::string time = std::to_string(0.1 * i);
    rows += time + ",0,0,0,0," + std::to_string(1e-6 * (i % 3)) + ",1e-6,-1e-6\n";
    if (i < 4) truth += time + ",1,0,0,0\n";
  }
  const std::string recording = write("zero.csv", rows), start = write("start.csv", truth);
  const std::string named = " --set recording.columns.gyro_x_rad_s=wx ";
  const Outcome got =
      succeed("estimate " + tracked + named + "--recording " + recording + " --out " + at("z"));
  EXPECT_THAT(got.out, HasSubstr("100 quaternions that are not of unit norm left out"));
  EXPECT_THAT(got.out, HasSubstr("no attitude was measured"));
  // Four of a hundred rows lie in the twentieth in which the filter settles.
  EXPECT_THAT(refused("estimate " + tracked + named + "--recording " + recording + " --truth " +
                      start + " --out " + at("t")),
              HasSubstr("start.csv: t_s: found no time of the recording from 0.5 s on"));
  const std::string masses = " --set balance.moving_mass_kg=0.25 --set balance.lead_mm=2";
  for (const std::string& command :
       {"estimate " + tracked, "diagnose " + tracked, "balance " + tracked + masses}) {
    const std::string absent =
        refused(command + " --set recording.columns.gyro_x_rad_s=w_x --recording " + recording +
                " --out " + at("a"));
    EXPECT_THAT(
        absent,
        HasSubstr("recording.columns.gyro_x_rad_s: found \"w_x\", which the recording has not"));
  }
}

}  // namespace
}  // namespace photorque
