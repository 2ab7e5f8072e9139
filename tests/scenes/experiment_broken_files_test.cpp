// Every way to get an experiment file wrong gives one line that says where and what to write
// instead.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "scenes/experiment/experiment.h"
#include "scenes/experiment/named_files.h"
#include "tests/files.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

const std::filesystem::path stasis =
    std::filesystem::path(PHOTORQUE_SOURCE_DIR) / "scenes/stasis/stasis.gltf";

// A whole experiment; the numbers of its lines are part of the expectations below.
std::vector<std::string> good_lines() {
  return {
      "[scene]",                             // 1
      "file = \"" + stasis.string() + "\"",  // 2
      "bands_nm = [600, 860]",               // 3
      "[[source]]",                          // 4
      "kind = \"led\"",                      // 5
      "power_W = 1.0",                       // 6
      "aperture_diameter_mm = 10",           // 7
      "profile = \"gaussian\"",              // 8
      "fwhm_deg = 3",                        // 9
      "wavelength_nm = 730",                 // 10
      "spectral_fwhm_nm = 30",               // 11
      "position_m = [0, 0, 1]",              // 12
      "direction = [0, 0, -1]",              // 13
      "[[receiver]]",                        // 14
      "node = \"solar_array\"",              // 15
      "bins = [10, 10]",                     // 16
      "[attitude]",                          // 17
      "tilt_deg = 10",                       // 18
      "[trace]",                             // 19
      "rays = 65536",                        // 20
      "[torque_map]",                        // 21
      "tilt_deg = [0, 30]",                  // 22
      "[camera]",                            // 23
      "width = 640",                         // 24
  };
}

struct Broken {
  std::string name;
  int line;             // to replace (text may hold more lines); 0: keep all
  std::string text;     // in its place; of a whole experiment if `line` is −1
  std::string where;    // the message after the file's name begins so
  std::string message;  // and holds this
};

