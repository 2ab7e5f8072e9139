// Packed geometry: what is damaged is refused with its place, what is quantized means the same.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <array>

#include "gltf_test_model.h"

namespace photorque {
namespace {

using ::testing::HasSubstr;

std::string message_of(const TestModel& model) {
  return refusal_of([&] { model.read(); });
}

// The triangle of triangle_model() in integers, with the scale that the file gives to undo it.
TestModel quantized_triangle(bool normalized) {
  TestModel model;
  const int positions =
      normalized ? model.add_accessor<int16_t>({0, 0, 0, 32767, 0, 0, 0, 32767, 0}, "VEC3")
                 : model.add_accessor<uint16_t>({0, 0, 0, 300, 0, 0, 0, 400, 0}, "VEC3");
  model.json["accessors"][0]["normalized"] = normalized;
  model.add_mesh({{"attributes", {{"POSITION", positions}}}});
  model.add_node({{"mesh", 0}});
  if (normalized) {
    model.json["nodes"][0]["scale"] = {3, 4, 1};
  } else {
    model.json["nodes"][0]["scale"] = {0.01, 0.01, 0.01};
  }
  model.json["extensionsUsed"] = {"KHR_mesh_quantization"};
  model.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  return model;
}

TEST(GltfQuantization, MeansTheSameTriangle) {
  for (const bool normalized : {false, true}) {
    const Scene scene = quantized_triangle(normalized).read().scene;
    const Instance& instance = scene.instances.at(0);
    const auto& corners = scene.meshes.at(0).vertices_m;
    EXPECT_NEAR((instance.body_from_mesh * corners[1] - Vec3(3, 0, 0)).norm(), 0.0, 1e-12);
    EXPECT_NEAR((instance.body_from_mesh * corners[2] - Vec3(0, 0, 4)).norm(), 0.0, 1e-12);
  }
}

TEST(GltfQuantization, NeedsItsExtension) {
  TestModel model = quantized_triangle(true);
  model.json.erase("extensionsUsed");
  model.json.erase("extensionsRequired");
  EXPECT_THAT(message_of(model), HasSubstr("expected VEC3 of 5126 (float)"));
}

TestModel with_view_packed(const nlohmann::json& changes) {
  TestModel model = triangle_model();
  const int packed = model.add_view(std::string(64, '\x5a'));
  nlohmann::json extension = {
      {"buffer", 0},      {"byteOffset", model.json["bufferViews"][packed]["byteOffset"]},
      {"byteLength", 64}, {"byteStride", 12},
      {"count", 3},       {"mode", "ATTRIBUTES"}};
  extension.update(changes);
  model.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = extension;
  return model;
}

TEST(GltfMeshopt, DamageIsReportedWithPlaceAndReason) {
  const std::string place = "/bufferViews/0/extensions/EXT_meshopt_compression";
  const std::pair<nlohmann::json, std::string> mistakes[] = {
      {nlohmann::json::object(), ": found data that cannot be decoded"},
      {{{"byteStride", 10}}, "/byteStride: found 10, expected a multiple of 4"},
      {{{"byteStride", 260}}, "/byteStride: found 260"},
      {{{"mode", "FOLDED"}}, "/mode: found \"FOLDED\""},
      {{{"mode", "TRIANGLES"}}, "/byteStride: found 12, expected 2 or 4"},
      {{{"mode", "TRIANGLES"}, {"byteStride", 4}, {"count", 4}}, "/count: found 4"},
      {{{"filter", "OCTAHEDRAL"}}, "/byteStride: found 12, expected 4 or 8"},
      {{{"filter", 3}}, "/filter: found"},
      {{{"buffer", 7}}, ": found buffer 7 without bytes"},
      {{{"byteLength", 1000}}, ": found 1000 bytes from byte"},
      {{{"count", -1}}, "/count: found -1, expected a whole number"},
      {{{"count", 1e15}}, "/count: found"},
      {{{"count", 1ull << 50}}, ": found 1125899906842624 items of 12 bytes"},
  };
  for (const auto& [changes, words] : mistakes) {
    EXPECT_THAT(message_of(with_view_packed(changes)), HasSubstr(place + words)) << changes;
  }
}

TEST(GltfMeshopt, PackedDataHaveTheLengthOfTheirView) {
  const std::array<float, 9> corners = {0, 0, 0, 3, 0, 0, 0, 4, 0};
  std::string bytes(meshopt_encodeVertexBufferBound(3, 12), '\0');
  bytes.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(bytes.data()),
                                          bytes.size(), corners.data(), 3, 12));
  const auto packed = [&](const nlohmann::json& view) {
    TestModel model = triangle_model();
    const int stream = model.add_view(bytes);
    model.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = {
        {"buffer", 0},
        {"byteOffset", model.json["bufferViews"][stream]["byteOffset"]},
        {"byteLength", bytes.size()},
        {"byteStride", 12},
        {"count", 3},
        {"mode", "ATTRIBUTES"}};
    model.json["bufferViews"][0].update(view);
    return model;
  };
  EXPECT_EQ(packed({{"byteLength", 36}}).read().scene.meshes.at(0).vertices_m.size(), 3u);
  EXPECT_THAT(message_of(packed({{"byteLength", 48}})),
              HasSubstr("/bufferViews/0/byteLength: found 48, expected 36"));
  EXPECT_THAT(message_of(packed({{"byteLength", 36}, {"byteStride", 16}})),
              HasSubstr("/bufferViews/0/byteStride: found 16, expected 12"));
}

