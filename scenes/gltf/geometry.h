// The triangles of a glTF primitive.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "raytrace/scene.h"
#include "scenes/gltf/file/document.h"

namespace photorque::gltf {

// Attribute of models converted from CAD files: the difference between each position and its value
// in single precision. The position is the sum of both.
inline constexpr const char* position_rest = "_POSITION_REST";

// A primitive as a mesh in the frame of its node (glTF axes and units). It contains only the
// vertices that its triangles use, in order of first use.
struct PrimitiveMesh {
  Mesh mesh;
  size_t degenerate = 0;  // triangles without area, omitted
  // largest distance of their corners from the origin, in units of the file
  double degenerate_reach = 0.0;
  bool without_uv = false;  // texture coordinates were left out because some are not finite
  bool is_single = true;    // positions have single precision
};

using Triangle = std::array<uint32_t, 3>;

class Vertices;

// Reads primitives of one document, which must have passed validate_accessors() and
// validate_primitives().
class GeometryReader {
 public:
  GeometryReader(const Document& document, MemoryBudget* budget)
      : document_(document), budget_(budget) {}

  // Reads TRIANGLES, TRIANGLE_STRIP or TRIANGLE_FAN, with or without indices, with POSITION.
  // Returns nothing for other primitives. A triangle is degenerate if two corners coincide or if
  // its area is so small that its normal is lost in rounding. Throws InputError for an index that
  // is not a vertex (or is a primitive restart, which glTF forbids) and for positions that are not
  // finite.
  std::optional<PrimitiveMesh> read(int mesh, size_t primitive);

 private:
  std::vector<uint32_t> corners(const tinygltf::Primitive& primitive, size_t vertex_count,
                                const std::string& where);

  // Appends triangles that are not degenerate to `result` and renumbers their vertices. Returns the
  // vertices used.
  std::vector<uint32_t> add_triangles(const std::vector<Triangle>& triangles,
                                      const Vertices& vertices, PrimitiveMesh* result);

  const Document& document_;
  MemoryBudget* budget_;
  // New index of each vertex of the current accessor; all are unused between two calls. The memory
  // is kept, because many primitives may share one long accessor and use little of it.
  std::vector<uint32_t> new_index_;
};

}  // namespace photorque::gltf
