// `fit-cell`, and what `power` says beyond the maximum power point, as a user meets them.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "tests/tools/command_test.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class ArrayCommand : public CommandTest {};

// A measured module of 36 cells at two irradiances.
TEST_F(ArrayCommand, FitsADatasheetAndPrintsTheCell) {
  write("fit.toml",
        "[fit]\ncells_in_series = 36\n[[fit.datasheet]]\nirradiance_W_m2 = 1000\n"
        "short_circuit_A = 5.116\nopen_circuit_V = 22.05\nmaximum_A = 4.66\nmaximum_V = 17.63\n"
        "[[fit.datasheet]]\nirradiance_W_m2 = 200\nshort_circuit_A = 1.029\n"
        "open_circuit_V = 20.38\nmaximum_A = 0.939\nmaximum_V = 17.04\n");
  const Outcome got = run("fit-cell " + at("fit.toml") + " --out " + at("out"));
  ASSERT_EQ(got.status, 0) << got.err;
  EXPECT_THAT(got.out, HasSubstr("series_ohm"));
  EXPECT_THAT(got.out, HasSubstr("saturation_1_A = "));
  EXPECT_THAT(file_text(at("out/summary.json")), HasSubstr("\"ideality\""));
  EXPECT_TRUE(fs::exists(at("out/parameters.csv")));
  EXPECT_TRUE(fs::exists(at("out/fit.png")));
}

TEST_F(ArrayCommand, WrongFitsAreOneLineAndLeaveNothing) {
  write("words.csv", "voltage_V,current_A\n0,1\n0.1,x\n");
  write("words.toml", "[fit]\ncurves = [\"words.csv\"]\n");
  write("typo.toml", "[fit]\ncurves = [\"words.csv\"]\nsubstring = 3\n");
  write("none.toml", "[fit]\ncells_in_series = 3\n");
  for (const auto& [file, part] :
       {std::pair{"words.toml", "words.csv:3: current_A: found \"x\""},
        std::pair{"typo.toml", "words.csv:3"}, std::pair{"none.toml", "fit.curves"}}) {
    const Outcome got = run("fit-cell " + at(file) + " --out " + at("out"));
    EXPECT_EQ(got.status, 2) << file;
    EXPECT_THAT(got.err, HasSubstr(part));
    EXPECT_EQ(std::count(got.err.begin(), got.err.end(), '\n'), 1) << got.err;
    EXPECT_FALSE(fs::exists(at("out")));
  }
}

TEST_F(ArrayCommand, PowerReportsLossesTrackersDayTargetAndWiring) {
  const Outcome got =
      run("power " + (fs::path(PHOTORQUE_SOURCE_DIR) / "scenes/stasis/nominal.toml").string() +
          " --set trace.rays=65536 --set attitude.tilt_deg=30"
          " --set 'array.target={power_W=30,efficiency=0.38}' --set 'array.day={load_W=25}'"
          " --set 'array.chain={wall_plug_efficiency=0.45,converter_efficiency=0.95}'"
          " --set 'array.layout={most_tried=20}'"
          " --set 'array.tracker={time_s=[0,4],tilt_deg=[0,30]}' --out " +
          at("out"));
  ASSERT_EQ(got.status, 0) << got.err;
  // 730 nm: hc/λ = 1.698 eV; 0.38 × 1.698 V = 0.645 V; 30 W cos 30° = 25.98 W.
  for (const char* part :
       {"0.58878", "0.645", "25.98", "360 Wh, which is 15 W", "perturb_and_observe",
        "electric power of the lamps", "no wiring above"}) {
    EXPECT_THAT(got.out, HasSubstr(part));
  }
  for (const char* file : {"losses.csv", "uniformity.csv", "trackers.csv", "day.csv",
                           "sensitivities.csv", "layout.csv", "loss_waterfall.png"}) {
    EXPECT_TRUE(fs::exists(at("out") + "/" + file)) << file;
  }
}

TEST_F(ArrayCommand, TrackersNeedAMotion) {
  const Outcome got =
      run("power " + (fs::path(PHOTORQUE_SOURCE_DIR) / "scenes/stasis/nominal.toml").string() +
          " --set 'array.tracker={time_s=[0,4],tilt_deg=[0]}' --out " + at("out"));
  EXPECT_EQ(got.status, 2);
  EXPECT_THAT(got.err, HasSubstr("array.tracker.tilt_deg"));
  EXPECT_FALSE(fs::exists(at("out")));
}

}  // namespace
}  // namespace photorque
