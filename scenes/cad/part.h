// A CAD model as stored in its file: named parts of triangles, without unit or optics. Faces with
// more than three corners are divided into triangles.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/transform.h"
#include "raytrace/scene.h"

namespace photorque::cad {

struct Part {
  std::string name;
  std::string material;
  Mesh mesh;  // lengths in the file's unit, axes of the file
};

// Maximum number of triangles of one file, regardless of its size in bytes.
inline constexpr size_t most_triangles = 50'000'000;

// Reads STL, as text or binary. In text every `solid` is a part; a binary file is one part. Corners
// at the same position become one vertex. Normals, attributes and colours are not read: the order
// of the corners determines the front side. Messages name `file`; `name` is used for parts without
// a name. Source: 3D Systems, "StereoLithography Interface Specification" (1989).
// Throws InputError with the line (in binary files the facet) for invalid or non-finite numbers,
// violations of the format, and files without a triangle.
std::vector<Part> read_stl(std::string_view bytes, const std::string& file,
                           const std::string& name);

// Reads Wavefront OBJ: vertices, faces with any number of corners (divided into triangles, also if
// concave), objects and groups (together a part's name), materials by name (`usemtl`; one part for
// each). Texture coordinates, normals, lines, points, smoothing and material files are not read.
// Throws InputError like read_stl(), and for curves and surfaces (`curv`, `surf`), which are not
// supported.
// Source: Wavefront, "Object Files (.obj)", in the Advanced Visualizer manual, appendix B1.
std::vector<Part> read_obj(std::string_view text, const std::string& file, const std::string& name);

// Divides a polygon without holes into triangles of indices into `corners`, with its own
// orientation. A polygon that is not exactly flat is projected along its mean normal (Newell's).
// Fewer than three corners give no triangle; collinear corners give triangles without area. Source:
// D. Eberly, "Triangulation by Ear Clipping" (2002).
std::vector<std::array<uint32_t, 3>> triangles_of(const std::vector<Vec3>& corners);

// Whether two edges of a polygon cross in the projection along its mean normal (if that is zero,
// along the normal of its largest corner). The inside of such a polygon is undefined, and
// triangles_of() would cover parts of it twice. Edges that only touch do not cross.
bool crosses_itself(const std::vector<Vec3>& corners);

}  // namespace photorque::cad
