// Experiment files become scenes, beams and receivers.
#include <gmock/gmock.h>

#include <filesystem>

#include "core/constants.h"
#include "core/provenance.h"
#include "scenes/experiment/experiment.h"
#include "tests/files.h"

namespace photorque {
namespace {

using testing::Contains;
using testing::Pair;

const std::filesystem::path scenes = std::filesystem::path(PHOTORQUE_SOURCE_DIR) / "scenes";

TEST(Experiment, StasisIsReadAsWritten) {
  const Experiment experiment =
      resolve_experiment(read_experiment_file(scenes / "stasis/nominal.toml"));
  ASSERT_EQ(experiment.beams.size(), 49u);
  double power_W = 0.0;
  Vec3 centre_m = Vec3::Zero();
  for (const Beam& beam : experiment.beams) {
    power_W += beam.emitter->power_W();
    centre_m += beam.lab_from_emitter.translation_m / 49.0;
    EXPECT_NEAR((beam.lab_from_emitter.direction(Vec3::UnitZ()) + Vec3::UnitZ()).norm(), 0, 1e-12);
    EXPECT_DOUBLE_EQ(beam.spectrum.centre_m, 730e-9);
    EXPECT_DOUBLE_EQ(beam.spectrum.fwhm_m, 30e-9);
  }
  EXPECT_NEAR(power_W, 88.0, 1e-9);
  EXPECT_NEAR((centre_m - Vec3(0, 0, 1)).norm(), 0.0, 1e-12);

  ASSERT_EQ(experiment.receivers.size(), 3u);
  EXPECT_EQ(experiment.receivers[0].kind, "flux_map");
  EXPECT_EQ(experiment.receivers[0].name, "solar_array");
  EXPECT_EQ(experiment.receivers[2].kind, "torque_map");
  EXPECT_EQ(experiment.receiver_pointers().size(), 3u);
  EXPECT_EQ(experiment.scene.bands.count(), 1);
  EXPECT_EQ(experiment.file.torque_map.tilt_rad.size(), 7u);
  EXPECT_NEAR(experiment.file.torque_map.tilt_rad.back(), 30 * degree_rad, 1e-15);
  EXPECT_EQ(experiment.lab_from_body.rotation.w(), 1.0);
  EXPECT_EQ(experiment.file.trace.rays, 12845056u);
}

// A model whose origin is elsewhere: every vertex moves by the same, lamps stay where they are.
TEST(Experiment, CentreOfRotationBecomesTheOrigin) {
  const Experiment as_drawn =
      resolve_experiment(read_experiment_file(scenes / "stasis/nominal.toml"));
  const std::vector<std::string> overrides = {"scene.centre_of_rotation_mm=[3, -2, 12.5]"};
  const Experiment moved =
      resolve_experiment(read_experiment_file(scenes / "stasis/nominal.toml", overrides));
  ASSERT_EQ(moved.scene.instances.size(), as_drawn.scene.instances.size());
  for (size_t i = 0; i < moved.scene.instances.size(); ++i) {
    const auto corner = [&](const Scene& scene) {
      const Instance& of = scene.instances[i];
      return Vec3(of.body_from_mesh * scene.meshes[of.mesh].vertices_m.back());
    };
    const Vec3 by_m = corner(moved.scene) - corner(as_drawn.scene);
    EXPECT_NEAR((by_m - Vec3(-0.003, 0.002, -0.0125)).norm(), 0.0, 1e-15);
  }
  EXPECT_EQ(moved.beams[7].lab_from_emitter.translation_m,
            as_drawn.beams[7].lab_from_emitter.translation_m);
}

TEST(Experiment, OverridesReachSourcesReceiversAndOptions) {
  const std::vector<std::string> overrides = {"source[0].total_power_W=4.9",
                                              "receiver[0].name=cells", "attitude.tilt_deg=30",
                                              "trace.rays=1e6", "trace.seed=7"};
  const Experiment experiment =
      resolve_experiment(read_experiment_file(scenes / "stasis/nominal.toml", overrides));
  EXPECT_NEAR(experiment.beams[0].emitter->power_W(), 0.1, 1e-12);
  EXPECT_EQ(experiment.receivers[0].name, "cells");
  EXPECT_EQ(experiment.file.trace.rays, 1000000u);
  EXPECT_EQ(experiment.file.trace.seed, 7u);
  // Heading 0: the body's z axis leans towards lab x.
  const Vec3 up_lab = experiment.lab_from_body.direction(Vec3::UnitZ());
  EXPECT_NEAR((up_lab - Vec3(0.5, 0, std::sqrt(0.75))).norm(), 0.0, 1e-12);
}

TEST(Experiment, MaterialsMayBeReplacedByName) {
  const Experiment experiment = resolve_experiment(read_experiment_file(
      test_file("mirror.toml",
                "[scene]\nfile = \"" + (scenes / "stasis/stasis.gltf").string() +
                    "\"\n"
                    "[[material]]\nname = \"solar_cell\"\nabsorptance = 0.25\nspecular = 0.75\n"
                    "[[source]]\nkind = \"sun\"\ndirection = [0, 0, -1]\n")));
  const auto array = experiment.scene.instances_of("solar_array");
  ASSERT_EQ(array.size(), 1u);
  const uint32_t surface = experiment.scene.instances[array[0]].front_surface;
  EXPECT_DOUBLE_EQ(experiment.scene.surfaces[surface].specular[0], 0.75);
  EXPECT_DOUBLE_EQ(experiment.scene.surfaces[surface].absorbed[0], 0.25);
}

TEST(Experiment, InputsNameEveryFileAndOverride) {
  const std::vector<std::string> overrides = {"trace.seed=7"};
  const Experiment experiment =
      resolve_experiment(read_experiment_file(scenes / "stasis/nominal.toml", overrides));
  EXPECT_THAT(experiment.inputs, Contains(Pair("nominal.toml", testing::SizeIs(32))));
  EXPECT_THAT(experiment.inputs, Contains(Pair("stasis.gltf", testing::SizeIs(32))));
  EXPECT_THAT(experiment.inputs, Contains(Pair("--set trace.seed=7", testing::SizeIs(32))));
}

TEST(Experiment, LampFilesBesideItAreFoundAndHashedAmongItsInputs) {
  const std::string lamp = read_file(outside::reference_data("beams/gauss3.ies"));
  const auto toml =
      test_file("lamp.toml", "[scene]\nfile = \"" + (scenes / "stasis/stasis.gltf").string() +
                                 "\"\n[[source]]\nkind = \"ies\"\nfile = \"lamp.ies\"\n"
                                 "power_W = 3\nwavelength_nm = 730\nposition_m = [0, 0, 2]\n"
                                 "direction = [0, 0, -1]\n");
  test_file("lamp.ies", lamp);
  const Experiment experiment = resolve_experiment(read_experiment_file(toml));
  ASSERT_EQ(experiment.beams.size(), 1u);
  EXPECT_EQ(experiment.beams[0].emitter->power_W(), 3.0);
  EXPECT_THAT(experiment.inputs, Contains(Pair("lamp.ies", content_hash(lamp))));
  EXPECT_THROW(resolve_experiment(read_experiment_file(
                   toml, std::vector<std::string>{"source[0].file=other.ies"})),
               InputError);
}

TEST(ExperimentFile, TablesOfOthersKeepTheirOwnRecordOfKeys) {
  const ExperimentFile file = read_experiment_file(
      test_file("others.toml",
                "[platform]\nmass_kg = 7\ntypo = 1\n"
                "[[disturbance]]\nkind = \"a\"\n[[disturbance]]\nkind = \"b\"\nx = 1\n"));
  EXPECT_FALSE(file.scene_file);
  EXPECT_NO_THROW(file.settings.finish());  // not ours to judge

  const auto platform = file.others("platform");
  ASSERT_EQ(platform.size(), 1u);
  EXPECT_EQ(platform[0].number("mass_kg"), 7.0);
  EXPECT_THROW(platform[0].finish(), InputError);

  const auto disturbances = file.others("disturbance");
  ASSERT_EQ(disturbances.size(), 2u);
  EXPECT_EQ(disturbances[0].text("kind"), "a");
  EXPECT_NO_THROW(disturbances[0].finish());
  EXPECT_EQ(disturbances[1].name(), "disturbance[1]");
  EXPECT_TRUE(file.others("sensors").empty());
}

TEST(ExperimentFile, WithoutTorqueMapTiltsToAllSidesAreLookedAt) {
  const std::string attitude = "[attitude]\ntilt_deg = 20\nheading_deg = -90\n";
  const AttitudeGrid all = read_experiment_file(test_file("tilted.toml", attitude)).torque_map;
  ASSERT_EQ(all.tilt_rad.size(), 4u);
  EXPECT_EQ(all.tilt_rad.front(), 0.0);
  EXPECT_DOUBLE_EQ(all.tilt_rad.back(), 30 * degree_rad);
  ASSERT_EQ(all.heading_rad.size(), 8u);
  EXPECT_DOUBLE_EQ(all.heading_rad.back(), 315 * degree_rad);
  // An axis that the table leaves out is the experiment's own attitude.
  const AttitudeGrid stated =
      read_experiment_file(
          test_file("tilted.toml", attitude + "[torque_map]\ntilt_deg = [0, 10]\n"))
          .torque_map;
  EXPECT_EQ(stated.tilt_rad.size(), 2u);
  ASSERT_EQ(stated.heading_rad.size(), 1u);
  EXPECT_DOUBLE_EQ(stated.heading_rad[0], -90 * degree_rad);
}

// The sphere that holds the scene fills the picture's smaller side and stays inside.
TEST(Camera, FramesTheSceneTightly) {
  const double radius_m = 0.37;
  const Camera camera = camera_framing(radius_m);
  const Vec3 forward = (camera.target_m - camera.position_m).normalized();
  const Vec3 right = forward.cross(Vec3::UnitZ()).normalized();
  const Vec3 up = right.cross(forward);
  const double half_width = std::tan(0.5 * camera.field_of_view_rad);
  const double half_height = half_width * camera.height / camera.width;
  double widest = 0.0, highest = 0.0;
  for (int i = 0; i <= 400; ++i) {
    for (int k = 0; k < 400; ++k) {
      const double z = -1.0 + i / 200.0, r = std::sqrt(std::max(0.0, 1.0 - z * z));
      const Vec3 point_m =
          radius_m * Vec3(r * std::cos(k * pi / 200), r * std::sin(k * pi / 200), z);
      const Vec3 seen = point_m - camera.position_m;
      widest = std::max(widest, std::abs(seen.dot(right) / seen.dot(forward)));
      highest = std::max(highest, std::abs(seen.dot(up) / seen.dot(forward)));
    }
  }
  EXPECT_LT(widest, half_width);
  EXPECT_LE(highest, half_height * (1 + 1e-9));
  EXPECT_GT(highest, half_height * 0.999);
}

}  // namespace
}  // namespace photorque
