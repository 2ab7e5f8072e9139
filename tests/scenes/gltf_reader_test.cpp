// Laws of reading glTF: frames, transforms, layouts of the same geometry, names.
#include "gltf_test_model.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

using nlohmann::json;
using ::testing::Contains;
using ::testing::HasSubstr;

MATCHER_P2(IsNear, expected, tolerance, "") {
  return (arg - expected).norm() <= tolerance;
}

std::array<Vec3, 3> first_triangle(const TestModel& model) {
  return body_corners(model.read().scene, 0, 0);
}

Vec3 area_vector(const std::array<Vec3, 3>& p) {
  return 0.5 * (p[1] - p[0]).cross(p[2] - p[0]);
}

TEST(GltfFrames, UpInTheFileIsUpInTheBody) {
  TestModel model = triangle_model();
  model.json["nodes"][0]["translation"] = {1, 2, 3};
  const auto p = first_triangle(model);
  EXPECT_THAT(p[0], IsNear(Vec3(1, -3, 2), 0.0));
  EXPECT_THAT(p[1], IsNear(Vec3(4, -3, 2), 0.0));
  EXPECT_THAT(p[2], IsNear(Vec3(1, -3, 6), 0.0));
}

TEST(GltfFrames, AreaVectorTurnsWithTheBody) {
  // Counter-clockwise seen from the file's +z, area 6: the body's −y.
  EXPECT_THAT(area_vector(first_triangle(triangle_model())), IsNear(Vec3(0, -6, 0), 1e-15));
}

TEST(GltfFrames, UnitsScaleTheScene) {
  const GltfModel model = triangle_model().read({.metres_per_unit = 1e-3});
  EXPECT_NEAR(size_of(model.scene).area_m2, 6e-6, 1e-20);
}

TEST(GltfTransforms, TranslationRotationScaleActInThatOrder) {
  TestModel model = triangle_model();
  // A quarter turn about the file's z takes x to y.
  model.json["nodes"][0]["scale"] = {2, 1, 1};
  model.json["nodes"][0]["rotation"] = {0, 0, std::sqrt(0.5), std::sqrt(0.5)};
  model.json["nodes"][0]["translation"] = {10, 0, 0};
  const auto p = first_triangle(model);
  EXPECT_THAT(p[1], IsNear(Vec3(10, 0, 6), 1e-14));  // (3,0,0) → (6,0,0) → (0,6,0) → (10,6,0)
  EXPECT_THAT(p[2], IsNear(Vec3(6, 0, 0), 1e-14));   // (0,4,0) → (−4,0,0) → (6,0,0)
}

TEST(GltfTransforms, MatrixIsByColumns) {
  TestModel model = triangle_model();
  // Shear y into x, and a translation: no rotation and scale can say this.
  model.json["nodes"][0]["matrix"] = {1, 0, 0, 0, 0.5, 1, 0, 0, 0, 0, 1, 0, 7, 8, 9, 1};
  const auto p = first_triangle(model);
  EXPECT_THAT(p[0], IsNear(Vec3(7, -9, 8), 0.0));
  EXPECT_THAT(p[2], IsNear(Vec3(9, -9, 12), 0.0));
}

TEST(GltfTransforms, ParentsActAfterChildren) {
  TestModel model = triangle_model();
  model.add_node({{"children", {0}}, {"name", "arm"}, {"scale", {2, 2, 2}}});
  model.add_node({{"children", {1}}, {"translation", {0, 0, 5}}});
  const GltfModel read = model.read();
  EXPECT_THAT(body_corners(read.scene, 0, 0)[1], IsNear(Vec3(6, -5, 0), 0.0));
  EXPECT_EQ(read.scene.instances[0].node, "part");
  EXPECT_EQ(read.scene.instances[0].path, "node_2/arm/part");
  EXPECT_EQ(read.scene.instances_of("arm").size(), 1u);
}

TEST(GltfTransforms, MirrorKeepsItsNegativeDeterminant) {
  TestModel model = triangle_model();
  model.json["nodes"][0]["scale"] = {-1, 1, 1};
  const Scene scene = model.read().scene;
  EXPECT_NEAR(scene.instances[0].body_from_mesh.linear().determinant(), -1.0, 1e-15);
  EXPECT_THAT(body_corners(scene, 0, 0)[1], IsNear(Vec3(-3, 0, 0), 0.0));
}

