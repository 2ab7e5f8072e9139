// Obstacles between the lamps and the receiver.
#pragma once

#include "diagnosis/light/model/lab.h"

namespace photorque {

// Evenly distributed points on a disc of radius 1, in a spiral of golden angles. Source: H. Vogel,
// Mathematical Biosciences 44, 179 (1979).
std::vector<Vec2> even_disc(size_t count);

// Whether the straight line between two points crosses a triangle; its ends are excluded.
bool crosses(const std::array<Vec3, 3>& triangle, const Vec3& from, const Vec3& to);

// Obstacles at one attitude.
class Obstacles {
 public:
  // Keeps references to lab and boxes.
  Obstacles(const LightLab& lab, const std::vector<ShadowBox>& boxes, const Quat& lab_from_body);

  bool any() const { return !boxes_.empty() || !lab_.walls().empty(); }

  // Whether a box may hide a part of an aperture of this radius from a point.
  bool meets_boxes(const Vec3& point, const Vec3& lamp, double radius_m) const;

  // The visible part of a lamp's aperture from a point: its fraction, and the first moment over the
  // whole aperture. The moment is the mean position relative to the centre, in radii along `side`
  // and `up`, where hidden parts count as 0.
  struct Open {
    double fraction = 1.0;
    Vec2 moment = Vec2::Zero();
  };
  // All vectors are in the body frame; `side` and `up` span the disc and have its radius.
  // `skipped`: index of a wall to ignore; past the end: none. A single flat wall or box is exact
  // and varies smoothly. Otherwise 100 points of the aperture are tested.
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
