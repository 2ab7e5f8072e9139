// Lamps that a glTF file places, as sources of an experiment.
#include "scenes/gltf/lights.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/constants.h"
#include "core/numerics/random.h"
#include "receivers/flux_map.h"
#include "scenes/experiment/experiment.h"
#include "scenes/gltf/writer.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;

// A plate of 2 m × 2 m, and lights in the file's own axes (y up): a spot of 20 deg 1 m above the
// plate's middle, turned by −90 deg about x so that it looks down; a sun of the node below it,
// which inherits the turn; a point at (0.5, 2, 0.25).
json lamp_file() {
  GltfWriterModel model;
  Mesh plate;
  plate.vertices_m = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  plate.triangles = {{0, 1, 2}, {0, 2, 3}};
  model.meshes = {plate};
  model.materials.emplace_back().name = "plate";
  model.nodes.push_back({"plate", -1, Vec3::Zero(), 0, 0});
  json file = json::parse(gltf_text(model));
  const auto light = [](int number) { return json{{"KHR_lights_punctual", {{"light", number}}}}; };
  const double half = std::sqrt(0.5);
  json& nodes = file["nodes"];
  const size_t first = nodes.size();
  nodes.push_back({{"name", "lamp"},
                   {"translation", {0.0, 1.0, 0.0}},
                   {"rotation", {-half, 0.0, 0.0, half}},
                   {"children", {first + 1}},
                   {"extensions", light(0)}});
  nodes.push_back({{"extensions", light(1)}});
  nodes.push_back({{"name", "bulb"}, {"translation", {0.5, 2.0, 0.25}}, {"extensions", light(2)}});
  file["scenes"][0]["nodes"].push_back(first);
  file["scenes"][0]["nodes"].push_back(first + 2);
  file["extensionsUsed"] = {"KHR_lights_punctual"};
  file["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "spot"}, {"spot", {{"outerConeAngle", 20.0 * degree_rad}}}, {"intensity", 5.0}},
      {{"type", "directional"}, {"name", "noon"}},
      {{"type", "point"}}};
  return file;
}

fs::path folder_with(const json& file, const std::string& experiment = "") {
  const fs::path folder = fs::path(::testing::TempDir()) / "gltf_lights";
  fs::create_directories(folder);
  std::ofstream(folder / "lamps.gltf") << file.dump();
  std::ofstream(folder / "lamps.toml") << "[scene]\nfile = \"lamps.gltf\"\n[[receiver]]\n"
                                          "kind = \"flux_map\"\nnode = \"plate\"\n"
                                          "bins = [1, 1]\n[trace]\nrays = 65536\n"
                                       << experiment;
  return folder;
}

Experiment lit(const json& file, const std::string& source) {
  return resolve_experiment(
      read_experiment_file(folder_with(file, "[[source]]\n" + source) / "lamps.toml"));
}

TEST(GltfLights, HavePositionAndLightOfTheFile) {
  const auto lights = read_gltf_lights(folder_with(lamp_file()) / "lamps.gltf", 1e-3);
  ASSERT_EQ(lights.size(), 3u);
  EXPECT_EQ(lights[0].name, "lamp");
  EXPECT_EQ(lights[0].kind, GltfLight::Kind::spot);
  EXPECT_NEAR(lights[0].outer_cone_rad, 20.0 * degree_rad, 1e-15);
  // Up in the file is z here; millimetres were asked for.
  EXPECT_LT((lights[0].position_m - Vec3(0, 0, 1e-3)).norm(), 1e-15);
  EXPECT_LT((lights[0].direction - Vec3(0, 0, -1)).norm(), 1e-12);
  EXPECT_EQ(lights[1].name, "noon");
  EXPECT_EQ(lights[1].kind, GltfLight::Kind::directional);
  EXPECT_LT((lights[1].direction - Vec3(0, 0, -1)).norm(), 1e-12);
  EXPECT_EQ(lights[2].name, "bulb");
  EXPECT_LT((lights[2].position_m - 1e-3 * Vec3(0.5, -0.25, 2.0)).norm(), 1e-15);
}

// A cone of 20 deg from 1 m lights a disc of 0.364 m: all of its power is on the plate. An even
// cone has the flux of an even radiant intensity.
TEST(GltfLights, ASpotIsALedWithAnEvenCone) {
  const Experiment experiment = lit(lamp_file(),
                                    "light = \"lamp\"\npower_W = 3\n"
                                    "wavelength_nm = 730\naperture_diameter_mm = 1\n");
  ASSERT_EQ(experiment.beams.size(), 1u);
  const Beam& beam = experiment.beams[0];
  EXPECT_EQ(beam.emitter->power_W(), 3.0);
  EXPECT_LT((beam.lab_from_emitter.translation_m - Vec3(0, 0, 1)).norm(), 1e-12);
  EXPECT_LT((beam.lab_from_emitter.direction(Vec3::UnitZ()) - Vec3(0, 0, -1)).norm(), 1e-12);
  const FluxMapReceiver& map = *experiment.receivers[0].flux_map;
  const TraceResult traced =
      trace(TraceableScene(experiment.scene), experiment.lab_from_body, experiment.beams,
            experiment.receiver_pointers(), experiment.file.trace);
  EXPECT_NEAR(map.flux_map(traced.sums[0]).incident.power_W.value, 3.0, 1e-9);
}

