// Files that are wrong: the corpus of the Khronos validator, and mistakes made one at a time.
#include <filesystem>

#include "core/files.h"
#include "gltf_test_model.h"
#include "tests/outside.h"

namespace photorque {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::filesystem::path corpus = photorque::outside::third_party("models/malformed");

// Files that the validator calls wrong and that are read all the same, because what is wrong cannot
// change a triangle, a transform or an optical property.
const std::map<std::string, std::string> tolerated = {
    {"mesh/accessor_attribute_uint32.gltf", "an unused attribute (_CUSTOM_ATTR)"},
    {"mesh/accessor_unaligned.gltf", "an unused attribute (COLOR_0)"},
    {"mesh/accessor_without_bytestride.gltf",
     "without a stride elements are tightly packed, also when attributes share a view"},
    {"mesh/bufferview_target_override.gltf", "targets are hints to graphics hardware"},
    {"mesh/invalid_attribute.gltf", "an unused attribute (UNKNOWN)"},
    {"mesh/invalid_attribute_escaped_name.gltf", "an unused attribute (~UNKNOWN/2)"},
    {"mesh/invalid_indexed_attribute.gltf", "unused attributes (TEXCOORD_00, ...)"},
    {"mesh/morph_attribute_invalid_count.gltf", "morph targets are not applied (weights refused)"},
    {"mesh/morph_attribute_no_base.gltf", "morph targets are not applied"},
    {"mesh/morph_bufferview_target_override.gltf", "targets are hints to graphics hardware"},
    {"mesh/morph_position_accessor_no_bounds.gltf", "morph targets are not applied"},
    {"mesh/morph_unequal_targets_count.gltf", "morph targets are not applied"},
    {"mesh/morph_weights_wrong_count.gltf", "morph targets are not applied; no node uses the mesh"},
    {"mesh/position_accessor_no_bounds.gltf", "bounds are taken from the positions themselves"},
    {"mesh/unequal_joints.gltf", "joints of a mesh without skin"},
    {"mesh/uv.gltf", "texture coordinates that only textures ask for"},
    {"node/empty_children_array.gltf", "no children, said twice"},
    {"node/weights_with_no_mesh.gltf", "weights of nothing"},
};

// Files that the validator accepts and that are refused, with the reason that the message gives.
const std::map<std::string, std::string> refused = {
    {"accessor/unknown_type.gltf", "/accessors/0/type: found \"NotaVEC3\", expected one of SCALAR"},
    {"buffer/non_relative_uri.gltf",
     "found \"http://example.com/buffer.bin\", expected a relative path inside the model's folder"},
    {"mesh/primitive_incompatible_mode.gltf", "found 4 corners, expected a multiple of 3"},
    {"node/node_weights_override.gltf", "found morph targets with weights, expected rigid meshes"},
    {"node/valid.gltf", "found a skinned mesh, expected rigid meshes"},
};

TEST(GltfCorpus, EveryErrorThatMattersIsRefusedInOneLine) {
  PHOTORQUE_NEEDS_THIRD_PARTY("models/malformed");
  size_t wrong_files = 0, right_files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(corpus)) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".gltf" && extension != ".glb") continue;
    const std::string name = std::filesystem::relative(entry.path(), corpus).generic_string();
    const json report = json::parse(read_file(entry.path().string() + ".report.json"));
    const bool is_wrong = report["issues"]["numErrors"].get<int>() > 0;
    (is_wrong ? wrong_files : right_files) += 1;
    const std::string message = refusal_of([&] { read_gltf(entry.path()); });
    if (refused.contains(name)) {
      EXPECT_THAT(message, HasSubstr(refused.at(name)));
      continue;
    }
    EXPECT_EQ(!message.empty(), is_wrong && !tolerated.contains(name)) << name << ": " << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    if (!message.empty()) {
      EXPECT_THAT(message, StartsWith(entry.path().string() + ":"));
    }
  }
  EXPECT_GT(wrong_files, 80u);
  EXPECT_GT(right_files, 25u);
}

struct Mistake {
  const char* name;
  std::function<void(TestModel&)> make;
  const char* message;  // after "model.gltf: "
};

void PrintTo(const Mistake& mistake, std::ostream* out) {
  *out << mistake.name;
}

class GltfMistakes : public ::testing::TestWithParam<Mistake> {};

json& primitive_of(TestModel& model) {
  return model.json["meshes"][0]["primitives"][0];
}

std::function<void(TestModel&)> set(const char* place, const json& value) {
  return [=](TestModel& m) { m.json[json::json_pointer(place)] = value; };
}

