// Scenes that can be traced and whose results are doubtful.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scenes/experiment/experiment.h"

namespace photorque {
namespace {

// A square in the plane z = 0, looking up, from (0, 0) to (1, 1).
Mesh square_mesh() {
  Mesh mesh;
  mesh.vertices_m = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

// A cube of side 2 about the origin, looking out.
Mesh cube() {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices_m.emplace_back(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  mesh.encloses = true;
  return mesh;
}

OpticalSurface black() {
  OpticalSurface surface;
  surface.absorbed.fill(1.0);
  surface.specular.fill(0.0);
  surface.diffuse.fill(0.0);
  surface.transmitted.fill(0.0);
  return surface;
}

Scene scene_of(const std::vector<Mesh>& meshes) {
  Scene scene;
  scene.surfaces = {black()};
  for (const Mesh& mesh : meshes) {
    Instance instance;
    instance.path = "part" + std::to_string(scene.meshes.size());
    instance.mesh = static_cast<uint32_t>(scene.meshes.size());
    scene.meshes.push_back(mesh);
    scene.instances.push_back(instance);
  }
  return scene;
}

Beam lamp_at(const Vec3& position_m) {
  return {"lamp", nullptr, {Quat::Identity(), position_m}, {}};
}

TEST(Doubts, NameLampsInsideClosedParts) {
  const Scene scene = scene_of({cube()});
  const std::vector<Beam> inside = {lamp_at({0.3, -0.9, 0.5})};
  const auto lines = geometry_warnings(scene, inside, {});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_THAT(lines[0], testing::HasSubstr("lamp stands inside the closed part part0"));
  for (const Vec3& outside : {Vec3(0, 0, 1.0), Vec3(0, 0, 1.5), Vec3(5, 0, 0)}) {
    EXPECT_TRUE(geometry_warnings(scene, std::vector<Beam>{lamp_at(outside)}, {}).empty());
  }
  // A lamp outside is inside after the platform has turned.
  const std::vector<Beam> corner = {lamp_at({1.2, 0, 0})};
  EXPECT_TRUE(geometry_warnings(scene, corner, {}).empty());
  EXPECT_EQ(geometry_warnings(scene, corner, lab_from_body_at(M_PI / 4, M_PI / 2)).size(), 0u);
  EXPECT_EQ(geometry_warnings(scene, corner, {Quat(Eigen::AngleAxisd(M_PI / 4, Vec3::UnitZ())), {}})
                .size(),
            1u);
}

// A lamp and a sheet in a closed chamber are an experiment; a lamp in a body with an arm outside is
// a mistake.
TEST(Doubts, AllowLampsInChambers) {
  Mesh arm = square_mesh();
  for (Vec3& vertex : arm.vertices_m) vertex += Vec3(0, 0, 1);  // on the lid
  const std::vector<Beam> inside = {lamp_at({0.3, -0.9, 0.5})};
  for (const bool is_chamber : {true, false}) {
    Scene scene = scene_of({square_mesh(), cube(), is_chamber ? square_mesh() : arm});
    open_chambers(scene, inside, {});
    EXPECT_EQ(scene.meshes[1].encloses, !is_chamber);
    EXPECT_EQ(geometry_warnings(scene, inside, {}).size(), is_chamber ? 0u : 1u);
    Scene dark = scene_of({square_mesh(), cube()});
    open_chambers(dark, std::vector<Beam>{lamp_at({0, 0, 5})}, {});
    EXPECT_TRUE(dark.meshes[1].encloses);
  }
}

TEST(Doubts, NamePartsThatSinglePrecisionDoesNotResolve) {
  Mesh tiny = square_mesh();
  for (Vec3& vertex : tiny.vertices_m) vertex = 1e-6 * vertex + Vec3(0, 0, 5);
  EXPECT_TRUE(geometry_warnings(scene_of({square_mesh()}), {}, {}).empty());
  Mesh far = square_mesh();
  for (Vec3& vertex : far.vertices_m) vertex += Vec3(1e3, 0, 0);
  const auto lines = geometry_warnings(scene_of({tiny, far}), {}, {});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_THAT(lines[0], testing::HasSubstr("the smallest is part0"));
}

}  // namespace
}  // namespace photorque
