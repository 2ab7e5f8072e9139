// Texts that are no glTF, or ask for more memory than there is.
#include "gltf_test_model.h"

namespace photorque {
namespace {

using ::testing::HasSubstr;
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
