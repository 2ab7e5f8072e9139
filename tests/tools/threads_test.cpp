// Every command gives the same files, to the last bit, on one thread and on seven.
#include <regex>

#include "tests/tools/command_test.h"

namespace photorque {
namespace {

struct Command {
  std::string name, arguments;  // SCENES and CASE are folders of the sources, HERE the test's own
};

constexpr const char* sunlit = R"([scene]
file = "hollow.gltf"
[[source]]
kind = "sun"
direction = [0.3, 0, -1]
[[receiver]]
kind = "wrench"
[trace]
direct = "rays"
rays = 4096
[torque_map]
azimuth_step_deg = 90
elevation_step_deg = 90
rays = 4096
[sweep]
verb = "trace"
maximise = "absorbed_W"
global = 6
local = 6
[[sweep.axis]]
key = "attitude.tilt_deg"
from = 0
to = 60
count = 4
)";

constexpr const char* datasheet = R"([fit]
cells_in_series = 36
[[fit.datasheet]]
short_circuit_A = 5.116
open_circuit_V = 22.05
maximum_A = 4.66
maximum_V = 17.63
[[fit.datasheet]]
irradiance_W_m2 = 200
short_circuit_A = 1.029
open_circuit_V = 20.38
maximum_A = 0.939
maximum_V = 17.04
)";

const std::string few = " --set trace.rays=16384";
const std::vector<Command> commands = {
    {"trace", "trace SCENES/stasis/nominal.toml --page --set trace.arriving_rays=10000" + few},
    {"power", "power SCENES/stasis/nominal.toml" + few},
    {"torque_map", "torque-map SCENES/stasis/nominal.toml" + few +
                       " --set torque_map.tilt_deg=[0,10] --set torque_map.heading_deg=[0,180]"},
    {"torque_map_of_sunlight", "torque-map HERE/sunlit.toml"},
    {"render",
     "render SCENES/stasis/nominal.toml" + few + " --set camera.width=160 --set camera.height=120"},
    {"budget", "budget SCENES/stasis/attitude.toml"},
    {"propagate", "propagate SCENES/stasis/attitude.toml --set propagate.duration_s=20"},
    {"propagate_with_traced_light",
     "propagate SCENES/stasis/day.toml --set propagate.duration_s=1 --set light.mode=trace"
     " --set light.rays=12544"},
    {"balance", "balance SCENES/stasis/attitude.toml --recording HERE/recording.csv"},
    {"sweep", "sweep HERE/sunlit.toml"},
    {"optimise", "optimise HERE/sunlit.toml"},
    {"diagnose", "diagnose CASE/experiment.toml --recording CASE/run1.csv.gz"},
    {"fit_cell", "fit-cell HERE/datasheet.toml"},
    {"camera", "camera SCENES/stasis/camera.toml"},
    {"estimate",
     "estimate SCENES/stasis/camera.toml --set propagate.duration_s=20"
     " --set propagate.output_rate_Hz=5 --set estimate.runs=1"},
    {"supply", "supply SCENES/stasis/supply.toml"}};

class Threads : public CommandTest, public ::testing::WithParamInterface<Command> {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    fs::copy(shipped_scenes / "hollow" / "hollow.gltf", at("hollow.gltf"));
    write("sunlit.toml", sunlit);
    write("datasheet.toml", datasheet);
    if (GetParam().name != "balance") return;
    const std::string flight =
        "propagate " + attitude_file + " --set propagate.duration_s=60 --out " + at("flight");
    succeed(flight);
    fs::copy(at("flight/recording.csv"), at("recording.csv"));
  }

  std::string arguments() const {
    std::string text = GetParam().arguments;
    const fs::path sources = PHOTORQUE_SOURCE_DIR;
    text = std::regex_replace(text, std::regex("SCENES"), (sources / "scenes").string());
    text = std::regex_replace(text, std::regex("CASE"),
                              (sources / "tests" / "data" / "cases" / "01").string());
    return std::regex_replace(text, std::regex("HERE"), folder_.string());
  }

  // Every file by its path, without values of the clock.
  std::map<std::string, std::string> results() const {
    static const std::regex wall_time("\"wall_time_s\": [^\n]*");
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(at("out"))) {
      const std::string name = entry.path().filename().string();
      if (!entry.is_regular_file()) continue;
      if (name.starts_with("designs.")) continue;  // a database, whose pages are as they came
      std::string text = file_text(entry.path());
      if (name.ends_with(".json")) text = std::regex_replace(text, wall_time, "");
      all[fs::relative(entry.path(), at("out")).string()] = text;
    }
    return all;
  }
};

TEST_P(Threads, OfAnyNumberGiveTheSameFiles) {
  std::map<std::string, std::string> first;
  for (const std::string threads : {"1", "7"}) {
    fs::remove_all(at("out"));
    succeed(arguments() + " --quiet --threads " + threads + " --out " + at("out"));
    const std::map<std::string, std::string> now = results();
    if (first.empty()) first = now;
    ASSERT_EQ(now.size(), first.size());
    EXPECT_GE(now.size(), 2u);
    for (const auto& [file, bytes] : first) {
      EXPECT_TRUE(now.contains(file) && now.at(file) == bytes) << file << ", " << threads;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, Threads, ::testing::ValuesIn(commands),
                         [](const auto& command) { return command.param.name; });

}  // namespace
}  // namespace photorque
