// The picture of the `render` command: the view of a camera on a scene, with the irradiance painted
// on its receivers, lamps and rays.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/provenance.h"
#include "core/transform.h"
#include "images/drawing/canvas.h"
#include "images/drawing/colour.h"

namespace photorque {

// Hits of the rays through a picture, `oversampling`² rays per pixel on a regular grid. Every array
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

// Strength of the drawn edge at each sample, 0 to 1: outlines against the background, jumps of
// depth, borders of parts, creases of more than 25 deg. Lines are about one pixel wide.
std::vector<float> edge_strength(const SceneView& view);

// Receivers in the exact colours of `scale` (a reader compares them with the colour bar), where no
// ray lies over them; everything else in the colour of its part under a headlight and a sky above
// +z; thin dark edges; a light neutral background. Samples are averaged as light, not as encoded
// values.
Picture shaded(const SceneView& view, const ColourScale& scale);

// The colour of `shaded` where nothing is hit.
inline constexpr Rgb scene_background = {0.957, 0.957, 0.957};
// Rays of light. Okabe and Ito's orange, darker: it must be seen on the background and on a map.
inline constexpr Rgb ray_colour = {0.85, 0.55, 0.0};

// The centre of projection and the picture's axes: x right, y up, z towards the viewer; lab frame.
struct Pinhole {
  Vec3 position_m;
  Vec3 right, up, back;     // unit, orthogonal
  double half_width = 1.0;  // of the picture at distance 1

  // Looking from one point at another, lab z up in the picture (x to the right where it looks
  // straight up or down). `field_of_view_rad` across the width, in (0, π).
  static Pinhole looking(const Vec3& position_m, const Vec3& target_m, double field_of_view_rad);

  // Unit vector along which a sample of the view is seen.
  Vec3 direction(const SceneView& view, int column, int row) const;
};

// The camera moved so that all points are in a picture of this height over width, with some room
// around them; it looks along the same direction.
Pinhole framing(const Pinhole& camera, std::span<const Vec3> points_m, double height_over_width);

// A round opening that shines to one side, and is dark on the other.
struct DrawnLamp {
  Vec3 position_m = Vec3::Zero();
  Vec3 direction = -Vec3::UnitZ();  // unit
  double radius_m = 0.0;            // > 0
};

// Draws lamps where nothing nearer is seen. All arrays of the view are filled already.
void draw_lamps(SceneView& view, const Pinhole& camera, const std::vector<DrawnLamp>& lamps);

// Draws rays, x, y, z of start and end of each, as see-through lines about a pixel wide, where
// nothing nearer is seen.
void draw_rays(SceneView& view, const Pinhole& camera, const std::vector<float>& rays_m);

struct SceneLabels {
  std::string title;
  std::string caption = {};
  std::string unit = "W/m²";
  // Irradiance at the end of the colour scale, which starts at zero; the largest in view if absent.
  std::optional<double> scale_end_W_m2 = {};
  // The unit vectors of the body's x, y and z in camera axes (x right, y up, z towards the viewer):
  // drawn as a small triad in the lower left corner.
  std::optional<std::array<Vec3, 3>> body_axes_camera = {};
};

// The view at its own pixels, with title, colour bar (where a receiver is in view), caption and
// provenance around it. InputError if the sizes of the arrays disagree.
Picture scene_picture(const SceneView& view, const SceneLabels& labels,
                      const Provenance& provenance);

// Written as PNG with the provenance as metadata.
void write_scene_picture(const std::filesystem::path& path, const Picture& picture,
                         const std::string& title, const Provenance& provenance);

}  // namespace photorque
