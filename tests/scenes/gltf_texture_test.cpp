// Base colours from pictures: which triangle gets what, and that even light is absorbed as before.
#include "scenes/gltf/texture.h"

#include "gltf_test_model.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

// Black on the left, white on the right.
BaseColours half_and_half() {
  return {2, 1, {0, 0, 0, 1, 1, 1}};
}

// A square of 2 m in four columns of two triangles, the picture spread over it once.
Mesh columns_of_square() {
  Mesh mesh;
  for (int i = 0; i <= 4; ++i) {
    for (int j = 0; j <= 1; ++j) {
      mesh.vertices_m.emplace_back(0.5 * i, 2.0 * j, 0.0);
      mesh.uv.emplace_back(0.25 * i, 1.0 * j);
    }
  }
  for (uint32_t i = 0; i < 4; ++i) {
    mesh.triangles.push_back({2 * i, 2 * i + 2, 2 * i + 3});
    mesh.triangles.push_back({2 * i, 2 * i + 3, 2 * i + 1});
  }
  return mesh;
}

double area_of(const Mesh& mesh) {
  double area = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3& from = mesh.vertices_m[a];
    area += 0.5 * (mesh.vertices_m[b] - from).cross(mesh.vertices_m[c] - from).norm();
  }
  return area;
}

TEST(GltfTexture, EveryTriangleGetsThePictureUnderIt) {
  const auto steps = gltf::texture_steps(columns_of_square(), half_and_half());
  ASSERT_EQ(steps.size(), 2u);
  EXPECT_EQ(steps[0].colour[1], 0.0);
  EXPECT_EQ(steps[1].colour[1], 1.0);
  for (const gltf::TextureStep& step : steps) {
    EXPECT_EQ(step.mesh.triangles.size(), 4u);
    EXPECT_NEAR(area_of(step.mesh), 2.0, 1e-12);
    EXPECT_EQ(step.mesh.uv.size(), step.mesh.vertices_m.size());
  }
  for (const Vec3& vertex : steps[0].mesh.vertices_m) EXPECT_LE(vertex.x(), 1.0);
}

// Over two triangles the same picture is one grey; the mean is the picture's.
TEST(GltfTexture, ATriangleAcrossAnEdgeGetsTheMean) {
  Mesh mesh;
  mesh.vertices_m = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.uv = {{-1, 0}, {0, 0}, {0, 1}, {-1, 1}};  // once beyond the edge: pictures repeat
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  BaseColours picture = half_and_half();
  picture.width = 64;
  picture.rgb.assign(size_t{64} * 3, 0.0F);
  std::fill(picture.rgb.begin() + size_t{32} * 3, picture.rgb.end(), 1.0F);
  double mean = 0.0;
  for (const gltf::TextureStep& step : gltf::texture_steps(mesh, picture)) {
    mean += step.colour[0] * area_of(step.mesh);
  }
  EXPECT_NEAR(mean, 0.5, 0.01);
}

TestModel pictured_model() {
  const Mesh mesh = columns_of_square();
  std::vector<float> positions, uv;
  std::vector<uint16_t> indices;
  for (const Vec3& v : mesh.vertices_m) {
    for (int k = 0; k < 3; ++k) positions.push_back(static_cast<float>(v[k]));
  }
  for (const Vec2& v : mesh.uv) {
    for (int k = 0; k < 2; ++k) uv.push_back(static_cast<float>(v[k]));
  }
  for (const auto& triangle : mesh.triangles) {
    for (const uint32_t corner : triangle) indices.push_back(static_cast<uint16_t>(corner));
  }
  TestModel model;
  const int position = model.add_accessor(positions, "VEC3");
  model.json["accessors"][static_cast<size_t>(position)]["min"] = {0, 0, 0};
  model.json["accessors"][static_cast<size_t>(position)]["max"] = {2, 2, 0};
  const int texture = model.add_accessor(uv, "VEC2");
  const int corners = model.add_accessor(indices, "SCALAR");
  const int image = model.add_view("a picture");
  const int at = model.add_mesh({{"attributes", {{"POSITION", position}, {"TEXCOORD_0", texture}}},
                                 {"indices", corners},
                                 {"material", 0}});
  model.json["nodes"] = {{{"mesh", at}, {"name", "panel"}}};
  model.json["scenes"] = {{{"nodes", {0}}}};
  model.json["scene"] = 0;
  model.json["images"] = {{{"bufferView", image}, {"mimeType", "image/png"}}};
  model.json["textures"] = {{{"source", 0}}};
  model.json["materials"] = {{{"name", "paint"},
                              {"pbrMetallicRoughness",
                               {{"metallicFactor", 0.0},
                                {"roughnessFactor", 1.0},
                                {"baseColorTexture", {{"index", 0}}}}}}};
  return model;
}

