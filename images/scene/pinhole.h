// A camera that looks at a scene, and lamps and rays drawn into what it sees.
#pragma once

#include <span>
#include <vector>

#include "images/scene/shading.h"

namespace photorque {

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

// The same camera moved so that all points are in a picture of this height over width, with some
// room around them; it looks along the same direction.
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

}  // namespace photorque
