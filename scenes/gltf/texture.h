// Base colour from pictures, where the experiment asks for it.
//
// The tracer knows surfaces by the triangle. The picture's mean over each triangle takes the place
// of one colour for all, in 32 steps of luminance; within a step every triangle has the mean of
// the step, weighted by area, so that the absorbed fraction of even light is unchanged.
#pragma once

#include <string>
#include <vector>

#include "raytrace/scene.h"
#include "scenes/gltf/file/document.h"
#include "scenes/gltf/reader.h"

namespace photorque::gltf {

// The picture of a material's base colour; nothing for a material without one, or with one on
// other texture coordinates than the first. Throws InputError for references and pictures that are
// wrong.
std::optional<BaseColours> base_colour_picture(const Document& document, int material,
                                               const GltfOpen& open, const PictureReader& read,
                                               MemoryBudget* budget);

// Triangles of one mesh that look alike.
struct TextureStep {
  Mesh mesh;
  std::array<double, 3> colour{};  // mean of the picture, linear red, green and blue
};

// Cuts a mesh with texture coordinates into such parts. Pictures repeat beyond their edges. The
// mean over a triangle comes from up to 2080 points evenly spread in it.
std::vector<TextureStep> texture_steps(const Mesh& mesh, const BaseColours& picture);

}  // namespace photorque::gltf
