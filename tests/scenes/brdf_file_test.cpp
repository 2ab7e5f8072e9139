// Tables of measured scattering, from text to the surface of a material.
#include "core/constants.h"
#include "gltf_test_model.h"
#include "raytrace/surfaces/bsdf.h"
#include "scenes/surfaces/settings.h"
#include "tests/files.h"
#include "tests/refusal.h"
#include "tests/settings.h"

namespace photorque {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::string small_table =
    "# a goniometer\n\n"
    "scatter_deg, incidence_deg,azimuth_deg,brdf_1_sr,sigma\r\n"
    "0,60,0,0.3,0\r\n60,60,0,0.2,0\r\n0,0,0,0.1,0\r\n60,0,0,0.3,0\r\n";

std::string brdf_error(const std::string& text) {
  return refusal_of([&] { read_brdf(text, "scan.csv"); });
}

TEST(BrdfFile, TakesColumnsAndRowsInAnyOrder) {
  const BrdfTable table = read_brdf(small_table, "scan.csv");
  EXPECT_THAT(table.incidence_rad, ElementsAre(0.0, 60 * degree_rad));
  EXPECT_THAT(table.scatter_rad, ElementsAre(0.0, 60 * degree_rad));
  EXPECT_THAT(table.azimuth_rad, ElementsAre(0.0));
  EXPECT_THAT(table.brdf_1_sr, ElementsAre(0.1, 0.3, 0.3, 0.2));
}

TEST(BrdfFile, NamesTheLineOfTheMistake) {
  EXPECT_EQ(brdf_error(replaced(small_table, "brdf_1_sr", "brdf")),
            "scan.csv:3: brdf_1_sr: found no such column, expected a header with incidence_deg, "
            "scatter_deg, azimuth_deg and brdf_1_sr");
  EXPECT_EQ(brdf_error(replaced(small_table, "60,60,0,0.2", "60,60,0,-0.2")),
            "scan.csv:5: brdf_1_sr: found \"-0.2\", expected a number from 0 to 1e+09");
  EXPECT_EQ(brdf_error(replaced(small_table, "60,60,0", "95,60,0")),
            "scan.csv:5: scatter_deg: found \"95\", expected a number from 0 to 90");
  EXPECT_EQ(brdf_error(replaced(small_table, "0,0,0,0.1,0", "0,0,0,0.1")),
            "scan.csv:6: found 4 fields, expected 5, as in the header");
  EXPECT_EQ(brdf_error(replaced(small_table, "0,0,0,0.1", "0,60,0,0.1")),
            "scan.csv:6: found angles that an earlier row has, expected each once");
  EXPECT_THAT(brdf_error(replaced(small_table, "0,0,0,0.1,0\r\n", "")),
              HasSubstr("found no row for incidence 0, scatter 0, azimuth 0 deg"));
  EXPECT_THAT(brdf_error("# nothing\n"), HasSubstr("scan.csv: found no rows"));
}

Settings material_with(SettingsNode::Table table) {
  table["name"] = {"paint"};
  return test::settings_of(std::move(table), "material[0]");
}

GltfModel painted_with(const Settings& material, const std::string& brdf) {
  TestModel model = triangle_model();
  model.json["materials"] = nlohmann::json::array({{{"name", "paint"}}});
  model.json["meshes"][0]["primitives"][0]["material"] = 0;
  GltfOptions options;
  options.materials = {material};
  options.material_file = [&](const std::string& name) -> std::optional<std::string> {
    if (name != "scan.csv") return std::nullopt;
    return brdf;
  };
  return model.read(options);
}

TEST(MeasuredMaterial, ScattersByItsFileWhichIsAnInput) {
  const GltfModel model =
      painted_with(material_with({{"brdf_file", {"scan.csv"}}, {"brdf_scale", {0.5}}}),
                   "incidence_deg,scatter_deg,azimuth_deg,brdf_1_sr\n0,0,0,0.25\n");
  const OpticalSurface& surface = model.scene.surfaces.at(0);
  EXPECT_NEAR(surface.diffuse[0], 0.5 * 0.25 * pi, 1e-12);
  EXPECT_NEAR(fractions_of(surface, 0.3, 0).absorbed, 1 - 0.5 * 0.25 * pi, 1e-12);
  EXPECT_EQ(model.inputs.back().first, "scan.csv");
  EXPECT_TRUE(model.notices.empty()) << ::testing::PrintToString(model.notices);
}

// One of the pairs (0, 0), (60, 0), (60, 60) differs; in the small table none differs.
TEST(MeasuredMaterial, ThatIsNotReciprocalIsReported) {
  const GltfModel model = painted_with(material_with({{"brdf_file", {"scan.csv"}}}),
                                       replaced(small_table, "60,0,0,0.3", "60,0,0,0.1"));
  EXPECT_THAT(model.notices, Contains(HasSubstr("scan.csv: f(i, o) and f(o, i) differ by 66.6")));
}

TEST(MeasuredMaterial, MeasurementOverFewAnglesIsReported) {
  const auto notices = [](const std::string& rows) {
    return painted_with(material_with({{"brdf_file", {"scan.csv"}}}),
                        "incidence_deg,scatter_deg,azimuth_deg,brdf_1_sr\n" + rows)
        .notices;
  };
  EXPECT_THAT(notices("10,0,0,0.2\n10,80,0,0.2\n"),
              ElementsAre("material 'paint': scan.csv: measured up to an incidence of 10 deg and a "
                          "scatter of 80 deg; "
                          "to 90 deg the last values go on"));
  // 0, 60 and 90 deg as radians.
  EXPECT_THAT(notices("0,0,0,0.2\n0,1.5708,0,0.2\n1.0472,0,0,0.2\n1.0472,1.5708,0,0.2\n"),
              ElementsAre(HasSubstr("(are its angles in radians?)")));
  EXPECT_THAT(notices("0,0,0,0.2\n0,60,0,0.2\n60,0,0,0.2\n60,60,0,0.2\n"), IsEmpty());
}

TEST(MeasuredMaterial, ThatShinesOrIsMissingIsRefused) {
  const Settings plain = material_with({{"brdf_file", {"scan.csv"}}});
  EXPECT_EQ(refusal_of([&] {
              painted_with(plain, "incidence_deg,scatter_deg,azimuth_deg,brdf_1_sr\n0,0,0,0.35\n");
            }),
            "test.toml:7: material[0].brdf_file: found a reflectance of 1.1 at 0 deg, expected at "
            "most 1 at every angle, or a brdf_scale");
  EXPECT_EQ(refusal_of([&] {
              painted_with(material_with({{"brdf_file", {"scam.csv"}}}), "");
            }),
            "test.toml:7: material[0].brdf_file: found \"scam.csv\", expected an existing file, "
            "relative to "
            "the folder of the experiment");
  EXPECT_THAT(refusal_of([&] {
                painted_with(material_with({{"brdf_file", {"scan.csv"}}, {"absorptance", {1.0}}}),
                             small_table);
              }),
              HasSubstr("material[0].absorptance: found brdf_file too, expected the table alone"));
}

}  // namespace
}  // namespace photorque
