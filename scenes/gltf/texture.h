// Base colour from pictures, if the experiment enables it.
//
// Each triangle has one surface. Its colour is the mean of the picture over the triangle, in 32
// steps of luminance. Within a step, every triangle has the mean of the step, weighted by area, so
// that the absorbed fraction of uniform light is unchanged.
#pragma once

#include <vector>

#include "raytrace/scene.h"
#include "scenes/gltf/file/document.h"
#include "scenes/gltf/reader.h"

namespace photorque::gltf {

// The picture of a material's base colour. Empty for a material without one, or with one on texture
// coordinates other than the first set. Throws InputError for invalid references and pictures.
std::optional<BaseColours> base_colour_picture(const Document& document, int material,
                                               const GltfOpen& open, const PictureReader& read,
                                               MemoryBudget* budget);

// Triangles of one mesh in one luminance step.
struct TextureStep {
  Mesh mesh;
  std::array<double, 3> colour{};  // mean of the picture, linear red, green and blue
};

// Divides a mesh with texture coordinates into luminance steps. Pictures repeat beyond their edges.
// The mean over a triangle comes from up to 2080 evenly spaced points.
std::vector<TextureStep> texture_steps(const Mesh& mesh, const BaseColours& picture);

}  // namespace photorque::gltf
