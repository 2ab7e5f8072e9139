// glTF models made in memory, for tests.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/errors.h"
#include "scenes/gltf/reader.h"
#include "tests/refusal.h"

namespace photorque {

constexpr int byte_type = 5120, unsigned_byte_type = 5121, short_type = 5122,
              unsigned_short_type = 5123, unsigned_int_type = 5125, float_type = 5126;

template <typename Number>
constexpr int component_type_of();
template <>
constexpr int component_type_of<int8_t>() {
  return byte_type;
}
template <>
constexpr int component_type_of<uint8_t>() {
  return unsigned_byte_type;
}
template <>
constexpr int component_type_of<int16_t>() {
  return short_type;
}
template <>
constexpr int component_type_of<uint16_t>() {
  return unsigned_short_type;
}
template <>
constexpr int component_type_of<uint32_t>() {
  return unsigned_int_type;
}
template <>
constexpr int component_type_of<float>() {
  return float_type;
}

// A document and its one buffer. Tests edit `json` as they like.
struct TestModel {
  nlohmann::json json = {{"asset", {{"version", "2.0"}}}};
  std::string buffer;

  // Appends bytes at a multiple of four and a bufferView of them; returns its index.
  int add_view(const std::string& bytes) {
    buffer.resize((buffer.size() + 3) / 4 * 4);
    json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", bytes.size()}});
    buffer += bytes;
    return static_cast<int>(json["bufferViews"].size()) - 1;
  }

  template <typename Number>
  static std::string bytes_of(const std::vector<Number>& numbers) {
    std::string bytes(numbers.size() * sizeof(Number), '\0');
    std::memcpy(bytes.data(), numbers.data(), bytes.size());
    return bytes;
  }

  // A tightly packed accessor; returns its index. `type` is "SCALAR", "VEC2", "VEC3", "VEC4".
  template <typename Number>
  int add_accessor(const std::vector<Number>& numbers, const std::string& type) {
    const size_t width = type == "SCALAR" ? 1 : static_cast<size_t>(type.back() - '0');
    json["accessors"].push_back({{"bufferView", add_view(bytes_of(numbers))},
                                 {"componentType", component_type_of<Number>()},
                                 {"count", numbers.size() / width},
                                 {"type", type}});
    return static_cast<int>(json["accessors"].size()) - 1;
  }

  // A mesh with this one primitive; returns its index.
  int add_mesh(const nlohmann::json& primitive) {
    json["meshes"].push_back({{"primitives", nlohmann::json::array({primitive})}});
    return static_cast<int>(json["meshes"].size()) - 1;
  }

  int add_node(const nlohmann::json& node) {
    json["nodes"].push_back(node);
    return static_cast<int>(json["nodes"].size()) - 1;
  }

  std::string text() const {
    nlohmann::json document = json;
    if (!buffer.empty() && !document.contains("buffers")) {
      document["buffers"] = nlohmann::json::array(
          {nlohmann::json{{"byteLength", buffer.size()}, {"uri", "model.bin"}}});
    }
    return document.dump();
  }

  GltfOpen opener() const {
    return [bytes = buffer](const std::string& path) -> std::optional<std::string> {
      if (path != "model.bin") return std::nullopt;
      return bytes;
    };
  }

  GltfModel read(const GltfOptions& options = {}) const {
    return read_gltf_bytes(text(), "model.gltf", opener(), options);
  }
};

// Little-endian bytes of a word.
inline std::string word_bytes(uint32_t word) {
  std::string bytes;
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(word >> 8 * i & 0xFF);
  return bytes;
}

inline std::string chunk_bytes(const std::string& type, std::string data) {
  data.resize((data.size() + 3) / 4 * 4, type == "JSON" ? ' ' : '\0');
  return word_bytes(static_cast<uint32_t>(data.size())) + type + data;
}

inline std::string glb_bytes(const std::string& chunks) {
  return "glTF" + word_bytes(2) + word_bytes(static_cast<uint32_t>(12 + chunks.size())) + chunks;
}

// The model as a binary file, its buffer in the BIN chunk.
inline std::string glb_bytes(TestModel model) {
  model.json["buffers"] =
      nlohmann::json::array({nlohmann::json{{"byteLength", model.buffer.size()}}});
  return glb_bytes(chunk_bytes("JSON", model.json.dump()) +
                   chunk_bytes(std::string("BIN\0", 4), model.buffer));
}

// One right-angled triangle with corners (0,0,0), (3,0,0), (0,4,0) in glTF axes: area 6, facing +z
// of the file, which is −y of the body.
inline TestModel triangle_model() {
  TestModel model;
  const int positions = model.add_accessor<float>({0, 0, 0, 3, 0, 0, 0, 4, 0}, "VEC3");
  model.add_mesh({{"attributes", {{"POSITION", positions}}}});
  model.add_node({{"mesh", 0}, {"name", "part"}});
  return model;
}

// The corners of triangle `t` of instance `i`, in the body frame.
inline std::array<Vec3, 3> body_corners(const Scene& scene, size_t i, size_t t) {
  const Instance& instance = scene.instances.at(i);
  const Mesh& mesh = scene.meshes.at(instance.mesh);
  std::array<Vec3, 3> corners;
  for (size_t k = 0; k < 3; ++k) {
    corners[k] = instance.body_from_mesh * mesh.vertices_m.at(mesh.triangles.at(t)[k]);
  }
  return corners;
}

// Triangles and area over all instances, and the box around them, in the body frame.
struct SceneSize {
  size_t triangles = 0;
  double area_m2 = 0.0;
  Vec3 low_m = Vec3::Constant(1e300);
  Vec3 high_m = Vec3::Constant(-1e300);
};
inline SceneSize size_of(const Scene& scene) {
  SceneSize size;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    std::vector<Vec3> corners;
    for (const Vec3& vertex : mesh.vertices_m) {
      corners.push_back(instance.body_from_mesh * vertex);
      size.low_m = size.low_m.cwiseMin(corners.back());
      size.high_m = size.high_m.cwiseMax(corners.back());
    }
    size.triangles += mesh.triangles.size();
    for (const auto& triangle : mesh.triangles) {
      const double* a = corners[triangle[0]].data();
      const double* b = corners[triangle[1]].data();
      const double* c = corners[triangle[2]].data();
      const double u[] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
      const double v[] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
      size.area_m2 += 0.5 * std::hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                                       u[0] * v[1] - u[1] * v[0]);
    }
  }
  return size;
}

}  // namespace photorque