TEST(GltfTransforms, NonUniformScaleKeepsThinSheets) {
  TestModel model = triangle_model();
  model.json["nodes"][0]["scale"] = {1, 1, 1e-9};  // along the normal: changes nothing
  EXPECT_NEAR(size_of(model.read().scene).area_m2, 6.0, 1e-14);
}

TEST(GltfTransforms, GpuInstancesRepeatTheMesh) {
  TestModel model = triangle_model();
  const int places = model.add_accessor<float>({0, 0, 0, 0, 0, 1, 0, 0, 2}, "VEC3");
  const int turns = model.add_accessor<int8_t>({0, 0, 0, 127, 0, 127, 0, 0, 0, 0, 0, 127}, "VEC4");
  model.json["accessors"][static_cast<size_t>(turns)]["normalized"] = true;
  const int sizes = model.add_accessor<float>({1, 1, 1, 1, 1, 1, 2, 2, 2}, "VEC3");
  model.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", places}, {"ROTATION", turns}, {"SCALE", sizes}};
  const Scene scene = model.read().scene;
  ASSERT_EQ(scene.instances.size(), 3u);
  EXPECT_EQ(scene.meshes.size(), 1u);
  EXPECT_THAT(body_corners(scene, 0, 0)[1], IsNear(Vec3(3, 0, 0), 0.0));
  // The second is turned by half a turn about the file's y.
  EXPECT_THAT(body_corners(scene, 1, 0)[1], IsNear(Vec3(-3, -1, 0), 1e-15));
  EXPECT_THAT(body_corners(scene, 2, 0)[1], IsNear(Vec3(6, -2, 0), 0.0));
}

// Four corners of a unit square, counter-clockwise from +z, in every way that glTF can say it.
const std::vector<float> square = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};

struct Layout {
  const char* name;
  std::function<TestModel()> make;
};

TestModel from_primitive(TestModel model, const json& primitive) {
  model.add_mesh(primitive);
  model.add_node({{"mesh", 0}});
  return model;
}

template <typename Index>
TestModel indexed(int mode, const std::vector<Index>& indices) {
  TestModel model;
  const int positions = model.add_accessor(square, "VEC3");
  const int corners = model.add_accessor(indices, "SCALAR");
  return from_primitive(
      model, {{"attributes", {{"POSITION", positions}}}, {"indices", corners}, {"mode", mode}});
}

TestModel unindexed(int mode, const std::vector<float>& positions) {
  TestModel model;
  const int accessor = model.add_accessor(positions, "VEC3");
  return from_primitive(model, {{"attributes", {{"POSITION", accessor}}}, {"mode", mode}});
}

// Positions in a record of 24 bytes, after 8 bytes of something else.
TestModel interleaved() {
  TestModel model;
  std::string bytes;
  for (size_t i = 0; i < 4; ++i) {
    bytes += std::string(8, '\x7f');
    bytes += TestModel::bytes_of<float>(
        {square.begin() + static_cast<long>(3 * i), square.begin() + static_cast<long>(3 * i + 3)});
    bytes += std::string(4, '\x7f');
  }
  const int view = model.add_view(bytes);
  model.json["bufferViews"][0]["byteStride"] = 24;
  model.json["accessors"].push_back({{"bufferView", view},
                                     {"byteOffset", 8},
                                     {"componentType", float_type},
                                     {"count", 4},
                                     {"type", "VEC3"}});
  const int corners = model.add_accessor<uint8_t>({0, 1, 2, 0, 2, 3}, "SCALAR");
  return from_primitive(model, {{"attributes", {{"POSITION", 0}}}, {"indices", corners}});
}

// The third corner comes from the sparse part; `based` says whether there is a dense part.
TestModel sparse(bool based) {
  TestModel model;
  std::vector<float> dense = square;
  dense[6] = dense[7] = dense[8] = -99;
  json accessor = {{"componentType", float_type}, {"count", 4}, {"type", "VEC3"}};
  std::vector<uint16_t> where = {2};
  std::vector<float> values = {1, 1, 0};
  if (based) {
    accessor["bufferView"] = model.add_view(TestModel::bytes_of(dense));
  } else {
    where = {1, 2, 3};
    values = {1, 0, 0, 1, 1, 0, 0, 1, 0};
  }
  accessor["sparse"] = {{"count", where.size()},
                        {"indices",
                         {{"bufferView", model.add_view(TestModel::bytes_of(where))},
                          {"componentType", unsigned_short_type}}},
                        {"values", {{"bufferView", model.add_view(TestModel::bytes_of(values))}}}};
  model.json["accessors"].push_back(accessor);
  const int corners = model.add_accessor<uint8_t>({0, 1, 2, 0, 2, 3}, "SCALAR");
  return from_primitive(model, {{"attributes", {{"POSITION", 0}}}, {"indices", corners}});
}

