// Light that gets into closed bodies: a box of 1 m in parallel light of 1 W/m², by area alone.
#include "receivers/inside_light.h"

#include <gmock/gmock.h>

#include "tests/raytrace/test_scenes.h"

namespace photorque {
namespace {

using fixtures::ParallelBeam;

struct LitBox {
  Scene scene;
  TraceResult result;
  std::vector<InsideLightReceiver::Part> lit;

  explicit LitBox(Mesh mesh, const OpticalSurface& surface = grey_surface("black", 0, 0)) {
    mesh.encloses = true;
    scene.meshes.push_back(std::move(mesh));
    scene.surfaces.push_back(surface);
    Instance box;
    box.node = box.path = "box";
    scene.instances.push_back(box);
    const InsideLightReceiver watch(scene);
    if (watch.bins() == 0) return;
    // 2 m square from 5 m above, 4 W.
    RigidTransform lab_from_lamp;
    lab_from_lamp.rotation = Eigen::AngleAxisd(pi, Vec3::UnitX());
    lab_from_lamp.translation_m = Vec3(0.5, 0.5, 5.0);
    const Beam beam{"lamp", std::make_shared<ParallelBeam>(4.0, 2.0), lab_from_lamp, {}};
    const Receiver* const receivers[] = {&watch};
    result = trace(TraceableScene(scene), {}, std::span(&beam, 1), receivers, {.rays = 1 << 18});
    lit = watch.lit_inside(result.sums[0]);
  }
};

Mesh unit_box() {
  return fixtures::box(Vec3::Zero(), Vec3::Ones());
}

// One of the two triangles of the lid.
Mesh without_half_a_lid() {
  Mesh mesh = unit_box();
  const auto is_top = [&](const std::array<uint32_t, 3>& triangle) {
    return std::all_of(triangle.begin(), triangle.end(),
                       [&](uint32_t v) { return mesh.vertices_m[v].z() == 1.0; });
  };
  mesh.triangles.erase(std::find_if(mesh.triangles.begin(), mesh.triangles.end(), is_top));
  return mesh;
}

TEST(InsideLight, NoneInAClosedBody) {
  const LitBox box(unit_box());
  EXPECT_TRUE(box.lit.empty());
  EXPECT_EQ(describe_inside_light(box.scene, box.lit, 4.0), "");
}

TEST(InsideLight, EqualsTheLightThroughTheHole) {
  const LitBox box(without_half_a_lid());
  ASSERT_EQ(box.lit.size(), 1u);
  EXPECT_NEAR(box.lit[0].inside_W.value, 0.5, 5 * box.lit[0].inside_W.standard_error);
  EXPECT_NEAR(box.lit[0].outside_W.value, 0.5, 5 * box.lit[0].outside_W.standard_error);
  EXPECT_LT(box.lit[0].inside_W.standard_error, 1e-3);
  std::vector<InsideLightReceiver::Part> leak = box.lit;
  leak[0].inside_W.value = 0.04;
  EXPECT_EQ(describe_inside_light(box.scene, leak, 4.0),
            "1 % of the light falls on the inside of closed parts: box (1 %, by cracks)");
  leak[0].inside_W.value = 3e-6;  // of 4 W: rays that meet an edge exactly
  EXPECT_EQ(describe_inside_light(box.scene, leak, 4.0), "");
}

TEST(InsideLight, ReportsABodyThatIsInsideOut) {
  Mesh mesh = unit_box();
  for (auto& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
  const LitBox box(mesh);
  ASSERT_EQ(box.lit.size(), 1u);
  EXPECT_NEAR(box.lit[0].inside_W.value, 1.0, 5 * box.lit[0].inside_W.standard_error);
  EXPECT_THAT(describe_inside_light(box.scene, box.lit, 4.0),
              ::testing::HasSubstr("turned inside out"));
  std::vector<InsideLightReceiver::Part> all = box.lit;
  all[0].inside_W.value = 4.0;
  EXPECT_THAT(describe_inside_light(box.scene, all, 4.0), ::testing::StartsWith("100 % of the"));
}

TEST(InsideLight, GlassAndSheetsAreNotWatched) {
  EXPECT_TRUE(LitBox(unit_box(), grey_surface("pane", 0.1, 0.0, 0.8)).result.sums.empty());
  Scene sheet;
  sheet.meshes.push_back(unit_box());
  sheet.surfaces.push_back(grey_surface("black", 0, 0));
  sheet.instances.emplace_back();
  EXPECT_EQ(InsideLightReceiver(sheet).bins(), 0u);
}

}  // namespace
}  // namespace photorque