// A model in which everything that a mistake needs exists: see TestModel, plus indices.
TestModel indexed_model() {
  TestModel model = triangle_model();
  primitive_of(model)["indices"] = model.add_accessor<uint16_t>({0, 1, 2}, "SCALAR");
  return model;
}

TEST_P(GltfMistakes, AreReportedWithPlaceAndReason) {
  TestModel model = indexed_model();
  ASSERT_EQ(refusal_of([&] { model.read(); }), "");
  GetParam().make(model);
  EXPECT_THAT(refusal_of([&] { model.read(); }),
              StartsWith(std::string("model.gltf: ") + GetParam().message));
}

void add_sparse(TestModel& model, const std::vector<uint8_t>& where) {
  const std::vector<float> values(3 * where.size(), 0.5f);
  model.json["accessors"][0]["sparse"] = {
      {"count", where.size()},
      {"indices",
       {{"bufferView", model.add_view(TestModel::bytes_of(where))},
        {"componentType", unsigned_byte_type}}},
      {"values", {{"bufferView", model.add_view(TestModel::bytes_of(values))}}}};
}

void replace_float(TestModel& model, size_t index, float value) {
  std::memcpy(model.buffer.data() + 4 * index, &value, sizeof value);
}

INSTANTIATE_TEST_SUITE_P(
    One, GltfMistakes,
    ::testing::Values(
        Mistake{"no_asset", [](TestModel& m) { m.json.erase("asset"); },
                "/asset: found nothing, expected an object"},
        Mistake{"old_version", set("/asset/version", "1.0"),
                "/asset/version: found \"1.0\", expected \"2.0\""},
        Mistake{"later_minimum", set("/asset/minVersion", "2.1"),
                "/asset/minVersion: found \"2.1\", expected \"2.0\""},
        Mistake{"required_extension",
                set("/extensionsRequired", {"KHR_materials_ior", "VENDOR_folded_space"}),
                "/extensionsRequired/1: found \"VENDOR_folded_space\", expected extensions that "
                "this program supports"},
        Mistake{"draco_without_data",
                [](TestModel& m) {
                  primitive_of(m)["extensions"]["KHR_draco_mesh_compression"] = json::object();
                  m.json["accessors"][0].erase("bufferView");
                },
                "/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression/bufferView: found "
                "nothing, expected a whole number"},
        Mistake{"text_for_number", set("/accessors/0/count", "3"),
                "/accessors/0/count: found \"3\", expected an integer >= 1"},
        Mistake{"fraction_for_integer", set("/accessors/0/count", 3.5),
                "/accessors/0/count: found 3.5, expected an integer"},
        Mistake{"absurd_count", set("/accessors/0/count", 1ull << 54),
                "/accessors/0/count: found 18014398509481984, expected an integer"},
        Mistake{"huge_count", set("/accessors/0/count", 1ull << 52),
                "/accessors/0: found 4503599627370496 elements that end at byte"},
        Mistake{"huge_count_of_nothing",
                [](TestModel& m) {
                  m.json["accessors"][0].erase("bufferView");
                  m.json["accessors"][0]["count"] = 3000000000ull;
                },
                "/meshes/0/primitives/0: found 3000000000 items of 4 bytes, expected a model that "
                "takes at most 4294967296 bytes"},
        Mistake{"negative_index", set("/nodes/0/mesh", -1),
                "/nodes/0/mesh: found -1, expected an index below 1, the number of meshes"},
        Mistake{"default_scene_missing", set("/scene", 0),
                "/scene: found 0, expected an index below 0, the number of scenes"},
        Mistake{"short_buffer",
                [](TestModel& m) {
                  m.json["buffers"] = {{{"byteLength", m.buffer.size() + 1},
                                        {"uri", "model.bin"}}};
                },
                "/buffers/0/byteLength: found 43, expected at most the 42 bytes that are there"},
        Mistake{"missing_file", set("/buffers", {{{"byteLength", 4}, {"uri", "gone.bin"}}}),
                "/buffers/0/uri: found \"gone.bin\", which does not exist"},
        Mistake{"absolute_path", set("/buffers", {{{"byteLength", 4}, {"uri", "/etc/passwd"}}}),
                "/buffers/0/uri: found \"/etc/passwd\", expected a relative path"},
        Mistake{"other_scheme", set("/buffers", {{{"byteLength", 4}, {"uri", "file:model.bin"}}}),
                "/buffers/0/uri: found \"file:model.bin\", expected a relative path"},
        Mistake{"broken_base64",
                [](TestModel& m) {
                  m.json["buffers"] = {{{"byteLength", 3},
                                        {"uri", "data:application/octet-stream;base64,AA*A"}}};
                },
                "/buffers/0/uri: found \"data:application/octet-stream;base64,AA*A\", expected "
                "data in base64"},
        Mistake{"placeholder_buffer",
                [](TestModel& m) {
                  m.json["buffers"] = {{{"byteLength", m.buffer.size()}}};
                },
                "/accessors/0/bufferView: found buffer 0 without bytes"},
        Mistake{"view_beyond_buffer", set("/bufferViews/0/byteLength", 43),
                "/bufferViews/0/byteLength: found 43 from byte 0, expected an end within the 42"},
        Mistake{"accessor_beyond_view", set("/accessors/0/count", 4),
                "/accessors/0: found 4 elements that end at byte 48, expected an end within the 36 "
                "bytes of bufferView 0"},
        Mistake{"misaligned", set("/accessors/0/byteOffset", 2),
                "/accessors/0/byteOffset: found 2 in a view at 0, expected multiples of 4"},
        Mistake{"short_stride", set("/bufferViews/0/byteStride", 8),
                "/accessors/0: found elements of 12 bytes, expected at most the stride of 8"},
        Mistake{"odd_stride", set("/bufferViews/0/byteStride", 13),
                "/bufferViews/0/byteStride: found 13, expected a multiple of 4 >= 4 and <= 252"},
        Mistake{"stride_of_indices", set("/bufferViews/1/byteStride", 4),
                "/accessors/1: found 3 elements that end at byte 10"},
        Mistake{"positions_of_shorts",
                [](TestModel& m) {
                  m.json["accessors"][0]["componentType"] = short_type;
                  m.json["accessors"][0]["normalized"] = true;
                },
                "/meshes/0/primitives/0/attributes/POSITION: found VEC3 of 5122 normalized, "
                "expected VEC3 of 5126 (float)"},
        Mistake{"indices_of_floats",
                [](TestModel& m) { primitive_of(m)["indices"] = m.add_accessor<float>({0, 1, 2}, "SCALAR"); },
                "/meshes/0/primitives/0/indices: found SCALAR of 5126, expected SCALAR of 5121"},
        Mistake{"index_too_large", [](TestModel& m) { m.buffer[40] = 3; },
                "/accessors/1: found index 3 at element 2, expected an index below 3"},
        Mistake{"attribute_counts_differ",
                [](TestModel& m) {
                  primitive_of(m)["attributes"]["NORMAL"] =
                      m.add_accessor<float>({0, 0, 1, 0, 0, 1}, "VEC3");
                },
                "/meshes/0/primitives/0/attributes/NORMAL: found 2 elements, expected as many as "
                "POSITION, 3"},
        Mistake{"two_corners", set("/accessors/1/count", 2),
                "/meshes/0/primitives/0: found 2 corners, expected a multiple of 3"},
        Mistake{"two_corners_of_a_strip",
                [](TestModel& m) {
                  m.json["accessors"][1]["count"] = 2;
                  primitive_of(m)["mode"] = 5;
                },
                "/meshes/0/primitives/0: found 2 corners, expected at least 3"},
        Mistake{"unknown_mode", [](TestModel& m) { primitive_of(m)["mode"] = 7; },
                "/meshes/0/primitives/0/mode: found 7, expected an integer >= 0 and <= 6"},
        Mistake{"texture_coordinates_of_three",
                [](TestModel& m) { primitive_of(m)["attributes"]["TEXCOORD_0"] = 0; },
                "/meshes/0/primitives/0/attributes/TEXCOORD_0: found VEC3 of 5126, expected VEC2"},
        Mistake{"position_not_a_number", [](TestModel& m) { replace_float(m, 4, NAN); },
                "/accessors/0: found a position that is not finite at element 1"},
        Mistake{"position_infinite", [](TestModel& m) { replace_float(m, 8, INFINITY); },
                "/accessors/0: found a position that is not finite at element 2"},
        Mistake{"sparse_indices_fall", [](TestModel& m) { add_sparse(m, {2, 1}); },
                "/accessors/0/sparse/indices: found 1 at 1, expected rising indices below 3"},
        Mistake{"sparse_index_too_large", [](TestModel& m) { add_sparse(m, {0, 3}); },
                "/accessors/0/sparse/indices: found 3 at 1, expected rising indices below 3"},
        Mistake{"sparse_longer_than_accessor", [](TestModel& m) { add_sparse(m, {0, 1, 2, 2}); },
                "/accessors/0/sparse/count: found 4, expected at most the accessor's 3"},
        Mistake{"sparse_beyond_view",
                [](TestModel& m) {
                  add_sparse(m, {0});
                  m.json["accessors"][0]["sparse"]["values"]["byteOffset"] = 4;
                },
                "/accessors/0/sparse/values: found 1 elements that end at byte 16"},
        Mistake{"node_below_itself", set("/nodes/0/children", {0}),
                "/nodes/0/children: found a node below itself"},
        Mistake{"cycle_beside_the_scene",
                [](TestModel& m) {
                  m.add_node({{"children", {2}}});
                  m.add_node({{"children", {1}}});
                },
                "/nodes/1/children: found a node below itself, expected a hierarchy without"},
        Mistake{"two_parents",
                [](TestModel& m) {
                  m.add_node({{"children", {0}}});
                  m.add_node({{"children", {0}}});
                },
                "/nodes/2/children/0: found node 0, already a child of node 1"},
        Mistake{"root_twice", set("/scenes", {{{"nodes", {0, 0}}}}),
                "/scenes/0/nodes/1: found node 0 a second time"},
        Mistake{"child_as_root",
                [](TestModel& m) {
                  m.add_node({{"children", {0}}});
                  m.json["scenes"] = {{{"nodes", {1, 0}}}};
                },
                "/scenes/0/nodes/1: found node 0, a child of node 1, expected root nodes"},
        Mistake{"too_deep",
                [](TestModel& m) {
                  for (int i = 0; i < 1000; ++i) m.add_node({{"children", {i}}});
                },
                "/nodes/0: found a hierarchy deeper than 1000"},
        Mistake{"scale_zero", set("/nodes/0/scale", {1, 0, 1}),
                "/nodes/0/scale: found a transform that flattens (zero scale)"},
        Mistake{"flat_matrix",
                set("/nodes/0/matrix", {1, 2, 3, 0, 2, 4, 6, 0, 0, 0, 1, 0, 0, 0, 0, 1}),
                "/nodes/0/matrix: found a transform that flattens"},
        Mistake{"short_matrix", set("/nodes/0/matrix", {1, 0, 0}),
                "/nodes/0/matrix: found an array of 3, expected 16 numbers"},
        Mistake{"projection",
                set("/nodes/0/matrix", {1, 0, 0, 0.5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}),
                "/nodes/0/matrix: found a last row other than 0, 0, 0, 1"},
        Mistake{"rotation_of_length_two", set("/nodes/0/rotation", {0, 0, 0, 2}),
                "/nodes/0/rotation: found a length of 2.000000, expected a unit quaternion"},
        Mistake{"matrix_and_scale",
                [](TestModel& m) {
                  m.json["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
                  m.json["nodes"][0]["scale"] = {1, 1, 1};
                },
                "/nodes/0/scale: found it together with matrix"},
        Mistake{"overflow",
                [](TestModel& m) {
                  m.json["nodes"][0]["scale"] = {1e100, 1, 1};
                  m.add_node({{"children", {0}}, {"scale", {1e100, 1, 1}}});
                },
                "/nodes/0: found a product of transforms that is singular or overflows"},
        Mistake{"far_away", set("/nodes/0/translation", {0, 1e15, 0}),
                "/nodes/0: found a mesh up to 1e+15 m away, expected at most 1e9 m"},
        Mistake{"skin",
                [](TestModel& m) {
                  m.json["skins"] = {{{"joints", {0}}}};
                  m.json["nodes"][0]["skin"] = 0;
                },
                "/nodes/0/skin: found a skinned mesh, expected rigid meshes"},
        Mistake{"morphed",
                [](TestModel& m) {
                  primitive_of(m)["targets"] = {{{"POSITION", 0}}};
                  m.json["meshes"][0]["weights"] = {0.5};
                },
                "/meshes/0/weights: found morph targets with weights"},
        Mistake{"gpu_instance_counts",
                [](TestModel& m) {
                  const int one = m.add_accessor<float>({0, 0, 0}, "VEC3");
                  m.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
                      {"TRANSLATION", 0}, {"SCALE", one}};
                },
                "/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes: found 1 elements, "
                "expected as many as the other attributes, 3"},
        Mistake{"gpu_instance_flat",
                set("/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes", {{"SCALE", 0}}),
                "/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes: found instance 0, "
                "singular or not finite"},
        Mistake{"metallic_beyond_one",
                set("/materials", {{{"pbrMetallicRoughness", {{"metallicFactor", 1.5}}}}}),
                "/materials/0/pbrMetallicRoughness/metallicFactor: found 1.5, expected a number"}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace photorque
