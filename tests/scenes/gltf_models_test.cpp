// The models that CAD programs and exporters wrote, against counts by another program.
#include <filesystem>

#include "gltf_test_model.h"
#include "tests/outside.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

using ::testing::HasSubstr;

const std::filesystem::path models = photorque::outside::third_party("models");

// From gltf_reference.py, beside this file, run on the same models.
struct Reference {
  const char* file;
  size_t instances;
  size_t triangles;   // over all instances, those without area left out
  size_t degenerate;  // per mesh
  double area_m2;
  Vec3 low_m, high_m;  // body axes
};

void PrintTo(const Reference& one, std::ostream* out) {
  *out << one.file;
}

class GltfModels : public ::testing::TestWithParam<Reference> {};

TEST_P(GltfModels, HaveTheSizeThatAnotherProgramFinds) {
  const Reference& expected = GetParam();
  PHOTORQUE_NEEDS_THIRD_PARTY("models");
  const GltfModel model = read_gltf(models / expected.file);
  EXPECT_EQ(model.scene.instances.size(), expected.instances);
  const SceneSize size = size_of(model.scene);
  EXPECT_EQ(size.triangles, expected.triangles);
  // The reference is printed to nine digits.
  EXPECT_NEAR(size.area_m2, expected.area_m2, 2e-9 * expected.area_m2);
  const double tolerance_m = 2e-9 * (expected.high_m - expected.low_m).norm();
  EXPECT_LT((size.low_m - expected.low_m).cwiseAbs().maxCoeff(), tolerance_m);
  EXPECT_LT((size.high_m - expected.high_m).cwiseAbs().maxCoeff(), tolerance_m);
  const std::string notices = ::testing::PrintToString(model.notices);
  if (expected.degenerate > 0) {
    EXPECT_THAT(notices, HasSubstr(std::to_string(expected.degenerate) + " triangle(s) without"));
  } else {
    EXPECT_THAT(notices, ::testing::Not(HasSubstr("without area")));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Shared, GltfModels,
    ::testing::Values(Reference{"2CylinderEngine.glb",
                                115,
                                110336,
                                10419,
                                2663488.59,
                                {-371.692263, -127.999996, -180.971558},
                                {371.692169, 139.999993, 92.0415617}},
                      Reference{"EXT_mesh_manifold/manifold/manifold.gltf",
                                2,
                                3440,
                                0,
                                62046.0262,
                                {-50, -50, -50},
                                {50, 50, 50}},
                      Reference{"in/TwoCubes.glb",
                                2,
                                24,
                                0,
                                47.9999988,
                                {-3.00000036, -1.0000006, -1},
                                {3.00000048, 1.00000036, 1}},
                      Reference{"blender/01_single_vs_double_sided/01_single_vs_double_sided.gltf",
                                2,
                                1480,
                                0,
                                15.7809416,
                                {-3.49999994, -0.99999994, -0.943208571},
                                {1, 0.99999994, 0.94320887}},
                      Reference{"blender/02_node_hierarchy/02_node_hierarchy.gltf",
                                2,
                                60,
                                0,
                                35.013438,
                                {-1, -1, -1},
                                {5.00000012, 1, 5}},
                      Reference{"blender/02_shared_mesh/02_shared_mesh.gltf",
                                2,
                                24,
                                0,
                                47.9999981,
                                {-1, -1.41421348, -1.41421348},
                                {5, 1.41421348, 1.41421348}},
                      Reference{"blender/15_transmission/15_transmission.gltf",
                                5,
                                4800,
                                0,
                                62.3284627,
                                {-0.999999821, -1.00000036, -1},
                                {9.00000024, 0.999999166, 1}},
                      Reference{
                          "blender/17_ior/17_ior.gltf", 5, 60, 0, 120, {-1, -1, -1}, {13, 1, 1}},
                      Reference{"blender/24_gpu_instancing/24_gpu_instancing.gltf",
                                1900,
                                7656770,
                                0,
                                562090.719,
                                {-339.411277, -339.411277, 0},
                                {339.411277, 339.411277, 13.2981021}}),
    [](const auto& test) {
      return std::filesystem::path(test.param.file).stem().string().insert(0, "Model_");
    });

// Properties that the models' READMEs and exporters state beside sizes.
TEST(GltfModels, ShareTheMeshOfNodesThatShareIt) {
  const auto file = models / "blender/02_shared_mesh/02_shared_mesh.gltf";
  PHOTORQUE_NEEDS_THIRD_PARTY("models");
  const Scene scene = read_gltf(file).scene;
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.instances[0].mesh, scene.instances[1].mesh);
}

