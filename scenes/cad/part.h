// A model from CAD as its file has it: parts of triangles with names, without unit or optics. Faces
// with more than three corners are cut into triangles.
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
  Mesh mesh;  // lengths in the file's unit, its axes
};

// Most triangles of one file, independent of its size in bytes.
inline constexpr size_t most_triangles = 50'000'000;

// STL, as text or binary. Text: every `solid` is a part; binary: the whole is one. Corners at the
// same place are one vertex. Normals, attributes and colours are not read: the order of the corners
// determines the front side. Messages name `file`; `name` is the name of a part that has none in
// the file. Source: 3D Systems, "StereoLithography Interface Specification" (1989).
// Throws InputError with the line (in binary files the facet) for text that is no number, numbers
// that are not finite, violations of the format, and files without a triangle.
std::vector<Part> read_stl(std::string_view bytes, const std::string& file,
                           const std::string& name);

// Wavefront OBJ: vertices, faces with any number of corners (cut into triangles, hollow ones too),
// objects and groups (together a part's name), materials by name (`usemtl`; a part for each).
// Texture coordinates, normals, lines, points, smoothing and material files are not read. Throws
// InputError as read_stl(), and for curves and surfaces (`curv`, `surf`), which are not read.
// Source: Wavefront, "Object Files (.obj)", in the Advanced Visualizer manual, appendix B1.
std::vector<Part> read_obj(std::string_view text, const std::string& file, const std::string& name);

// The triangles of a polygon without holes, as places in `corners`, in its own order of corners. A
// polygon that is not quite plane is cut as it is seen along its mean normal (Newell's). Fewer than
// three corners give none; corners in one line give triangles without area. Source: D. Eberly,
// "Triangulation by Ear Clipping" (2002).
std::vector<std::array<uint32_t, 3>> triangles_of(const std::vector<Vec3>& corners);

// Whether two edges of a polygon cross, as it is seen along its mean normal, or against its largest
// corner where that is zero: it has no inside, and triangles_of() would cover some of it twice.
// Edges that only touch do not cross.
bool crosses_itself(const std::vector<Vec3>& corners);

}  // namespace photorque::cad
