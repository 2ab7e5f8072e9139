#include "scenes/gltf/mesh_closure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/raytrace/test_scenes.h"

namespace photorque {
namespace {

Scene scene_of(Mesh mesh) {
  Scene scene;
  scene.meshes.push_back(std::move(mesh));
  return scene;
}

TEST(MeshClosure, FindsClosedBodiesAndSheets) {
  const MeshClosure box = closure_of(scene_of(fixtures::box(Vec3(0, 0, 0), Vec3(1, 2, 3))));
  EXPECT_EQ(box.closed, 1u);
  EXPECT_EQ(box.open_edges, 0u);
  const MeshClosure sheet =
      closure_of(scene_of(fixtures::rectangle(Vec3::Zero(), Vec3(1, 0, 0), Vec3(0, 1, 0))));
  EXPECT_EQ(sheet.closed, 0u);
  EXPECT_EQ(sheet.open_edges, 4u);
  EXPECT_EQ(box.encloses, std::vector<uint8_t>{1});
  EXPECT_EQ(sheet.encloses, std::vector<uint8_t>{0});
  EXPECT_EQ(describe_closure(sheet), "");  // a sheet is no crack
}

// Two triangles on one side of an edge, one on the other: they share the line, not the corners.
TEST(MeshClosure, FindsTJunctions) {
  Mesh mesh;
  mesh.vertices_m = {{0, 0, 0}, {2, 0, 0}, {1, 1, 0}, {1, 0, 0}, {1, -1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 4, 3}, {3, 4, 1}};
  const MeshClosure closure = closure_of(scene_of(mesh));
  EXPECT_EQ(closure.t_junctions, 1u);
  EXPECT_THAT(describe_closure(closure), testing::HasSubstr("1 of them"));
  mesh.vertices_m[3].y() = -0.01;  // away from the edge: a gap that is drawn
  EXPECT_EQ(closure_of(scene_of(mesh)).t_junctions, 0u);
}

TEST(MeshClosure, WeldsCornersThatExportersSplit) {
  Mesh mesh = fixtures::box(Vec3(0, 0, 0), Vec3(1, 1, 1));
  Mesh split;
  for (const auto& triangle : mesh.triangles) {
    const auto first = static_cast<uint32_t>(split.vertices_m.size());
    for (const uint32_t corner : triangle) split.vertices_m.push_back(mesh.vertices_m[corner]);
    split.triangles.push_back({first, first + 1, first + 2});
  }
  EXPECT_EQ(closure_of(scene_of(split)).closed, 1u);
  split.triangles.pop_back();
  EXPECT_EQ(closure_of(scene_of(split)).open_edges, 3u);
}

// A closed body whose faces do not agree on their front sides has no inside.
TEST(MeshClosure, FindsTurnedFaces) {
  Mesh mesh = fixtures::box(Vec3(0, 0, 0), Vec3(1, 1, 1));
  EXPECT_EQ(closure_of(scene_of(mesh)).with_turned_faces, 0u);
  std::swap(mesh.triangles[3][0], mesh.triangles[3][1]);
  const MeshClosure closure = closure_of(scene_of(mesh));
  EXPECT_EQ(closure.with_turned_faces, 1u);
  EXPECT_EQ(closure.encloses, std::vector<uint8_t>{0});
  EXPECT_THAT(describe_closure(closure), testing::HasSubstr("opposite front sides"));
}

// The rim of a fine sheet has few of its edges: it is a sheet all the same.
TEST(MeshClosure, AFineSheetEnclosesNothing) {
  constexpr uint32_t side = 40;
  Mesh mesh;
  for (uint32_t j = 0; j <= side; ++j) {
    for (uint32_t i = 0; i <= side; ++i) mesh.vertices_m.emplace_back(i, j, 0.01 * i * i);
  }
  for (uint32_t j = 0; j < side; ++j) {
    for (uint32_t i = 0; i < side; ++i) {
      const uint32_t at = j * (side + 1) + i, up = at + side + 1;
      mesh.triangles.push_back({at, at + 1, up + 1});
      mesh.triangles.push_back({at, up + 1, up});
    }
  }
  const MeshClosure closure = closure_of(scene_of(mesh));
  EXPECT_EQ(closure.open_edges, 4 * side);
  EXPECT_EQ(closure.almost_closed, 0u);
  EXPECT_EQ(closure.encloses, std::vector<uint8_t>{0});
}

}  // namespace
}  // namespace photorque
