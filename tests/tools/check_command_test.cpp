// photorque check: planted mistakes are found with one line each, and what is shipped has none.
#include "tests/tools/command_test.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const fs::path shipped = fs::path(PHOTORQUE_SOURCE_DIR) / "scenes";

class CheckCommand : public CommandTest {
 protected:
  // STASIS with one thing changed, beside its scene.
  std::string planted(const std::string& file, const std::string& from, const std::string& to) {
    std::string text = file_text(shipped / "stasis" / file);
    const std::string scene = "\"" + (shipped / "stasis" / "stasis.gltf").string() + "\"";
    if (const size_t at = text.find("\"stasis.gltf\""); at != std::string::npos) {
      text.replace(at, 13, scene);
    }
    fs::copy_file(shipped / "stasis" / "light_torque.csv", folder_ / "light_torque.csv",
                  fs::copy_options::overwrite_existing);
    const size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return write(file, text.replace(at, from.size(), to));
  }
};

TEST_F(CheckCommand, WhatIsShippedHasNoMistake) {
  size_t checked = 0;
  for (const auto& entry : fs::recursive_directory_iterator(shipped)) {
    if (entry.path().extension() != ".toml" || entry.path().stem() == "parameters") continue;
    const Outcome got = run("check " + entry.path().string());
    EXPECT_EQ(got.status, 0) << entry.path() << got.err;
    EXPECT_EQ(got.err, "");
    ++checked;
  }
  EXPECT_GE(checked, 9u);
}

TEST_F(CheckCommand, SaysWhatEachCommandWouldDo) {
  const Outcome got = run("check " + (shipped / "stasis" / "nominal.toml").string());
  for (const std::string line :
       {"trace       12845056 rays of 49 lamps, 88 W, onto solar_array",
        "power       16 cells on solar_array", "torque-map  7 tilts × 8 headings",
        "render      1280 × 960 pixels"}) {
    EXPECT_THAT(got.out, HasSubstr(line));
  }
}

struct Planted {
  std::string file, from, to;  // the mistake
  std::string line, said;      // where it is found, and what the line says
};

TEST_F(CheckCommand, FindsPlantedMistakesWithOneLineEach) {
  const std::vector<Planted> mistakes = {
      {"nominal.toml", "fwhm_deg = 3.0", "fwhm_dge = 3.0", ":18: source[0].fwhm_deg",
       "is \"fwhm_dge\" in line 26 meant?"},
      {"nominal.toml", "wavelength_nm = 730", "wavelength_nm = 1730", ":18: source[0]",
       "outside the bands"},
      {"nominal.toml", "position_m = [0, 0, 1.0]", "position_m = [0, 0, 0]",
       ":30: source[0].position_m", "inside of"},
      {"nominal.toml", "direction = [0, 0, -1]", "direction = [0, 0, 1]",
       ":31: source[0].direction", "misses the scene"},
      {"nominal.toml", "node = \"solar_array\"", "node = \"solar_aray\"", ":36: receiver[0].node",
       "perhaps \"solar_array\""},
      {"nominal.toml", "[[receiver]]\nkind = \"wrench\"",
       "[[receiver]]\nnode = \"bottom_plate\"\nfacing = [0, 0, -1]\n\n[[receiver]]\nkind = "
       "\"wrench\"",
       "receiver[1].node", "no light reaches"},
      {"nominal.toml", "gap_mm = 1.0", "gap_mm = 500", "array", "room for 4 cells"},
      {"nominal.toml", "[trace]", "[trase]", "trase", "perhaps \"trace\""},
      {"attitude.toml", "mass_kg = 6.99995", "mass_kg = -7", "platform.mass_kg", "> 0"},
      {"attitude.toml", "[[0.0893128, 0, 0]", "[[0.9893128, 0, 0]", "platform.inertia_kg_m2", ""},
      {"attitude.toml", "kind = \"static_unbalance\"", "kind = \"static_unbalanse\"",
       "disturbance[0].kind", "static_unbalance"},
      {"attitude.toml", "[balance]", "[balance]\nmases = 3", "balance.mases", "unknown"},
  };
  for (const Planted& mistake : mistakes) {
    const Outcome got = run("check " + planted(mistake.file, mistake.from, mistake.to));
    EXPECT_EQ(got.status, 2) << mistake.to;
    EXPECT_EQ(std::count(got.err.begin(), got.err.end(), '\n'), 1) << got.err;
    EXPECT_THAT(got.err, HasSubstr(mistake.line)) << mistake.to;
    EXPECT_THAT(got.err, HasSubstr(mistake.said)) << mistake.to;
  }
}

TEST_F(CheckCommand, FindsTheMistakesOfDifferentTablesTogether) {
  const std::string file = planted("nominal.toml", "gap_mm = 1.0", "gap_mm = 500");
  const Outcome got =
      run("check " + file + " --set platform.mass_kg=0 --set source[0].direction=[0,0,1]");
  EXPECT_EQ(got.status, 2);
  EXPECT_EQ(std::count(got.err.begin(), got.err.end(), '\n'), 3) << got.err;
}

TEST_F(CheckCommand, NewWritesWhatRuns) {
  const std::string model = (shipped / "stasis" / "stasis.gltf").string();
  const Outcome lit = run("new " + at("lab/lit.toml") + " --scene " + model);
  ASSERT_EQ(lit.status, 0) << lit.err;
  EXPECT_THAT(file_text(at("lab/lit.toml")), HasSubstr("array_board/solar_array"));
  const Outcome traced = run("trace " + at("lab/lit.toml") + " --out " + at("out"));
  EXPECT_EQ(traced.status, 0) << traced.err;
  const std::string free = at("lab/free.toml");
  ASSERT_EQ(run("new " + free).status, 0);
  const Outcome moved = run("propagate " + free + " --out " + at("out2"));
  EXPECT_EQ(moved.status, 0) << moved.err;
  // What is there stays.
  const std::string before = file_text(free);
  EXPECT_EQ(run("new " + free + " --scene " + model).status, 2);
  EXPECT_EQ(file_text(free), before);
}

}  // namespace
}  // namespace photorque
