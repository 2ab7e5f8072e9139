// One model in every container, and with files beside it.

#include "gltf_test_model.h"
#include "tests/files.h"

namespace photorque {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

TEST(GltfContainers, TextBinaryAndEmbeddedAreOne) {
  const TestModel model = triangle_model();
  const SceneSize text = size_of(model.read().scene);
  const auto no_file = [](const std::string&) -> std::optional<std::string> {
    return std::nullopt;
  };
  const SceneSize binary = size_of(read_gltf_bytes(glb_bytes(model), "a.glb", no_file).scene);
  EXPECT_EQ(text.area_m2, binary.area_m2);
  EXPECT_EQ(text.high_m, binary.high_m);

  // The 36 bytes of the three positions, by Python's base64.b64encode(struct.pack("<9f", ...)).
  TestModel embedded = model;
  embedded.json["buffers"] = {
      {{"byteLength", 36},
       {"uri",
        "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAABAQAAAAAAAAAAAAAAAAAAAgEAAAAAA"}}};
  EXPECT_EQ(size_of(embedded.read().scene).area_m2, text.area_m2);
  embedded.json["buffers"][0]["uri"] =
      "data:,%00%00%00%00%00%00%00%00%00%00%00%00%00%00@@%00%00%00%00%00%00%00%00%00%00%00%00"
      "%00%00%80@%00%00%00%00";
  EXPECT_EQ(size_of(embedded.read().scene).area_m2, text.area_m2);
}

TEST(GltfContainers, UnknownChunksAndTrailingBytesAreReported) {
  TestModel model = triangle_model();
  model.json["buffers"] = {{{"byteLength", model.buffer.size()}}};
  const std::string bytes =
      glb_bytes(chunk_bytes("JSON", model.json.dump()) +
                chunk_bytes(std::string("BIN\0", 4), model.buffer) + chunk_bytes("EXTR", "more")) +
      "tail";
  const GltfModel read = read_gltf_bytes(bytes, "a.glb", model.opener());
  EXPECT_EQ(read.scene.instances.size(), 1u);
  EXPECT_THAT(read.notices, Contains("4 bytes after the end of the GLB are ignored"));
  EXPECT_THAT(read.notices, Contains("GLB chunk 2 is of unknown type and ignored"));
}

TEST(GltfFiles, ExternalBuffersAreFoundBesideTheModelAndRecorded) {
  TestModel model = triangle_model();
  model.json["buffers"] = {{{"byteLength", model.buffer.size()}, {"uri", "sub/my%20data+1.bin"}}};
  test_file("sub/my data+1.bin", model.buffer + "more bytes than declared are legal");
  const GltfModel read = read_gltf(test_file("model.gltf", model.json.dump()));
  EXPECT_NEAR(size_of(read.scene).area_m2, 6.0, 1e-15);
  ASSERT_EQ(read.inputs.size(), 2u);
  EXPECT_EQ(read.inputs[0].first, "model.gltf");
  EXPECT_EQ(read.inputs[1].first, "sub/my data+1.bin");
  EXPECT_EQ(read.inputs[1].second.size(), 32u);
  EXPECT_NE(read.inputs[0].second, read.inputs[1].second);
}

TEST(GltfFiles, ImagesAreNeverNeeded) {
  TestModel model = triangle_model();
  model.json["images"] = {{{"uri", "missing.png"}},
                          {{"uri", "data:image/png;base64,not an image"}},
                          {{"bufferView", 0}, {"mimeType", "image/jpeg"}}};
  model.json["textures"] = {{{"source", 0}}, {{"source", 77}}};
  model.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  model.json["meshes"][0]["primitives"][0]["material"] = 0;
  const GltfModel read = model.read();
  EXPECT_EQ(read.scene.instances.size(), 1u);
  EXPECT_THAT(read.notices, Contains(HasSubstr("textures are ignored")));
}

TEST(GltfFiles, SuggestMillimetresForAHugeScene) {
  TestModel model = triangle_model();
  EXPECT_THAT(model.read().notices, ::testing::Not(Contains(HasSubstr("millimetres"))));
  model.json["nodes"][0]["scale"] = {100, 100, 100};
  EXPECT_THAT(model.read().notices, Contains("the scene reaches 400 m from the body's origin; "
                                             "CAD exports often count millimetres"));
}

// Texts that are no glTF, or ask for more memory than there is.
using ::testing::StartsWith;

std::string error_of_text(const std::string& text) {
  return refusal_of([&] { read_gltf_bytes(text, "model.gltf", TestModel().opener()); });
}

TEST(GltfText, SyntaxErrorsNameTheirLine) {
  EXPECT_THAT(error_of_text("{\n\"asset\": {\"version\": \"2.0\"},\n]"),
              StartsWith("model.gltf:3: found"));
  EXPECT_THAT(error_of_text(""), StartsWith("model.gltf:1: found"));
  EXPECT_THAT(error_of_text("[1, 2]"), HasSubstr("found an array of 2, expected a JSON object"));
  EXPECT_THAT(error_of_text("{\"a\": \"\xff\"}"), StartsWith("model.gltf:1: found"));
}

TEST(GltfText, DeepNestingIsRefusedBeforeItIsBuilt) {
  const std::string deep = "{\"extras\": " + std::string(1000000, '[');
  EXPECT_THAT(error_of_text(deep), HasSubstr("JSON nested deeper than 64"));
}

TEST(GltfText, BracketsInTextsAreNotNesting) {
  const std::string text =
      R"({"asset": {"version": "2.0", "generator": "\"[[[[)" + std::string(100, '{') + "\"}}";
  EXPECT_EQ(error_of_text(text), "");
}

TEST(GltfText, MemoryIsBounded) {
  TestModel model = triangle_model();
  for (int i = 0; i < 2000; ++i) model.add_node({{"mesh", 0}});
  EXPECT_THAT(refusal_of([&] { model.read({.largest_bytes = 1 << 20}); }),
              HasSubstr("expected a model that takes at most 1048576 bytes"));
}

}  // namespace
}  // namespace photorque