std::string join(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

std::string message_of(const std::filesystem::path& path) {
  return refusal_of([&] { resolve_experiment(read_experiment_file(path)); });
}

class BrokenExperiment : public testing::TestWithParam<Broken> {};

TEST_P(BrokenExperiment, GivesOneLineWithPlaceKeyAndExpectation) {
  const Broken& broken = GetParam();
  std::vector<std::string> lines = good_lines();
  if (broken.line > 0) lines[static_cast<size_t>(broken.line - 1)] = broken.text;
  const std::string text = broken.line < 0 ? broken.text : join(lines);
  const auto path = test_file("broken_" + broken.name + ".toml", text);
  const std::string message = message_of(path);
  EXPECT_EQ(message.rfind(path.string() + broken.where, 0), 0u) << message;
  EXPECT_THAT(message, testing::HasSubstr(broken.message));
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

TEST(Experiment, TheUnbrokenFileIsRead) {
  EXPECT_EQ(message_of(test_file("unbroken.toml", join(good_lines()))), "");
}

const Broken cases[] = {
    // TOML
    {"unclosed_text", 5, "kind = \"led", ":5", "syntax error"},
    {"unclosed_array", 12, "position_m = [0, 0, 1", ":13", "syntax error"},
    {"no_value", 6, "power_W =", ":6", "a value behind power_W ="},
    {"no_quotes", 5, "kind = led", ":5", "text in quotes: kind = \"led\""},
    {"decimal_comma", 6, "power_W = 2,5", ":6", "a decimal point: power_W = 2.5"},
    {"key_twice", 7, "power_W = 2", ":7", "syntax error"},
    {"not_utf8", 8, "profile = \"\xff\"", ":8", "syntax error"},
    {"binary", -1, std::string("glTF\x02\x00\x00\x00", 8), ":1", "bytes that are no text"},
    // Tables
    {"empty_file", -1, "", ":1: scene", "expected a table [scene] with a file"},
    {"scene_not_a_table", -1, "scene = 3", ":1: scene", "found 3, expected a table"},
    {"scene_without_file", 2, "", ":1: scene.file", "found nothing, expected a text in quotes"},
    {"unknown_table", 17, "[atitude]", ":17: atitude", "perhaps \"attitude\""},
    {"sources_not_tables", -1, "source = [1]\n[scene]\nfile = \"x\"", ":1: source[0]",
     "found 1, expected a table"},
    {"no_source", -1, "[scene]\nfile = \"" + stasis.string() + "\"\n", ":1: source",
     "expected at least one [[source]]"},
    // Scene
    {"missing_scene", 2, "file = \"missing.gltf\"", ":2: scene.file",
     "found \"missing.gltf\", expected an existing file, relative to the folder of the experiment"},
    {"scene_is_a_folder", 2, "file = \".\"", ":2: scene.file", "found \".\""},
    {"scene_file_a_number", 2, "file = 7", ":2: scene.file", "found 7, expected a text in quotes"},
    {"unit_zero", 2, "file = \"x.gltf\"\nmetres_per_unit = 0", ":3: scene.metres_per_unit",
     "found 0, expected a number > 0"},
    {"bands_descend", 3, "bands_nm = [860, 600]", ":3: scene.bands_nm", "numbers in rising order"},
    {"one_band_edge", 3, "bands_nm = [600]", ":3: scene.bands_nm",
     "found 1 edges, expected from 2 to 9 edges"},
    {"ten_bands", 3, "bands_nm = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10]", ":3: scene.bands_nm",
     "found 11 edges"},
    {"negative_band", 3, "bands_nm = [-1, 860]", ":3: scene.bands_nm", "found -1"},
    {"bands_a_text", 3, "bands_nm = \"red\"", ":3: scene.bands_nm", "an array of numbers"},
    {"spectrum_outside", 3, "bands_nm = [400, 700]", ":4: source[0]",
     "of its power outside the bands, expected [scene] bands_nm that hold all of it"},
    {"unknown_scene_key", 3, "band_nm = [600, 860]", ":3: scene.band_nm", "perhaps \"bands_nm\""},
    {"unknown_material", 1, "[[material]]\nname = \"solar_cel\"\nabsorptance = 1\n[scene]",
     ":2: material[0].name", "solar_cell"},
    {"surface_beyond_one", 1,
     "[[material]]\nname = \"solar_cell\"\nabsorptance = 0.9\nspecular = 0.2\n[scene]", ":",
     "material[0]"},
    // Sources
    {"no_kind", 5, "", ":4: source[0].kind", "expected one of \"led\""},
    {"unknown_kind", 5, "kind = \"lod\"", ":5: source[0].kind", "did you mean \"led\"?"},
    {"negative_power", 6, "power_W = -3", ":6: source[0].power_W",
     "found -3, expected a number > 0"},
    {"power_a_text", 6, "power_W = \"much\"", ":6: source[0].power_W", "found \"much\""},
    {"power_not_finite", 6, "power_W = nan", ":6: source[0].power_W", "found nan"},
    {"power_in_two_units", 6, "power_W = 1\npower_mW = 1000", ":", "it once"},
    {"missing_unit", 9, "fwhm = 3", ":9: source[0].fwhm", "fwhm_deg"},
    {"unknown_profile", 8, "profile = \"gausian\"", ":8: source[0].profile",
     "did you mean \"gaussian\"?"},
    {"no_direction", 13, "direction = [0, 0, 0]", ":13: source[0].direction", "[0, 0, 0]"},
    {"two_coordinates", 12, "position_m = [0, 1]", ":12: source[0].position_m",
     "found an array of 2, expected an array of 3 numbers"},
    {"unknown_source_key", 6, "power_W = 1\npowr_W = 2", ":7: source[0].powr_W",
     "perhaps \"power_W\""},
    // Receivers
    {"unknown_node", 15, "node = \"solar_aray\"", ":15: receiver[0].node",
     "perhaps \"solar_array\""},
    {"no_node", 15, "", ":14: receiver[0].", "found nothing"},
    {"unknown_receiver_kind", 15, "node = \"solar_array\"\nkind = \"flux_mapp\"",
     ":16: receiver[0].kind", "did you mean \"flux_map\"?"},
    {"one_bin_number", 16, "bins = [10]", ":16: receiver[0].bins", "two whole numbers"},
    {"fractional_bins", 16, "bins = [10, 2.5]", ":16: receiver[0].bins", "found 2.5"},
    {"unknown_receiver_key", 16, "bin = [10, 10]", ":16: receiver[0].bin", "perhaps \"bins\""},
    {"same_receiver_twice", 16, "bins = [10, 10]\n[[receiver]]\nnode = \"solar_array\"",
     ":17: receiver[1].name", "a second flux_map called \"solar_array\""},
    // Attitude, trace, torque map, camera
    {"tilt_beyond_180", 18, "tilt_deg = 181", ":18: attitude.tilt_deg",
     "found 181, expected a number in [0, 180] deg"},
    {"unknown_attitude_key", 18, "tild_deg = 3", ":18: attitude.tild_deg", "perhaps \"tilt_deg\""},
    {"no_rays", 20, "rays = 0", ":20: trace.rays", "expected a whole number from 1"},
    {"half_a_ray", 20, "rays = 0.5", ":20: trace.rays", "found 0.5, expected a whole number"},
    {"few_replicates", 20, "replicates = 7", ":20: trace.replicates",
     "found 7, expected a whole number from 8"},
    {"negative_seed", 20, "seed = -1", ":20: trace.seed", "found -1"},
    {"no_depth", 20, "max_depth = 0", ":20: trace.max_depth", "found 0"},
    {"cutoff_one", 20, "cutoff = 1", ":20: trace.cutoff", "expected a number in [0, 1)"},
    {"no_arriving_rays", 20, "arriving_rays = 0", ":20: trace.arriving_rays", "found 0"},
    {"grid_empty", 22, "tilt_deg = []", ":22: torque_map.tilt_deg", "at least one number"},
    {"grid_repeats", 22, "tilt_deg = [0, 10, 10]", ":22: torque_map.tilt_deg",
     "numbers in rising order"},
    {"grid_a_number", 22, "heading_deg = 30", ":22: torque_map.heading_deg",
     "found 30, expected an array of numbers"},
    {"flat_camera", 24, "field_of_view_deg = 180", ":24: camera.field_of_view_deg", "found 180"},
    {"blind_camera", 24, "position_m = [0, 0, 1]\ntarget_m = [0, 0, 1]", ":24: camera.position_m",
     "a point away from target_m"},
    {"tiny_picture", 24, "width = 3", ":24: camera.width", "found 3"},
};

INSTANTIATE_TEST_SUITE_P(AllCases, BrokenExperiment, testing::ValuesIn(cases),
                         [](const auto& tested) { return tested.param.name; });

TEST(BrokenScene, WithoutTrianglesIsRefused) {
  const auto scene = test_file("empty.gltf", R"({"asset": {"version": "2.0"}, "scene": 0,
      "scenes": [{"nodes": [0]}], "nodes": [{"name": "nothing"}]})");
  std::vector<std::string> lines = good_lines();
  lines[1] = "file = \"empty.gltf\"";
  const std::string message = message_of(test_file("empty_scene.toml", join(lines)));
  EXPECT_EQ(message,
            scene.string() + ": found no triangles, expected a scene with at least one mesh");
}

TEST(BrokenScene, ThatIsNoJsonIsRefused) {
  const auto scene = test_file("text.gltf", "no glTF");
  std::vector<std::string> lines = good_lines();
  lines[1] = "file = \"text.gltf\"";
  const std::string message = message_of(test_file("text_scene.toml", join(lines)));
  EXPECT_EQ(message.rfind(scene.string(), 0), 0u) << message;
}

// Found by reading for it: a sweep that looks for a model's files followed its brackets to the end
// of the stack.
TEST(BrokenScene, ThatIsNestedDeeplyNamesNoFiles) {
  constexpr size_t deep = 300000;
  const std::string model = R"({"asset": {"version": "2.0"}, "extras": )" + std::string(deep, '[') +
                            std::string(deep, ']') + "}";
  EXPECT_TRUE(files_named_in("/nowhere/model.gltf", model).empty());
}

TEST(NamedFiles, OfAModelWithACapitalEndingAreFound) {
  const auto buffer = test_file("capital.bin", "b");
  EXPECT_THAT(files_named_in(buffer.parent_path() / "CAPITAL.GLTF",
                             R"({"buffers": [{"uri": "capital.bin"}]})"),
              testing::ElementsAre(buffer));
}

}  // namespace
}  // namespace photorque
