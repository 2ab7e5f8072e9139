#include "scenes/gltf/geometry.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "scenes/gltf/file/accessor.h"

namespace photorque::gltf {
namespace {

constexpr uint32_t unused = std::numeric_limits<uint32_t>::max();

// Section 3.7.2.1: strips alternate their winding, fans begin with their second corner.
std::vector<Triangle> triangles_of(const std::vector<uint32_t>& corners, int mode) {
  std::vector<Triangle> triangles;
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    for (size_t i = 0; i + 2 < corners.size(); i += 3) {
      triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
    }
    return triangles;
  }
  for (size_t i = 0; i + 2 < corners.size(); ++i) {
    if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
      triangles.push_back({corners[i + 1], corners[i + 2], corners[0]});
    } else {
      triangles.push_back({corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]});
    }
  }
  return triangles;
}

bool is_degenerate(const Vec3& a, const Vec3& b, const Vec3& c) {
  // Differences of floats are exact to 1e-16 of the longest side, their cross product to about
  // 1e-15 of its square. Below the limit the normal would be noise.
  constexpr double rounding = 1e-14;
  const double longest =
      std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return (b - a).cross(c - a).norm() <= rounding * longest;
}

// Accessors without bytes are zeros by the specification. Indices without bytes indicate geometry
// with an unsupported compression; the model is rejected, because it would have no triangles.
void refuse_absent_indices(const Document& document, const tinygltf::Primitive& primitive,
                           const std::string& where) {
  if (primitive.indices < 0) return;
  const auto& accessor = document.model.accessors[static_cast<size_t>(primitive.indices)];
  if (accessor.bufferView < 0 && !accessor.sparse.isSparse) {
    throw document.wrong(where + "/indices", "an accessor without a bufferView",
                         "indices that are stored");
  }
}

// An index of all ones means primitive restart elsewhere; glTF forbids it (section 3.7.2.1).
size_t restart_index(int component_type) {
  if (component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE) return 0xFF;
  return component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ? 0xFFFF : 0xFFFFFFFF;
}

}  // namespace

// Vertices of one primitive, read on demand.
class Vertices {
 public:
  Vertices(const Document& document, const tinygltf::Primitive& primitive, MemoryBudget* budget)
      : document_(document),
        accessor_(primitive.attributes.at("POSITION")),
        positions_(document, accessor_, budget) {
    const auto rest = primitive.attributes.find(position_rest);
    if (rest != primitive.attributes.end()) rests_.emplace(document, rest->second, budget);
    const auto uv = primitive.attributes.find("TEXCOORD_0");
    if (uv != primitive.attributes.end()) coordinates_.emplace(document, uv->second, budget);
  }

  size_t count() const { return positions_.count(); }
  bool have_uv() const { return coordinates_.has_value(); }
  bool are_single() const { return !rests_; }

  Vec3 position(uint32_t vertex) const {
    Vec3 p = positions_.vector3(vertex);
    if (rests_) p += rests_->vector3(vertex);
    if (!p.allFinite()) {
      throw document_.wrong(pointer("accessors", accessor_),
                            "a position that is not finite at element " + std::to_string(vertex),
                            "finite numbers");
    }
    return p;
  }

  Vec2 uv(uint32_t vertex) const {
    return {coordinates_->number(vertex, 0), coordinates_->number(vertex, 1)};
  }

 private:
  const Document& document_;
  int accessor_;
  AccessorReader positions_;
  std::optional<AccessorReader> rests_;
  std::optional<AccessorReader> coordinates_;
};

std::vector<uint32_t> GeometryReader::corners(const tinygltf::Primitive& primitive,
                                              size_t vertex_count, const std::string& where) {
  if (primitive.indices < 0) {
    budget_->charge(vertex_count, sizeof(uint32_t), where);
    std::vector<uint32_t> all(vertex_count);
    std::iota(all.begin(), all.end(), 0u);
    return all;
  }
  const AccessorReader indices(document_, primitive.indices, budget_);
  budget_->charge(indices.count(), sizeof(uint32_t), where);
  std::vector<uint32_t> all(indices.count());
  const int type = document_.model.accessors[static_cast<size_t>(primitive.indices)].componentType;
  const size_t end = std::min(vertex_count, restart_index(type));
  for (size_t i = 0; i < all.size(); ++i) {
    all[i] = static_cast<uint32_t>(indices.number(i, 0));
    if (all[i] >= end) {
      throw document_.wrong(pointer("accessors", primitive.indices),
                            "index " + std::to_string(all[i]) + " at element " + std::to_string(i),
                            "an index below " + std::to_string(end));
    }
  }
  return all;
}

std::vector<uint32_t> GeometryReader::add_triangles(const std::vector<Triangle>& triangles,
                                                    const Vertices& vertices,
                                                    PrimitiveMesh* result) {
  std::vector<uint32_t> used;
  for (const Triangle& triangle : triangles) {
    const std::array<Vec3, 3> p = {vertices.position(triangle[0]), vertices.position(triangle[1]),
                                   vertices.position(triangle[2])};
    if (is_degenerate(p[0], p[1], p[2])) {
      ++result->degenerate;
      for (const Vec3& corner : p)
        result->degenerate_reach = std::max(result->degenerate_reach, corner.norm());
      continue;
    }
    Triangle renumbered{};
    for (size_t k = 0; k < 3; ++k) {
      uint32_t& number = new_index_[triangle[k]];
      if (number == unused) {
        number = static_cast<uint32_t>(used.size());
        used.push_back(triangle[k]);
        result->mesh.vertices_m.push_back(p[k]);
      }
      renumbered[k] = number;
    }
    result->mesh.triangles.push_back(renumbered);
  }
  return used;
}

std::optional<PrimitiveMesh> GeometryReader::read(int mesh, size_t index) {
  const tinygltf::Primitive& primitive =
      document_.model.meshes[static_cast<size_t>(mesh)].primitives[index];
  if (primitive.mode < TINYGLTF_MODE_TRIANGLES || !primitive.attributes.contains("POSITION")) {
    return std::nullopt;
  }
  const std::string where = pointer("meshes", mesh, "primitives", index);
  refuse_absent_indices(document_, primitive, where);
  const Vertices vertices(document_, primitive, budget_);
  if (new_index_.size() < vertices.count()) {
    budget_->charge(vertices.count(), sizeof(uint32_t), where);
    new_index_.resize(vertices.count(), unused);
  }
  const std::vector<uint32_t> all_corners = corners(primitive, vertices.count(), where);
  // Memory for two copies of the triangles, and for all vertices that they can use.
  const size_t corners_per_triangle = primitive.mode == TINYGLTF_MODE_TRIANGLES ? 3 : 1;
  budget_->charge(all_corners.size() / corners_per_triangle, 2 * sizeof(Triangle), where);
  budget_->charge(std::min(all_corners.size(), vertices.count()),
                  sizeof(Vec3) + sizeof(Vec2) + sizeof(uint32_t), where);

  PrimitiveMesh result;
  result.is_single = vertices.are_single();
  const std::vector<uint32_t> used =
      add_triangles(triangles_of(all_corners, primitive.mode), vertices, &result);
  for (const uint32_t vertex : used) {
    new_index_[vertex] = unused;
    if (vertices.have_uv()) result.mesh.uv.push_back(vertices.uv(vertex));
  }
  result.without_uv = std::any_of(result.mesh.uv.begin(), result.mesh.uv.end(),
                                  [](const Vec2& uv) { return !uv.allFinite(); });
  if (result.without_uv) result.mesh.uv.clear();
  return result;
}

}  // namespace photorque::gltf
