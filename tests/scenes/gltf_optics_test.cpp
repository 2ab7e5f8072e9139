// Optical properties from extras, from an experiment's [[material]] and from drawing values.
#include <limits>

#include "gltf_test_model.h"
#include "raytrace/surfaces/bsdf.h"
#include "scenes/surfaces/settings.h"
#include "tests/refusal.h"
#include "tests/settings.h"

namespace photorque {
namespace {

using nlohmann::json;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::StartsWith;

using test::numbers_node;

Settings material_of(const SettingsNode::Table& table) {
  return test::settings_of(table, "material[0]");
}

TEST(SurfaceSettings, OneFractionLeftOutIsTheRest) {
  const OpticalSurface surface = read_surface(
      material_of({{"absorptance", {0.7}}, {"specular", {0.1}}, {"transmittance", {0.05}}}), 2,
      "paint");
  EXPECT_EQ(surface.name, "paint");
  EXPECT_NEAR(surface.diffuse[0], 0.15, 1e-15);
  EXPECT_NEAR(surface.diffuse[1], 0.15, 1e-15);
  EXPECT_EQ(surface.diffuse[2], 0.0);  // beyond the bands
  EXPECT_EQ(surface.absorbed[1], 0.7);
}

TEST(SurfaceSettings, BandsMayDiffer) {
  const OpticalSurface surface =
      read_surface(material_of({{"absorptance", numbers_node({0.9, 0.2})},
                                {"specular", {0.1}},
                                {"transmittance", {0.0}}}),
                   2, "cell");
  EXPECT_NEAR(surface.diffuse[0], 0.0, 1e-15);
  EXPECT_NEAR(surface.diffuse[1], 0.7, 1e-15);
}

TEST(SurfaceSettings, SumsThatAreOneLeaveNothingForOthers) {
  const OpticalSurface black = read_surface(material_of({{"absorptance", {1.0}}}), 1, "b");
  EXPECT_EQ(black.absorbed[0], 1.0);
  EXPECT_EQ(black.specular[0] + black.diffuse[0] + black.transmitted[0], 0.0);
}

TEST(SurfaceSettings, SumsToRoundingWhenWrittenToNineDigits) {
  const OpticalSurface surface = read_surface(material_of({{"absorptance", {0.333333333}},
                                                           {"specular", {0.333333333}},
                                                           {"diffuse", {0.333333333}},
                                                           {"transmittance", {0.0}}}),
                                              1, "thirds");
  EXPECT_NEAR(surface.absorbed[0] + surface.specular[0] + surface.diffuse[0], 1.0,
              4 * std::numeric_limits<double>::epsilon());
}

TEST(SurfaceSettings, WrongFractionsAreRefused) {
  const auto error = [](const SettingsNode::Table& table, int bands = 1) {
    return refusal_of([&] { read_surface(material_of(table), bands, "x"); });
  };
  EXPECT_EQ(error({}),
            "test.toml:7: material[0]: found no optical property, expected "
            "absorptance, specular, diffuse, transmittance");
  EXPECT_THAT(
      error({{"absorptance", {0.5}}}),
      HasSubstr("found fractions that sum to 0.5 in band 0, expected a sum of 1, or all but "
                "one of specular, diffuse, transmittance too"));
  EXPECT_THAT(error({{"absorptance", {0.5}},
                     {"specular", {0.2}},
                     {"diffuse", {0.2}},
                     {"transmittance", {0.2}}}),
              HasSubstr("sum to 1.1 in band 0"));
  EXPECT_THAT(error({{"absorptance", {0.5}}, {"specular", {0.5 + 2e-9}}, {"diffuse", {0.0}}}),
              HasSubstr("expected a sum of 1"));
  EXPECT_THAT(error({{"absorptance", {1.5}}}), HasSubstr("found 1.5, expected a number in"));
  EXPECT_THAT(error({{"absorptance", numbers_node({1, 1, 1})}}, 2),
              HasSubstr("found an array of 3, expected one number, or one for each of 2 band(s)"));
  EXPECT_THAT(error({{"absorptance", {"black"}}}), HasSubstr("\"black\""));
}

TEST(SurfaceSettings, BackIsATableOfItsOwn) {
  const SettingsNode back{SettingsNode::Table{{"specular", {1.0}}}};
  const Settings both = material_of({{"absorptance", {1.0}}, {"back", back}});
  const SheetOptics sheet = read_sheet(both, 1, "cell");
  EXPECT_EQ(sheet.front.absorbed[0], 1.0);
  ASSERT_TRUE(sheet.back.has_value());
  EXPECT_EQ(sheet.back->specular[0], 1.0);
  EXPECT_NO_THROW(both.finish());
  EXPECT_FALSE(read_sheet(material_of({{"absorptance", {1.0}}}), 1, "x").back);
}

TEST(SurfaceSettings, RetroreflectanceIsAFifthFraction) {
  const OpticalSurface sign =
      read_surface(material_of({{"retroreflectance", {0.6}}, {"absorptance", {0.4}}}), 1, "sign");
  ASSERT_TRUE(sign.bsdf);
  EXPECT_NEAR(sign.bsdf->retroreflected[0], 0.6, 1e-15);
  EXPECT_EQ(sign.specular[0] + sign.diffuse[0] + sign.transmitted[0], 0.0);
  EXPECT_EQ(read_surface(material_of({{"retroreflectance", {1.0}}}), 1, "x").absorbed[0], 0);
}

TEST(SurfaceSettings, PlainSurfacesHaveNoBsdf) {
  EXPECT_FALSE(read_surface(material_of({{"absorptance", {1.0}}}), 1, "b").bsdf);
  EXPECT_FALSE(
      read_sheet(material_of({{"absorptance", {1.0}}, {"reemitted", {0.0}}}), 1, "b").front.bsdf);
}

TEST(SurfaceSettings, GlassRoughnessAndSlopesReachTheSurface) {
  const auto read = [](const SettingsNode::Table& table) {
    const Settings settings = material_of(table);
    const OpticalSurface surface = read_surface(settings, 1, "x");
    settings.finish();
    return surface;
  };
  const OpticalSurface cell = read({{"absorptance", {1.0}}, {"refractive_index", {1.5}}});
  ASSERT_TRUE(cell.bsdf && cell.bsdf->law);
  EXPECT_NEAR(cell.absorbed[0], 0.96, 1e-14);  // 4 % by Fresnel
  const OpticalSurface satin =
      read({{"specular", {0.8}}, {"absorptance", {0.2}}, {"roughness", {0.5}}});
  ASSERT_TRUE(satin.bsdf && satin.bsdf->specular);
  EXPECT_EQ(satin.specular[0], 0.8);
  // A lobe like that of alpha = 0.25, which is wider than that of a wavy mirror.
  const OpticalSurface wavy = read({{"specular", {1.0}}, {"slope_error_mrad", {2.0}}});
  EXPECT_LT(satin.bsdf->specular->mean_direction(1.0).z(), 0.9);
  EXPECT_NEAR(1 - wavy.bsdf->specular->mean_direction(1.0).z(), 4 * 4e-6, 1e-7);
}

TEST(SurfaceSettings, SlopeErrorsHaveAShapeAndTwoSizes) {
  const SettingsNode two = numbers_node({6.0, 2.0});
  const SettingsNode axis = numbers_node({0.0, 2.0, 0.0});
  const SettingsNode pillbox{"pillbox"};
  const Settings settings = material_of({{"specular", {1.0}},
                                         {"slope_error_mrad", two},
                                         {"slope_error_shape", pillbox},
                                         {"slope_error_axis", axis}});
  const OpticalSurface surface = read_surface(settings, 1, "x");
  settings.finish();
  ASSERT_TRUE(surface.bsdf && surface.bsdf->specular);
  EXPECT_EQ(surface.bsdf->axis, Vec3::UnitY());
  // 1 − <o_z> = 2 (<s₁²> + <s₂²>), of an even ellipse a quarter of the squares of its semi-axes.
  EXPECT_NEAR(1 - surface.bsdf->specular->mean_direction(1.0).z(), 0.5 * 40e-6, 1e-8);
  const auto error = [](SettingsNode::Table table) {
    table.insert({"specular", {1.0}});
    return refusal_of([&] { read_sheet(material_of(table), 1, "x"); });
  };
  EXPECT_THAT(error({{"slope_error_mrad", two}}), HasSubstr("slope_error_axis beside"));
  const SettingsNode three = numbers_node({6.0, 2.0, 1.0});
  EXPECT_THAT(error({{"slope_error_mrad", three}, {"slope_error_axis", axis}}),
              HasSubstr("found an array of 3, expected one number, or two"));
  const SettingsNode nowhere = numbers_node({0.0, 0.0, 0.0});
  EXPECT_THAT(error({{"slope_error_mrad", two}, {"slope_error_axis", nowhere}}),
              HasSubstr("found a vector without length"));
}

TEST(SurfaceSettings, HeatIsOfTheWholeSheet) {
  const SettingsNode back{SettingsNode::Table{{"absorptance", {1.0}}}};
  const Settings settings = material_of({{"absorptance", {1.0}},
                                         {"back", back},
                                         {"reemitted", {0.9}},
                                         {"emissivity_front", {0.8}},
                                         {"emissivity_back", {0.2}}});
  const SheetOptics sheet = read_sheet(settings, 1, "radiator");
  settings.finish();
  for (const OpticalSurface* side : {&sheet.front, &*sheet.back}) {
    ASSERT_TRUE(side->bsdf);
    EXPECT_EQ(side->bsdf->reemitted, 0.9);
    EXPECT_NEAR(side->bsdf->front_emission, 0.8, 1e-15);
    EXPECT_EQ(side->absorbed[0], 1.0);
  }
}

TEST(SurfaceSettings, BsdfsThatMakeNoSenseAreRefused) {
  const auto error = [](SettingsNode::Table table) {
    return refusal_of([&] { read_sheet(material_of(table), 1, "x"); });
  };
  const SettingsNode half = {0.5};
  EXPECT_EQ(error({{"absorptance", {1.0}}, {"refractive_index", {0.5}}}),
            "test.toml:7: material[0].refractive_index: found 0.5, expected a number in "
            "[1, 10]");
  EXPECT_THAT(
      error({{"diffuse", half}, {"specular", half}, {"refractive_index", {1.5}}}),
      HasSubstr("found more than one of specular, diffuse, transmittance, expected at most"));
  EXPECT_THAT(error({{"specular", {1.0}}, {"refractive_index", {1.5}}, {"roughness", half}}),
              HasSubstr("material[0].roughness: found specular or transmittance behind glass"));
  EXPECT_THAT(error({{"diffuse", {1.0}}, {"roughness", half}}),
              HasSubstr("found no specular fraction"));
  EXPECT_THAT(error({{"specular", {1.0}}, {"roughness", {0.0}}}),
              HasSubstr("material[0].roughness: found 0, expected a number in (0, 1]"));
  EXPECT_THAT(error({{"specular", {1.0}}, {"roughness", half}, {"slope_error_mrad", {1.0}}}),
              HasSubstr("expected one of the two"));
  EXPECT_THAT(
      error({{"retroreflectance", half}, {"absorptance", half}, {"refractive_index", {1.5}}}),
      HasSubstr("found glass in front too"));
  EXPECT_THAT(error({{"absorptance", {1.0}},
                     {"reemitted", {1.0}},
                     {"emissivity_front", {0.0}},
                     {"emissivity_back", {0.0}}}),
              HasSubstr("found 0 on both sides"));
}

TestModel painted_model(const json& material) {
  TestModel model = triangle_model();
  model.json["materials"] = json::array({material});
  model.json["meshes"][0]["primitives"][0]["material"] = 0;
  return model;
}

TEST(GltfOptics, ExtrasAreTakenAsTheyAre) {
  const TestModel model = painted_model({{"name", "cell"},
                                         {"extras",
                                          {{"photorque",
                                            {{"absorptance", {0.9, 0.1}},
                                             {"specular", 0.1},
                                             {"transmittance", 0},
                                             {"back", {{"diffuse", 1}}}}},
                                           {"other", "tools' data"}}}});
  const Bands bands{{400e-9, 700e-9, 1100e-9}};
  const GltfModel read = model.read({.bands = bands});
  const Instance& instance = read.scene.instances.at(0);
  const OpticalSurface& front = read.scene.surfaces.at(instance.front_surface);
  const OpticalSurface& back = read.scene.surfaces.at(instance.back_surface);
  EXPECT_NEAR(front.diffuse[1], 0.8, 1e-15);
  EXPECT_EQ(back.diffuse[0], 1.0);
  EXPECT_EQ(read.materials.at(0).origin, OpticsOrigin::extras);
  EXPECT_EQ(read.scene.bands.count(), 2);
  EXPECT_TRUE(read.notices.empty());
}

TEST(GltfOptics, UnknownKeysInExtrasSuggestTheKnown) {
  const TestModel model =
      painted_model({{"extras", {{"photorque", {{"absorptance", 1}, {"transmitance", 0}}}}}});
  EXPECT_EQ(refusal_of([&] { model.read(); }),
            "model.gltf: /materials/0/extras/photorque.transmitance: found an unknown key, "
            "expected a known key, perhaps \"transmittance\"");
  const TestModel text = painted_model({{"extras", {{"photorque", "black"}}}});
  EXPECT_THAT(refusal_of([&] { text.read(); }),
              HasSubstr("/materials/0/extras/photorque: found \"black\", expected an object"));
  const TestModel null = painted_model({{"extras", {{"photorque", {{"diffuse", nullptr}}}}}});
  EXPECT_THAT(refusal_of([&] { null.read(); }), HasSubstr("found null"));
}

TEST(GltfOptics, ExperimentWinsOverExtras) {
  TestModel model =
      painted_model({{"name", "cell"}, {"extras", {{"photorque", {{"absorptance", 1}}}}}});
  const Settings material = material_of({{"name", {"cell"}}, {"diffuse", {1.0}}});
  const GltfModel read = model.read({.materials = {material}});
  EXPECT_EQ(read.scene.surfaces.at(0).diffuse[0], 1.0);
  EXPECT_EQ(read.materials.at(0).origin, OpticsOrigin::experiment);
  EXPECT_NO_THROW(material.finish());
}

TEST(GltfOptics, ExperimentMustNameAMaterialOnce) {
  const TestModel model = painted_model({{"name", "solar_cell"}});
  const auto material = [](const std::string& name) {
    return material_of({{"name", {name}}, {"diffuse", {1.0}}});
  };
  EXPECT_EQ(refusal_of([&] { model.read({.materials = {material("solarcell")}}); }),
            "test.toml:7: material[0].name: found \"solarcell\", expected a material of "
            "model.gltf: perhaps \"solar_cell\"");
  EXPECT_THAT(refusal_of([&] {
                model.read({.materials = {material("solar_cell"), material("solar_cell")}});
              }),
              HasSubstr("a second time"));
}

struct Derived {
  const char* name;
  json material;
  double specular, diffuse, transmitted;
};
void PrintTo(const Derived& derived, std::ostream* out) {
  *out << derived.name;
}

class DerivedOptics : public ::testing::TestWithParam<Derived> {};

TEST_P(DerivedOptics, FollowTheStatedRule) {
  const GltfModel read = painted_model(GetParam().material).read();
  const OpticalSurface& surface = read.scene.surfaces.at(0);
  EXPECT_NEAR(surface.specular[0], GetParam().specular, 1e-12);
  EXPECT_NEAR(surface.diffuse[0], GetParam().diffuse, 1e-12);
  EXPECT_NEAR(surface.transmitted[0], GetParam().transmitted, 1e-12);
  EXPECT_NEAR(
      surface.absorbed[0] + surface.specular[0] + surface.diffuse[0] + surface.transmitted[0], 1.0,
      4e-16);
  EXPECT_GE(surface.absorbed[0], 0.0);
  EXPECT_THAT(read.notices, Contains(HasSubstr("derived from PBR values: absorptance ")));
}

// By hand from the rule in scenes/gltf/optics.h; F0 = 0.04 at n = 1.5 and 1/9 at n = 2.
INSTANTIATE_TEST_SUITE_P(
    Rule, DerivedOptics,
    ::testing::Values(
        Derived{"default_is_white_rough_metal", json::object(), 0, 1, 0},
        Derived{"mirror", {{"pbrMetallicRoughness", {{"roughnessFactor", 0}}}}, 1, 0, 0},
        Derived{"grey_paint",
                {{"pbrMetallicRoughness",
                  {{"baseColorFactor", {0.5, 0.5, 0.5, 1}},
                   {"metallicFactor", 0},
                   {"roughnessFactor", 0.75}}}},
                0.01,
                0.03 + 0.48,
                0},
        Derived{"half_metal_of_green",
                {{"pbrMetallicRoughness",
                  {{"baseColorFactor", {0, 1, 0, 1}},
                   {"metallicFactor", 0.5},
                   {"roughnessFactor", 0}}}},
                0.02 + 0.5 * 0.7152,
                0.48 * 0.7152,
                0},
        Derived{"glass",
                {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0}}},
                 {"extensions",
                  {{"KHR_materials_transmission", {{"transmissionFactor", 0.75}}},
                   {"KHR_materials_ior", {{"ior", 2}}}}}},
                1.0 / 9,
                0.25 * 8 / 9,
                0.75 * 8 / 9},
        Derived{"half_covered",
                {{"alphaMode", "BLEND"},
                 {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 0.5}}}}},
                0,
                0.5,
                0.5},
        Derived{"alpha_of_opaque_is_nothing",
                {{"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 0.5}}}}},
                0,
                1,
                0},
        Derived{"cut_out",
                {{"alphaMode", "MASK"},
                 {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 0.4}}}}},
                0,
                0,
                1},
        Derived{"specular_glossiness",
                {{"extensions",
                  {{"KHR_materials_pbrSpecularGlossiness",
                    {{"diffuseFactor", {0.5, 0.5, 0.5, 1}},
                     {"specularFactor", {0.2, 0.2, 0.2}},
                     {"glossinessFactor", 0.25}}}}}},
                0.05,
                0.15 + 0.4,
                0}),
    [](const auto& test) { return test.param.name; });