TEST(GltfDraco, DamageIsReportedWithPlaceAndReason) {
  const auto packed = [](const std::string& bytes, const nlohmann::json& extension) {
    TestModel model = triangle_model();
    model.add_view(bytes);
    model.json["accessors"][0].erase("bufferView");
    model.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] =
        extension;
    return message_of(model);
  };
  const nlohmann::json good = {{"bufferView", 1}, {"attributes", {{"POSITION", 0}}}};
  EXPECT_THAT(packed("no mesh at all", good), HasSubstr("data that cannot be decoded"));
  EXPECT_THAT(packed(std::string("DRACO\x02\x02\x01\x01\0\0", 11), good),
              HasSubstr("data that cannot be decoded"));
  EXPECT_THAT(packed("some bytes", {{"bufferView", 9}, {"attributes", {{"POSITION", 0}}}}),
              HasSubstr("/bufferView: found 9"));
  EXPECT_THAT(packed("some bytes", {{"bufferView", 1}}), HasSubstr("no POSITION"));
  EXPECT_THAT(packed("some bytes", 3), HasSubstr("/bufferView: found nothing"));
}

// u' = 0.5 u, v' = 0.25 v, then a quarter turn that takes +v to +u and +u to −v (the picture's v
// runs down), then (0.1, 0.9).
TEST(GltfTextureTransform, MovesTheCoordinatesOfMaps) {
  TestModel model;
  const int positions = model.add_accessor<float>({0, 0, 0, 3, 0, 0, 0, 4, 0}, "VEC3");
  const int uv = model.add_accessor<float>({0, 0, 1, 0, 0, 1}, "VEC2");
  model.add_mesh({{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uv}}}, {"material", 0}});
  model.add_node({{"mesh", 0}});
  nlohmann::json texture = {{"index", 0}};
  texture["extensions"]["KHR_texture_transform"] = {
      {"offset", {0.1, 0.9}}, {"rotation", 0.5 * 3.14159265358979}, {"scale", {0.5, 0.25}}};
  model.json["materials"].push_back({{"pbrMetallicRoughness", {{"baseColorTexture", texture}}}});
  const Scene scene = model.read().scene;
  EXPECT_NEAR((scene.meshes[0].uv.at(0) - Vec2(0.1, 0.9)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((scene.meshes[0].uv.at(1) - Vec2(0.1, 0.4)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((scene.meshes[0].uv.at(2) - Vec2(0.35, 0.9)).norm(), 0.0, 1e-12);
}

}  // namespace
}  // namespace photorque
