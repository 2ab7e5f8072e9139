// A camera's view of a scene as shaded pixels.
#pragma once

#include <limits>
#include <vector>

#include "core/transform.h"
#include "images/canvas/picture.h"
#include "images/drawing/colour_map.h"

namespace photorque {

// What rays through a picture hit, `oversampling`² rays per pixel on a regular grid. Every array
// holds (width·oversampling)·(height·oversampling) samples, row 0 at the top of the picture.
struct SceneView {
  int width = 0;  // of the picture in pixels
  int height = 0;
  int oversampling = 1;
  std::vector<float> depth_m;               // along the view; infinity: nothing is hit
  std::vector<int32_t> part;                // index into part_colour; ignored where nothing is hit
  std::vector<Eigen::Vector3f> normal_lab;  // unit, on the side of the camera
  std::vector<float> cos_view;              // of the normal and the ray back to the camera, 0 to 1
  std::vector<float> irradiance_W_m2;       // NaN: not on a receiver
  std::vector<Rgb> part_colour;
  std::vector<float> ray = {};  // how much of the sample rays of light cover, 0 to 1; empty: none

  int sample_columns() const { return width * oversampling; }
  int sample_rows() const { return height * oversampling; }
};

// How strongly each sample lies on a drawn edge, 0 to 1: outlines against the background, jumps of
// depth, borders of parts, creases of more than 25 deg. Lines are about one pixel wide.
std::vector<float> edge_strength(const SceneView& view);

// Receivers in the exact colours of `scale` (a reader compares them with the colour bar), where no
// ray lies over them; everything else in the colour of its part under a headlight and a sky above
// +z; thin dark edges; a light neutral background. Samples are averaged as light, not as encoded
// values.
Picture shaded(const SceneView& view, const ColourScale& scale);

// What `shaded` paints where nothing is hit.
inline constexpr Rgb scene_background = {0.957, 0.957, 0.957};
// Rays of light. Okabe and Ito's orange, darker: it must be seen on the background and on a map.
inline constexpr Rgb ray_colour = {0.85, 0.55, 0.0};

}  // namespace photorque