// A satellite whose every mesh is packed by Draco. The counts and boxes are those that the file
// states for its accessors, which is what went into the encoder; 14 bits of 17 m are 1 mm.
TEST(GltfModels, UnpackASatelliteFromDraco) {
  const auto file = models / "NASA_Aqua_B_draco.glb";
  PHOTORQUE_NEEDS_THIRD_PARTY("models");
  const GltfModel model = read_gltf(file);
  EXPECT_EQ(model.scene.instances.size(), 6u);
  const SceneSize size = size_of(model.scene);
  // Triangles thinner than the quantum have no area any more; they are counted.
  EXPECT_GE(size.triangles, 48000u);
  EXPECT_THAT(model.notices, ::testing::Contains(HasSubstr(std::to_string(49401 - size.triangles) +
                                                           " triangle(s) without")));
  EXPECT_LT((size.low_m - Vec3(-4.504310, -1.856840, -16.287500)).cwiseAbs().maxCoeff(), 2e-3);
  EXPECT_LT((size.high_m - Vec3(4.894411, 3.222360, 1.490000)).cwiseAbs().maxCoeff(), 2e-3);
  EXPECT_FALSE(model.scene.meshes[0].uv.empty());
}

// An engine plain and packed: 11 bits of each mesh.
TEST(GltfModels, UnpackTheSameEngineAsThePlainOne) {
  const auto packed = models / "2CylinderEngine_draco/2CylinderEngine.gltf";
  PHOTORQUE_NEEDS_THIRD_PARTY("models");
  const Scene draco = read_gltf(packed).scene;
  const SceneSize a = size_of(draco), b = size_of(read_gltf(models / "2CylinderEngine.glb").scene);
  EXPECT_EQ(draco.instances.size(), 115u);
  // Some thinner than the quantum are gone, and faces that cross at a slight angle are cut.
  const auto count = static_cast<double>(b.triangles);
  EXPECT_NEAR(static_cast<double>(a.triangles), count, 1e-3 * count);
  EXPECT_NEAR(a.area_m2, b.area_m2, 1e-3 * b.area_m2);
  EXPECT_LT((a.low_m - b.low_m).norm(), 0.4);
  EXPECT_LT((a.high_m - b.high_m).norm(), 0.4);
}

// A cube of side 2, quantized and packed, with and without a filter on what is not needed.
TEST(GltfModels, UnpackABoxFromMeshopt) {
  PHOTORQUE_NEEDS_THIRD_PARTY("models");
  for (const char* file : {"in/BoxMeshopt.glb", "in/BoxMeshopt.gltf"}) {
    SCOPED_TRACE(file);
    const SceneSize size = size_of(read_gltf(models / file).scene);
    EXPECT_EQ(size.triangles, 12u);
    const Vec3 sides_m = size.high_m - size.low_m;
    EXPECT_NEAR(sides_m.minCoeff(), sides_m.maxCoeff(), 1e-3);
    EXPECT_NEAR(size.area_m2, 6.0 * sides_m.x() * sides_m.x(), 1e-3 * size.area_m2);
  }
}

TEST(GltfModels, RejectMissingFiles) {
  const auto file = models / "in/BoxDraco.gltf";
  PHOTORQUE_NEEDS_THIRD_PARTY("models");
  EXPECT_THAT(refusal_of([&] { read_gltf(file); }), HasSubstr("\"0.bin\", which does not exist"));
}

}  // namespace
}  // namespace photorque
