// Damage done to good models, at random but the same in every run: reading them either works, and
// gives a sane scene, or throws InputError; under the sanitizers also: touches no memory it should
// not.

#include "gltf_test_model.h"

namespace photorque {
namespace {

using nlohmann::json;

// Indexed, interleaved, sparse, strip, texture coordinates, GPU instances, hierarchy, extras.
TestModel rich_model() {
  TestModel model = triangle_model();
  const std::string corners =
      TestModel::bytes_of<float>({0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 1, 1, 1, 0, 0});
  const int view = model.add_view(corners);
  json& views = model.json["bufferViews"];
  views[static_cast<size_t>(view)]["byteStride"] = 20;
  json& accessors = model.json["accessors"];
  accessors.push_back(
      {{"bufferView", view}, {"componentType", float_type}, {"count", 4}, {"type", "VEC3"}});
  accessors.push_back({{"bufferView", view},
                       {"byteOffset", 12},
                       {"componentType", float_type},
                       {"count", 4},
                       {"type", "VEC2"}});
  const int strip = model.add_accessor<uint16_t>({0, 1, 2, 3}, "SCALAR");
  accessors[1]["sparse"] = {
      {"count", 1},
      {"indices",
       {{"bufferView", model.add_view(std::string(1, '\2'))},
        {"componentType", unsigned_byte_type}}},
      {"values", {{"bufferView", model.add_view(TestModel::bytes_of<float>({0, 2, 1}))}}}};
  const int mesh = model.add_mesh({{"attributes", {{"POSITION", 1}, {"TEXCOORD_0", 2}}},
                                   {"indices", strip},
                                   {"mode", 5},
                                   {"material", 0}});
  model.json["materials"] =
      json::array({{{"name", "cell"},
                    {"doubleSided", true},
                    {"extras", {{"photorque", {{"absorptance", 0.9}, {"specular", 0.1}}}}}}});
  const int places = model.add_accessor<float>({0, 0, 0, 0, 0, 5}, "VEC3");
  const int child = model.add_node(
      {{"mesh", mesh},
       {"rotation", {0, 0, 0, 1}},
       {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", places}}}}}}}});
  const int parent = model.add_node(
      {{"children", {child}}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3, 0, 0, 1}}});
  model.json["scenes"] = json::array({{{"nodes", {0, parent}}}});
  model.json["scene"] = 0;
  return model;
}

// True when the bytes were read.
bool try_reading(const std::string& bytes, const std::string& name, const GltfOpen& open) {
  GltfModel model;
  try {
    model = read_gltf_bytes(bytes, name, open, {.largest_bytes = 1 << 24});
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return false;
  }
  const Scene& scene = model.scene;
  for (const Mesh& mesh : scene.meshes) {
    for (const Vec3& vertex : mesh.vertices_m) EXPECT_TRUE(vertex.allFinite());
    EXPECT_TRUE(mesh.uv.empty() || mesh.uv.size() == mesh.vertices_m.size());
    for (const auto& triangle : mesh.triangles) {
      for (const uint32_t corner : triangle) EXPECT_LT(corner, mesh.vertices_m.size());
    }
  }
  for (const Instance& instance : scene.instances) {
    EXPECT_LT(instance.mesh, scene.meshes.size());
    EXPECT_LT(std::max(instance.front_surface, instance.back_surface), scene.surfaces.size());
    EXPECT_TRUE(instance.body_from_mesh.matrix().allFinite());
  }
  for (const OpticalSurface& surface : scene.surfaces) {
    EXPECT_NEAR(
        surface.absorbed[0] + surface.specular[0] + surface.diffuse[0] + surface.transmitted[0],
        1.0, 1e-12);
  }
  return true;
}

// Every number, text and list of a document, by JSON pointer.
void collect_places(const json& value, const json::json_pointer& here,
                    std::vector<json::json_pointer>* places) {
  places->push_back(here);
  if (value.is_object()) {
    for (const auto& [key, item] : value.items()) collect_places(item, here / key, places);
  } else if (value.is_array()) {
    for (size_t i = 0; i < value.size(); ++i) collect_places(value[i], here / i, places);
  }
}

TEST(GltfMutations, GoodModelsAreRead) {
  const TestModel model = rich_model();
  EXPECT_EQ(size_of(model.read().scene).triangles, 5u);
  EXPECT_TRUE(try_reading(model.text(), "a.gltf", model.opener()));
  EXPECT_TRUE(try_reading(glb_bytes(model), "a.glb", model.opener()));
}

TEST(GltfMutations, EveryValueReplacedByEveryMisfit) {
  const TestModel good = rich_model();
  const json misfits[] = {nullptr,
                          true,
                          -1,
                          0,
                          1,
                          2,
                          3,
                          255,
                          4294967296,
                          9007199254740992,
                          -1e300,
                          1e300,
                          0.5,
                          "",
                          "x",
                          json::array(),
                          json::object(),
                          {0, 0}};
  std::vector<json::json_pointer> places;
  collect_places(good.json, json::json_pointer(), &places);
  size_t read = 0;
  for (const json::json_pointer& place : places) {
    TestModel bad = good;
    for (const json& misfit : misfits) {
      bad.json[place] = misfit;
      if (bad.json.is_object()) read += try_reading(bad.text(), "a.gltf", bad.opener());
    }
    if (place.empty()) continue;
    // The member left out altogether.
    bad = good;
    json& parent = bad.json[place.parent_pointer()];
    if (parent.is_object()) {
      parent.erase(place.back());
      read += try_reading(bad.text(), "a.gltf", bad.opener());
    }
  }
  EXPECT_GT(places.size(), 100u);
  EXPECT_GT(read, 100u);  // names, offsets and the like may be many things
}

}  // namespace
}  // namespace photorque
