// The triangles of a glTF primitive.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "raytrace/scene.h"
#include "scenes/gltf/file/document.h"

namespace photorque::gltf {

// An attribute of models that CAD files are converted to: what single precision leaves of each
// position, which is the sum of both.
inline constexpr const char* position_rest = "_POSITION_REST";

// A primitive as a mesh in the frame of its node (glTF axes and units); only the vertices that its
// triangles use, in order of first use.
struct PrimitiveMesh {
  Mesh mesh;
  size_t degenerate = 0;          // triangles without area, left out
  double degenerate_reach = 0.0;  // of their corners, from the origin; in units of the file
  bool without_uv = false;        // texture coordinates were left out because some are not finite
  bool is_single = true;          // positions have single precision
};

using Triangle = std::array<uint32_t, 3>;

class Vertices;

// Reads primitives of one document, which must have passed validate_accessors() and
// validate_primitives().
class GeometryReader {
 public:
  GeometryReader(const Document& document, MemoryBudget* budget)
      : document_(document), budget_(budget) {}

  // TRIANGLES, TRIANGLE_STRIP or TRIANGLE_FAN, indexed or not, with POSITION; nothing for other
  // primitives. A triangle is degenerate when two corners coincide or its area is so small that
  // its normal is lost in rounding. Throws InputError for an index that is not a vertex (or means
  // primitive restart, which glTF forbids) and for positions that are not finite.
  std::optional<PrimitiveMesh> read(int mesh, size_t primitive);

 private:
  std::vector<uint32_t> corners(const tinygltf::Primitive& primitive, size_t vertex_count,
                                const std::string& where);

  // Appends triangles that are not degenerate to `result`, renumbering vertices; returns the
  // vertices used.
  std::vector<uint32_t> add_triangles(const std::vector<Triangle>& triangles,
                                      const Vertices& vertices, PrimitiveMesh* result);

  const Document& document_;
  MemoryBudget* budget_;
  // New index of each vertex of the accessor being read; all unused between two calls. Kept,
  // because many primitives may share one long accessor and use little of it.
  std::vector<uint32_t> new_index_;
};

}  // namespace photorque::gltf