TEST(GltfLights, ADirectionalLightIsASunAndKeysOfTheUserWin) {
  const Experiment experiment = lit(lamp_file(),
                                    "light = \"noon\"\nirradiance_W_m2 = 500\n"
                                    "angular_radius_deg = 0\n"
                                    "[[source]]\nlight = \"lamp\"\npower_W = 1\n"
                                    "wavelength_nm = 730\ndirection = [0, 1, -1]\n"
                                    "profile = \"gaussian\"\nfwhm_deg = 3\n"
                                    "aperture_diameter_mm = 45\n");
  ASSERT_EQ(experiment.beams.size(), 2u);
  const auto looks = [&](size_t beam) {
    return experiment.beams[beam].lab_from_emitter.direction(Vec3::UnitZ());
  };
  EXPECT_LT((looks(0) - Vec3(0, 0, -1)).norm(), 1e-12);
  EXPECT_LT((looks(1) - Vec3(0, 1, -1).normalized()).norm(), 1e-12);
}

// A cone is the beam of an LED; a lamp of another kind at a spot's place has its own beam.
TEST(GltfLights, AnyKindOfSourceCanStandWhereASpotStands) {
  const Experiment experiment = lit(lamp_file(),
                                    "light = \"lamp\"\nkind = \"laser\"\npower_W = 2\n"
                                    "wavelength_nm = 532\nwaist_radius_mm = 5\n");
  ASSERT_EQ(experiment.beams.size(), 1u);
  EXPECT_EQ(experiment.beams[0].emitter->power_W(), 2.0);
  EXPECT_LT((experiment.beams[0].lab_from_emitter.translation_m - Vec3(0, 0, 1)).norm(), 1e-12);
}

// Blender writes half a turn as a single number, a little more than π/2.
TEST(GltfLights, ASpotMayBeAsWideAsAHemisphere) {
  json wide = lamp_file();
  wide["extensions"]["KHR_lights_punctual"]["lights"][0]["spot"]["outerConeAngle"] = 1.5707963705;
  const auto lights = read_gltf_lights(folder_with(wide) / "lamps.gltf", 1.0);
  EXPECT_EQ(lights[0].outer_cone_rad, 0.5 * pi);
}

// A lamp that shines 10 deg beside its axis, towards C0 (linear in C to nothing at ±90 deg), as
// LM-63 text and as base64 (Python's b64encode).
constexpr const char* leaning_ies =
    "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 3 5 1 2 0 0 0\n1 1 10\n0 10 20\n0 90 180 270 360\n"
    "0 100 0\n0 0 0\n0 0 0\n0 0 0\n0 100 0\n";
constexpr const char* leaning_base64 =
    "SUVTTkE6TE0tNjMtMjAwMgpUSUxUPU5PTkUKMSAtMSAxIDMgNSAxIDIgMCAwIDAKMSAxIDEwCjAgMTAg"
    "MjAKMCA5MCAxODAgMjcwIDM2MAowIDEwMCAwCjAgMCAwCjAgMCAwCjAgMCAwCjAgMTAwIDAK";

// A profile at (0, 0, 1), looking down, its x axis 40 deg from x towards y.
json profile_file(json light) {
  json file = lamp_file();
  file["extensionsUsed"].push_back("EXT_lights_ies");
  file["extensions"]["EXT_lights_ies"]["lights"] = {std::move(light)};
  json& nodes = file["nodes"];
  const size_t first = nodes.size();
  const double half = std::sqrt(0.5), turn = 20.0 * degree_rad;
  nodes.push_back({{"translation", {0.0, 1.0, 0.0}},
                   {"rotation", {0.0, std::sin(turn), 0.0, std::cos(turn)}},
                   {"children", {first + 1}}});
  nodes.push_back({{"name", "measured"},
                   {"rotation", {-half, 0.0, 0.0, half}},
                   {"extensions", {{"EXT_lights_ies", {{"light", 0}, {"multiplier", 7.0}}}}}});
  file["scenes"][0]["nodes"].push_back(first);
  return file;
}