GltfOptions with_pictures() {
  GltfOptions options;
  options.picture = [](const std::string& bytes) {
    EXPECT_EQ(bytes, "a picture");
    return half_and_half();
  };
  return options;
}

// F0 = 0.04 of the surface, and the picture below it.
TEST(GltfTexture, PaintsAbsorptanceWhereItIsAsked) {
  const GltfModel plain = pictured_model().read();
  EXPECT_EQ(plain.scene.instances.size(), 1u);
  EXPECT_THAT(plain.notices, Contains(HasSubstr("(textures are ignored)")));

  const GltfModel model = pictured_model().read(with_pictures());
  ASSERT_EQ(model.scene.instances.size(), 2u);
  double absorbed = 0.0;
  for (const Instance& part : model.scene.instances) {
    EXPECT_EQ(part.node, "panel");
    absorbed += model.scene.surfaces[part.front_surface].absorbed[0] *
                area_of(model.scene.meshes[part.mesh]);
  }
  EXPECT_NEAR(absorbed, 0.96 * 2.0, 1e-12);  // half of 4 m²
  EXPECT_THAT(model.notices,
              Contains(HasSubstr("'paint': absorptance 0 to 0.96 from the picture")));
}

TEST(GltfTexture, OtherCoordinatesThanTheFirstLeaveTheColourAsItIs) {
  for (const nlohmann::json& set : {nlohmann::json(1), nlohmann::json("first")}) {
    TestModel model = pictured_model();
    model.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = set;
    EXPECT_EQ(model.read(with_pictures()).scene.instances.size(), 1u) << set;
  }
}

TEST(GltfTexture, AMeshWithoutCoordinatesIsReported) {
  const std::string reported = "'paint': its picture is ignored";
  TestModel model = pictured_model();
  EXPECT_THAT(model.read(with_pictures()).notices, testing::Not(Contains(HasSubstr(reported))));
  TestModel other = pictured_model();
  other.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]
            ["KHR_texture_transform"]["texCoord"] = 1;
  EXPECT_THAT(other.read(with_pictures()).notices, Contains(HasSubstr("(texCoord)")));
  model.json["meshes"][0]["primitives"][0]["attributes"].erase("TEXCOORD_0");
  const GltfModel bare = model.read(with_pictures());
  EXPECT_EQ(bare.scene.instances.size(), 1u);
  EXPECT_THAT(bare.notices, Contains(HasSubstr(reported)));
}

TEST(GltfTexture, WrongReferencesAreRefusedWhenPicturesAreAsked) {
  const auto message = [](const auto& edit) -> std::string {
    TestModel model = pictured_model();
    edit(model.json);
    EXPECT_NO_THROW(model.read());
    return refusal_of([&] { model.read(with_pictures()); });
  };
  EXPECT_THAT(message([](auto& json) { json["textures"][0]["source"] = 7; }),
              HasSubstr("baseColorTexture: found 7, expected one of images"));
  EXPECT_THAT(message([](auto& json) { json["images"][0]["bufferView"] = 99; }),
              HasSubstr("/images/0/bufferView: found 99, expected one of bufferViews"));
}

}  // namespace
}  // namespace photorque
