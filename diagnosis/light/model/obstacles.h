// Obstacles between the lamps and the receiver.
#pragma once

#include "diagnosis/light/model/lab.h"

namespace photorque {

// Points that cover a disc of radius 1 evenly, in a spiral of golden angles.
// Source: H. Vogel, Mathematical Biosciences 44, 179 (1979).
std::vector<Vec2> even_disc(size_t count);

// Whether the straight line between two points passes a triangle, its ends aside.
bool crosses(const std::array<Vec3, 3>& triangle, const Vec3& from, const Vec3& to);

// At one attitude.
class Obstacles {
 public:
  // Lab and boxes are kept by reference.
  Obstacles(const LightLab& lab, const std::vector<ShadowBox>& boxes, const Quat& lab_from_body);

  bool any() const { return !boxes_.empty() || !lab_.walls().empty(); }

  // Whether a box may hide a part of an aperture of this radius from a point.
  bool meets_boxes(const Vec3& point, const Vec3& lamp, double radius_m) const;

  // The visible part of a lamp's aperture from a point: its fraction, and the first moment over the
  // whole aperture: the mean distance from the centre, in radii along `side` and `up`, with hidden
  // parts counted as 0.
  struct Open {
    double fraction = 1.0;
    Vec2 moment = Vec2::Zero();
  };
  // Body frame; `side` and `up` span the disc and have its radius. `skipped`: a wall that does not
  // count, none where it is past the last. Exact for a flat wall or a box alone, and smooth as it
  // moves; else from 100 points of the aperture.
  Open visible(const Vec3& point, const Vec3& lamp, const Vec3& side, const Vec3& up,
               size_t skipped) const;

 private:
  struct BodyBox {
    std::array<Vec3, 8> corners;  // body frame
    Vec3 centre;
    double radius;
  };
  Open sampled(const Vec3& point, const Vec3& lamp, const Vec3& side, const Vec3& up) const;

  const LightLab& lab_;
  const std::vector<ShadowBox>& boxes_;
  Quat lab_from_body_;
  std::vector<BodyBox> in_body_;
  mutable std::vector<size_t> near_walls_, near_boxes_;
};

}  // namespace photorque