Vec3 mean_direction(const Beam& beam) {
  SampleBlock samples;
  RayBlock rays;
  sobol_points({}, 0, samples.columns());
  beam.emitter->emit(samples, rays);
  Vec3 sum = Vec3::Zero();
  for (size_t i = 0; i < ray_block; ++i) sum += rays.direction_at(i);
  return beam.lab_from_emitter.direction(sum / ray_block);
}

TEST(GltfLights, AProfileIsAMeasuredLampTurnedAsItsNode) {
  const std::string data = std::string("data:application/x-ies-lm-63;base64,") + leaning_base64;
  for (const char* uri : {"leaning.ies", data.c_str()}) {
    const fs::path folder = folder_with(profile_file({{"uri", uri}}),
                                        "[[source]]\nlight = \"measured\"\npower_W = 2\n"
                                        "wavelength_nm = 730\n");
    std::ofstream(folder / "leaning.ies") << leaning_ies;
    const Experiment experiment = resolve_experiment(read_experiment_file(folder / "lamps.toml"));
    ASSERT_EQ(experiment.beams.size(), 1u);
    const Beam& beam = experiment.beams[0];
    EXPECT_EQ(beam.emitter->power_W(), 2.0);  // candela and multipliers are for pictures
    EXPECT_LT((beam.lab_from_emitter.translation_m - Vec3(0, 0, 1)).norm(), 1e-12);
    const Vec3 mean = mean_direction(beam);
    EXPECT_LT(mean.z(), -0.95);
    EXPECT_NEAR(std::atan2(mean.y(), mean.x()), 40.0 * degree_rad, 0.02);
    EXPECT_GT(std::hypot(mean.x(), mean.y()), 0.1);
  }
}

TEST(GltfLights, AProfileOfABufferViewIsRead) {
  json file = profile_file({{"bufferView", 0}, {"mimeType", "application/x-ies-lm-63"}});
  const size_t length = std::string(leaning_ies).size();
  file["buffers"].push_back(
      {{"byteLength", length},
       {"uri", std::string("data:application/octet-stream;base64,") + leaning_base64}});
  file["bufferViews"].push_back({{"buffer", file["buffers"].size() - 1}, {"byteLength", length}});
  file["extensions"]["EXT_lights_ies"]["lights"][0]["bufferView"] = file["bufferViews"].size() - 1;
  const auto lights = read_gltf_lights(folder_with(file) / "lamps.gltf", 1.0);
  ASSERT_EQ(lights.back().kind, GltfLight::Kind::profile);
  EXPECT_EQ(lights.back().profile_bytes, leaning_ies);
}

std::string refusal(const json& file, const std::string& source) {
  return refusal_of([&] { lit(file, source); });
}

TEST(GltfLights, WrongLightsNameTheirPlace) {
  const std::string led = "power_W = 1\nwavelength_nm = 730\naperture_diameter_mm = 1\n";
  EXPECT_THAT(refusal(lamp_file(), "light = \"lump\"\n" + led), HasSubstr("\"lamp\", \"noon\""));
  EXPECT_THAT(refusal(lamp_file(), "light = \"lamp\"\ncolour = 3\n" + led), HasSubstr("colour"));
  json wide = lamp_file();
  wide["extensions"]["KHR_lights_punctual"]["lights"][0]["spot"]["outerConeAngle"] = 2.0;
  EXPECT_THAT(refusal(wide, "light = \"lamp\"\n" + led), HasSubstr("lights/0/spot/outerConeAngle"));
  json twice = lamp_file();
  for (json& node : twice["nodes"]) {
    if (node.value("name", "") == "bulb") node["name"] = "lamp";
  }
  EXPECT_THAT(refusal(twice, "light = \"lamp\"\n" + led), HasSubstr("the name of 2 lamps"));
  json missing = lamp_file();
  missing["extensions"]["KHR_lights_punctual"]["lights"] = json::array();
  EXPECT_THAT(refusal(missing, "light = \"lamp\"\n" + led), HasSubstr("the number of a light"));
  const std::string profile = "light = \"measured\"\npower_W = 1\nwavelength_nm = 730\n";
  EXPECT_THAT(refusal(profile_file({{"uri", "none.ies"}}), profile),
              HasSubstr("EXT_lights_ies/lights/0/uri"));
  EXPECT_THAT(refusal(profile_file({{"bufferView", 99}}), profile),
              HasSubstr("EXT_lights_ies/lights/0/bufferView"));
  EXPECT_THAT(refusal(profile_file({{"uri", "data:,not%20a%20profile"}}), profile),
              HasSubstr("lamps.gltf/extensions/EXT_lights_ies/lights/0"));
  json kind = lamp_file();
  kind["extensions"]["KHR_lights_punctual"]["lights"][2]["type"] = "area";
  EXPECT_THAT(refusal(kind, "light = \"lamp\"\n" + led), HasSubstr("\"spot\""));
}

}  // namespace
}  // namespace photorque