constexpr int triangles = 4, strip = 5, fan = 6;

void PrintTo(const Layout& one, std::ostream* out) {
  *out << one.name;
}

class GltfLayouts : public ::testing::TestWithParam<Layout> {};

TEST_P(GltfLayouts, DescribeTheSameSquare) {
  const Scene scene = GetParam().make().read().scene;
  ASSERT_EQ(scene.instances.size(), 1u);
  const size_t count = scene.meshes[0].triangles.size();
  ASSERT_EQ(count, 2u);
  Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
  for (size_t t = 0; t < count; ++t) {
    const auto p = body_corners(scene, 0, t);
    // Both triangles face the same way: the file's +z, the body's −y.
    EXPECT_THAT(area_vector(p), IsNear(Vec3(0, -0.5, 0), 1e-15));
    sum += area_vector(p);
    moment += 0.5 * (p[0] + p[1] + p[2]) / 3.0;
  }
  EXPECT_THAT(moment, IsNear(Vec3(0.5, 0, 0.5), 1e-15));  // centroid of the unit square
}

INSTANTIATE_TEST_SUITE_P(
    Square, GltfLayouts,
    ::testing::Values(
        Layout{"triangles_u8",
               [] {
                 return indexed<uint8_t>(triangles, {0, 1, 2, 0, 2, 3});
               }},
        Layout{"triangles_u16",
               [] {
                 return indexed<uint16_t>(triangles, {0, 1, 2, 0, 2, 3});
               }},
        Layout{"triangles_u32",
               [] {
                 return indexed<uint32_t>(triangles, {0, 1, 2, 0, 2, 3});
               }},
        Layout{"strip_u8",
               [] {
                 return indexed<uint8_t>(strip, {0, 1, 3, 2});
               }},
        Layout{"fan_u16",
               [] {
                 return indexed<uint16_t>(fan, {0, 1, 2, 3});
               }},
        Layout{
            "triangles",
            [] {
              return unindexed(triangles, {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0});
            }},
        Layout{"strip",
               [] {
                 return unindexed(strip, {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
               }},
        Layout{"fan", [] { return unindexed(fan, square); }},
        Layout{"interleaved", [] { return interleaved(); }},
        Layout{"sparse", [] { return sparse(true); }},
        Layout{"sparse_on_zeros", [] { return sparse(false); }}),
    [](const auto& test) { return test.param.name; });

TEST(GltfGeometry, KeepsPositionsToTheBit) {
  TestModel model;
  const std::vector<float> positions = {0.1f, -1.0f / 3.0f, 1e-7f, 3e5f, 2.5f, 0, 0, 1, 1e-3f};
  const int accessor = model.add_accessor(positions, "VEC3");
  model.add_mesh({{"attributes", {{"POSITION", accessor}}}});
  model.add_node({{"mesh", 0}});
  const Mesh mesh = model.read().scene.meshes.at(0);
  for (size_t i = 0; i < 9; ++i) {
    EXPECT_EQ(mesh.vertices_m[i / 3][static_cast<Eigen::Index>(i % 3)],
              static_cast<double>(positions[i]));
  }
}

TEST(GltfGeometry, LeavesOutTrianglesWithoutAreaAndUnusedVertices) {
  TestModel model = indexed<uint16_t>(triangles, {0, 1, 2, 0, 0, 2, 3, 3, 3, 1, 2, 1});
  const GltfModel read = model.read();
  ASSERT_EQ(read.scene.meshes.size(), 1u);
  EXPECT_EQ(read.scene.meshes[0].triangles.size(), 1u);
  EXPECT_EQ(read.scene.meshes[0].vertices_m.size(), 3u);
  EXPECT_THAT(read.notices, Contains("3 triangle(s) without area left out"));
}

// A corner that is damaged makes a needle of its triangle, and half of a plate went with it unseen.
TEST(GltfGeometry, RefusesCornersBeyondEverythingThoughTheirTrianglesAreNeedles) {
  const TestModel model =
      unindexed(triangles, {0, 0, 0, 1, 0, 0, 0, 0, 1, 3e38f, 0, 0, 1, 0, 0, 0, 0, 1});
  EXPECT_THAT(refusal_of([&] { model.read(); }), HasSubstr("m away, expected at most 1e9 m"));
}

TEST(GltfGeometry, SkipsPointsAndLines) {
  for (int mode = 0; mode < 4; ++mode) {
    const GltfModel read = unindexed(mode, square).read();
    EXPECT_TRUE(read.scene.instances.empty()) << mode;
    EXPECT_THAT(read.notices, Contains(HasSubstr("1 primitive(s) without triangles")));
  }
}

template <typename Number>
TestModel with_uv(const std::vector<Number>& uv, bool normalized) {
  TestModel model = triangle_model();
  const int accessor = model.add_accessor(uv, "VEC2");
  model.json["accessors"][static_cast<size_t>(accessor)]["normalized"] = normalized;
  // Vertex attributes start at multiples of four; two bytes or shorts a vertex do so by a stride.
  model.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = accessor;
  return model;
}

TEST(GltfGeometry, ScalesNormalizedTextureCoordinates) {
  const std::vector<Vec2> expected = {{0, 1}, {1, 0}, {0.2, 0.6}};
  const TestModel layouts[] = {with_uv<float>({0, 1, 1, 0, 0.2f, 0.6f}, false),
                               with_uv<uint8_t>({0, 255, 255, 0, 51, 153}, true),
                               with_uv<uint16_t>({0, 65535, 65535, 0, 13107, 39321}, true)};
  for (const TestModel& model : layouts) {
    const Mesh mesh = model.read().scene.meshes.at(0);
    ASSERT_EQ(mesh.uv.size(), 3u);
    for (size_t i = 0; i < 3; ++i) EXPECT_LT((mesh.uv[i] - expected[i]).norm(), 4e-8);  // float
  }
}

TEST(GltfGeometry, TextureCoordinatesThatAreNotFiniteAreDropped) {
  const GltfModel read = with_uv<float>({0, 1, NAN, 0, 0, 1}, false).read();
  EXPECT_TRUE(read.scene.meshes.at(0).uv.empty());
  EXPECT_THAT(read.notices, Contains(HasSubstr("texture coordinates that are not finite")));
}

TEST(GltfGeometry, SharesMeshesBetweenNodesAndMaterials) {
  TestModel model = triangle_model();
  model.json["materials"] = {{{"name", "a"}}, {{"name", "b"}}};
  const json mesh = model.json["meshes"][0];
  model.json["meshes"].push_back(mesh);
  model.json["meshes"][0]["primitives"][0]["material"] = 0;
  model.json["meshes"][1]["primitives"][0]["material"] = 1;
  model.add_node({{"mesh", 0}, {"translation", {9, 0, 0}}});
  model.add_node({{"mesh", 1}, {"translation", {18, 0, 0}}});
  const Scene scene = model.read().scene;
  EXPECT_EQ(scene.meshes.size(), 1u);
  ASSERT_EQ(scene.instances.size(), 3u);
  EXPECT_EQ(scene.instances[0].material, "a");
  EXPECT_EQ(scene.instances[1].node, "node_1");
  EXPECT_EQ(scene.instances[2].material, "b");
  EXPECT_EQ(scene.surfaces.size(), 2u);
}

TEST(GltfScenes, TheDefaultSceneIsRead) {
  TestModel model = triangle_model();
  model.add_node({{"mesh", 0}, {"name", "other"}});
  model.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1}}}};
  EXPECT_EQ(model.read().scene.instances.at(0).node, "part");
  EXPECT_THAT(model.read().notices, Contains(HasSubstr("the first one is taken")));
  model.json["scene"] = 1;
  const Scene scene = model.read().scene;
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(scene.instances[0].node, "other");
}

TEST(GltfScenes, WithoutScenesAllRootsAreRead) {
  TestModel model = triangle_model();
  model.add_node({{"mesh", 0}, {"children", {0}}});
  model.add_node({{"mesh", 0}});
  EXPECT_EQ(model.read().scene.instances.size(), 3u);
}

TEST(GltfScenes, DeepHierarchiesAreWalked) {
  TestModel model = triangle_model();
  for (int i = 0; i < 900; ++i) {
    model.add_node({{"children", {i}}, {"translation", {0, 0.5, 0}}});
  }
  const Scene scene = model.read().scene;
  EXPECT_THAT(body_corners(scene, 0, 0)[0], IsNear(Vec3(0, 0, 450), 1e-9));
}

}  // namespace
}  // namespace photorque