// KHR_materials_ior on a dielectric: by hand, R = 1/9 at n = 2 and normal incidence; a pane passes
// 2n/(n² + 1) = 0.8.
TEST(GltfOptics, IndexOfRefractionMakesGlass) {
  const auto read = [](double through) {
    return painted_model({{"name", "cover"},
                          {"pbrMetallicRoughness",
                           {{"metallicFactor", 0},
                            {"roughnessFactor", 0},
                            {"baseColorFactor", {1, 1, 1, 1}}}},
                          {"extensions",
                           {{"KHR_materials_transmission", {{"transmissionFactor", through}}},
                            {"KHR_materials_ior", {{"ior", 2}}}}}})
        .read();
  };
  const OpticalSurface matt = read(0.0).scene.surfaces.at(0);
  EXPECT_NEAR(matt.specular[0], 1.0 / 9, 1e-14);
  EXPECT_NEAR(matt.diffuse[0], 8.0 / 9, 1e-14);
  ASSERT_TRUE(matt.bsdf && matt.bsdf->law);
  EXPECT_GT(matt.bsdf->law->fractions(0.1, 0).specular, 0.5);
  const GltfModel pane = read(1.0);
  EXPECT_NEAR(pane.scene.surfaces.at(0).transmitted[0], 0.8, 1e-14);
  EXPECT_THAT(pane.notices,
              Contains(HasSubstr("derived from PBR values: absorptance 0, specular 0.2, diffuse 0, "
                                 "transmittance 0.8 at normal incidence; glass of index 2")));
}

TEST(GltfOptics, PrimitivesWithoutMaterialHaveTheDefault) {
  const GltfModel read = triangle_model().read();
  EXPECT_EQ(read.scene.instances.at(0).material, "");
  EXPECT_EQ(read.scene.surfaces.at(0).diffuse[0], 1.0);
  EXPECT_THAT(read.notices, Contains(StartsWith("material without a name: optical")));
}

}  // namespace
}  // namespace photorque
