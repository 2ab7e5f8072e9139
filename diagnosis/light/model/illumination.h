// Irradiance of one lamp on points, attitude by attitude.
#pragma once

#include <limits>

#include "diagnosis/light/model/field.h"
#include "diagnosis/light/model/lamp_table.h"
#include "diagnosis/light/model/obstacles.h"

namespace photorque {

// A lamp at one attitude, in body axes.
struct LampAtAttitude {
  RigidTransform body_from_lamp;
  Mat3 lamp_from_body;
  Vec3 offset_m;
  Vec3 side, up;  // the disc's radii

  LampAtAttitude(const RigidTransform& lab_from_lamp, const Quat& lab_from_body, double radius_m);
};

constexpr size_t no_wall = std::numeric_limits<size_t>::max();

class Illumination {
 public:
  // All references must outlive this.
  Illumination(const LightLab& lab, const LampSet& lamps, const LightSites& sites,
               const LampGeometry& geometry);

  void move_to(size_t attitude);

  // At a point of the body on a surface of this normal, with what stands in between but for one
  // wall.
  double on(const Vec3& point, const Vec3& normal, size_t skipped) const;
  const Vec3& lamp_body_m() const { return at_->body_from_lamp.translation_m; }
  const LampAtAttitude& lamp() const { return *at_; }

  // Whether a box may stand between the lamp and any point of an output, at the attitude moved to.
  bool meets_boxes(size_t output) const;

  // Sums weight times at(point) over the places of each output, in turn; where known(output) points
  // to a number, that is the sum.
  template <typename At, typename Known>
  LampField over_places(const At& at, const Known& known) {
    LampField field(sites_.outputs.size(), 0.0);
    size_t attitude = std::numeric_limits<size_t>::max();
    for (size_t o = 0; o < sites_.outputs.size(); ++o) {
      if (sites_.outputs[o].attitude != attitude) move_to(attitude = sites_.outputs[o].attitude);
      if (const double* sum = known(o)) {
        field[o] = *sum;
        continue;
      }
      const LightSites::Group& group = sites_.groups[sites_.outputs[o].group];
      for (size_t i = group.first_point; i < group.first_point + group.count; ++i) {
        field[o] += sites_.weights[i] * at(sites_.points_body_m[i]);
      }
    }
    return field;
  }

 private:
  const LightLab& lab_;
  const LightSites& sites_;
  const LampGeometry& geometry_;
  const LampTable& light_;
  RigidTransform pose_;
  std::optional<LampAtAttitude> at_;
  std::optional<Obstacles> obstacles_;
};

}  // namespace photorque
