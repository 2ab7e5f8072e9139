// Picture of the `render` command: a camera's view of a scene with lamps, rays and the irradiance
// on its receivers.
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
// has (width·oversampling)·(height·oversampling) samples; row 0 is at the top of the picture.
struct SceneView {
  int width = 0;  // of the picture in pixels
  int height = 0;
  int oversampling = 1;
  std::vector<float> depth_m;               // along the optical axis; infinity: nothing is hit
  std::vector<int32_t> part;                // index into part_colour; ignored if nothing is hit
  std::vector<Eigen::Vector3f> normal_lab;  // unit, on the side of the camera
  std::vector<float> cos_view;  // cosine between the normal and the ray back to the camera, 0 to 1
  std::vector<float> irradiance_W_m2;  // NaN: not on a receiver
  std::vector<Rgb> part_colour;
  // Fraction of the sample covered by rays of light, 0 to 1; empty: none.
  std::vector<float> ray = {};

  int sample_columns() const { return width * oversampling; }
  int sample_rows() const { return height * oversampling; }
};

// Strength of the drawn edge at each sample, 0 to 1: outlines against the background, jumps of
// depth, borders of parts, creases of more than 25 deg. Lines are about one pixel wide.
std::vector<float> edge_strength(const SceneView& view);

// Shaded picture. Receivers have the exact colours of `scale`, except under rays, so that they can
// be compared with the colour bar. All else has the colour of its part, lit by a headlight and a
// sky above +z, with thin dark edges on a light neutral background. Samples are averaged as linear
// light, not as encoded values.
Picture shaded(const SceneView& view, const ColourScale& scale);

// Colour of shaded() where nothing is hit.
inline constexpr Rgb scene_background = {0.957, 0.957, 0.957};
// Colour of rays: Okabe and Ito's orange, darkened to be visible on the background and on maps.
inline constexpr Rgb ray_colour = {0.85, 0.55, 0.0};

// Centre of projection and axes of the picture: x right, y up, z towards the viewer; lab frame.
struct Pinhole {
  Vec3 position_m;
  Vec3 right, up, back;     // unit, orthogonal
  double half_width = 1.0;  // half-width of the picture at distance 1

  // A camera that looks from one point at another, with lab z up in the picture (lab x to the right
  // if it looks straight up or down). `field_of_view_rad` is across the width, in (0, π).
  static Pinhole looking(const Vec3& position_m, const Vec3& target_m, double field_of_view_rad);

  // Unit vector from the camera through a sample of the view.
  Vec3 direction(const SceneView& view, int column, int row) const;
};

// The camera moved so that all points are in a picture of this ratio of height to width, with a
// margin; the direction of view is unchanged.
Pinhole framing(const Pinhole& camera, std::span<const Vec3> points_m, double height_over_width);

// A round opening that emits to one side and is dark on the other.
struct DrawnLamp {
  Vec3 position_m = Vec3::Zero();
  Vec3 direction = -Vec3::UnitZ();  // unit
  double radius_m = 0.0;            // > 0
};

// Draws lamps, except where they are hidden. All arrays of the view must be filled.
void draw_lamps(SceneView& view, const Pinhole& camera, const std::vector<DrawnLamp>& lamps);

// Draws rays (x, y, z of start and end of each) as transparent lines about a pixel wide, except
// where they are hidden.
void draw_rays(SceneView& view, const Pinhole& camera, const std::vector<float>& rays_m);

struct SceneLabels {
  std::string title;
  std::string caption = {};
  // Unit vectors of the body's x, y and z in camera axes (x right, y up, z towards the viewer);
  // drawn as a small triad in the lower left corner.
  std::optional<std::array<Vec3, 3>> body_axes_camera = {};
};

// The view at its own resolution with title, colour bar of the irradiance from zero to the largest
// in view (if a receiver is in view), caption and provenance. Throws InputError if the sizes of the
// arrays disagree.
Picture scene_picture(const SceneView& view, const SceneLabels& labels,
                      const Provenance& provenance);

// Writes a PNG with the provenance as metadata.
void write_scene_picture(const std::filesystem::path& path, const Picture& picture,
                         const std::string& title, const Provenance& provenance);

}  // namespace photorque
