// Inputs that a run refuses, and inputs that it warns of: each was once accepted, or ended the
// program.
#include <nlohmann/json.hpp>

#include "tests/tools/command_test.h"
#include "tools/runs/memory.h"

namespace photorque {
namespace {

using testing::HasSubstr;

const std::string quick_run = " --set trace.rays=16384", endless_run = " --set trace.rays=3e10";

class Limits : public CommandTest {
 protected:
  void expect_refused(const std::string& arguments, const std::string& words) const {
    expect_refusal(arguments + " --out " + at("o"), words);
    EXPECT_FALSE(fs::exists(at("o")));
  }
};

TEST_F(Limits, MapsThatDoNotFitIntoMemoryAreRefusedBeforeTheWork) {
  expect_refused(
      "trace " + nominal_file + endless_run + " --set receiver[0].bins=[4096,4096] --max-memory 2",
      "expected at most 2 GB (--max-memory)");
}

TEST_F(Limits, MemoryLeftIsThatOfTheControlGroupAndOfThoseAboveIt) {
  const auto state_group = [&](const std::string& folder, const std::string& most) {
    fs::create_directories(at(folder));
    std::ofstream(at(folder) + "/memory.max") << most << "\n";
    std::ofstream(at(folder) + "/memory.current") << "1000\n";
  };
  state_group("groups", "max");
  EXPECT_FALSE(left_of_group_bytes(at("groups"), ""));
  state_group("groups/job/step", "9000");
  EXPECT_EQ(left_of_group_bytes(at("groups"), "job/step"), 8000u);
  EXPECT_FALSE(left_of_group_bytes(at("groups"), "job"));
  state_group("groups/job", "5000");
  EXPECT_EQ(left_of_group_bytes(at("groups"), "job/step"), 4000u);
  state_group("groups/job", "500");
  EXPECT_EQ(left_of_group_bytes(at("groups"), "job/step"), 0u);
}

TEST_F(Limits, MemoryIsHeldWhereItIsAllowed) {
  succeed("trace " + nominal_file + quick_run + " --max-memory 2 --out " + at("o"));
}

TEST_F(Limits, MemoryThatHoldsNoRunOrIsNoNumberIsRefused) {
  for (const std::string much : {"0.1", "nan", "inf"}) {
    EXPECT_THAT(refused("trace " + nominal_file + quick_run + " --max-memory " + much + " --out " +
                        at("o")),
                HasSubstr("--max-memory"))
        << much;
  }
}

TEST_F(Limits, ValuesBeyondThoseOfAnyRunAreRefusedBeforeTheWork) {
  const std::string trace = "trace " + nominal_file, endless_trace = trace + endless_run;
  expect_refused(endless_trace + " --set receiver[0].name=" + std::string(400, 'x'), "400 letters");
  expect_refused(endless_trace + " --set receiver[1].node=solar_array --set receiver[1].name=body",
                 "expected another name");
  expect_refused(trace + " --max-time 0", "--max-time: found 0, expected a number of seconds > 0");
  expect_refused(trace + " --set source[0].aperture_diameter_m=1e11",
                 "expected an opening of at most 1e9 m");
  expect_refused("trace /dev/zero", "/dev/zero: found a device, expected a file");
  expect_refused("propagate " + attitude_file + " --set propagate.epoch=2016-12-31T23:59:60",
                 "expected no leap second");
  expect_refused("propagate " + attitude_file +
                     " --set platform.battery_capacity_Ah=1 --set propagate.initial_charge_Ah=2",
                 "expected at most the 1.000000 of platform.battery_capacity_Ah");
}

// The stasis model as its buffer inside the file; here the buffer lies elsewhere, behind a link.
TEST_F(Limits, LinksOutOfTheModelsFolderAreFollowedOnlyWhenAllowed) {
  nlohmann::json model =
      nlohmann::json::parse(file_text(shipped_scenes / "dumbbell" / "dumbbell.gltf"));
  const std::string uri = model["buffers"][0]["uri"];
  ASSERT_TRUE(uri.starts_with("data:"));
  fs::create_directories(at("model"));
  nlohmann::json image = {{"uri", "link.bin"}, {"byteLength", 4}};
  model["buffers"].push_back(image);
  write("secret.bin", "1234");
  fs::create_symlink(at("secret.bin"), at("model/link.bin"));
  write("model/dumbbell.gltf", model.dump());
  const std::string experiment =
      write("model/e.toml", file_text(shipped_scenes / "dumbbell" / "dumbbell.toml"));
  expect_refused("trace " + experiment + quick_run, "a link or path out of its folder");
  succeed("trace " + experiment + quick_run + " --allow-outside --out " + at("o"));
}

TEST_F(Limits, CoincidentFacesAreNamed) {
  nlohmann::json model =
      nlohmann::json::parse(file_text(shipped_scenes / "dumbbell" / "dumbbell.gltf"));
  size_t with_mesh = 0;
  while (!model["nodes"][with_mesh].contains("mesh")) ++with_mesh;
  nlohmann::json copied_node = model["nodes"][with_mesh];
  copied_node["name"] = "twin";
  copied_node.erase("children");
  model["nodes"].push_back(copied_node);
  bool placed = false;
  for (auto& node : model["nodes"]) {
    if (!node.contains("children")) continue;
    for (const auto& child : node["children"]) placed = placed || child == with_mesh;
    if (!placed) continue;
    node["children"].push_back(model["nodes"].size() - 1);
    break;
  }
  if (!placed) model["scenes"][0]["nodes"].push_back(model["nodes"].size() - 1);
  write("dumbbell.gltf", model.dump());
  const std::string experiment =
      write("e.toml", file_text(shipped_scenes / "dumbbell" / "dumbbell.toml"));
  const Outcome got = succeed("trace " + experiment + quick_run + " --out " + at("o"));
  EXPECT_THAT(
      got.out,
      HasSubstr(
          "twin\" coincide and face the same way: light from the front meets only the first"));
}

TEST_F(Limits, SelftestPasses) {
  const Outcome got = succeed("selftest");
  EXPECT_THAT(got.out, HasSubstr(" checks, 0 wrong"));
  const auto json = nlohmann::json::parse(succeed("selftest --json").out);
  EXPECT_EQ(json["wrong"], 0);
  EXPECT_EQ(static_cast<size_t>(std::ranges::count(got.out, '\n')), json["checks"].size() + 1);
}

}  // namespace
}  // namespace photorque
