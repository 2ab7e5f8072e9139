// Light of each lamp alone on the places that a recording looks at.
//
// A lamp's light on a point is that of its aperture (raytrace/direct/disc_light.h), less what boxes
// and parts of the scene hide of the aperture. Light by way of a wall is the diffuse or specular
// part of what the wall gets, once; everything else is black.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "diagnosis/light/model/lab.h"

namespace photorque {

// Places on the receiver and when each is looked at. An output is a point (one of a scan) or the
// weighted mean over the points of a cell.
struct LightSites {
  struct Group {
    size_t first_point = 0, count = 0;  // of `points_body_m`
  };
  std::vector<Vec3> points_body_m;
  std::vector<double> weights;
  std::vector<Group> groups;  // a point, or a cell
  struct Output {
    size_t attitude = 0, group = 0;
  };
  std::vector<Output> outputs;
  std::vector<Quat> lab_from_body;  // of each attitude
  bool enters_cells = false;        // counted behind the cells' front
};

// What a lamp's light depends on, but for its power.
struct LampGeometry {
  size_t lamp = 0;
  Vec2 aim = Vec2::Zero();
  double divergence = 1.0;
  Vec3 shift_m = Vec3::Zero();
  Vec2 attitude_bias_rad = Vec2::Zero();
  std::vector<ShadowBox> boxes;
  std::optional<double> glass_index;

  bool operator==(const LampGeometry&) const = default;
};
LampGeometry geometry_of(const LightState& state, size_t lamp, bool enters_cells);

// Irradiance [W/m²] of one lamp at full power on every output.
using LampField = std::vector<double>;

// A field that is known, whose geometry may differ in the boxes: it holds wherever none of either
// comes near.
struct KnownField {
  const LampGeometry* geometry;
  const LampField* field;
};
LampField lamp_field(const LightLab& lab, const LampSet& lamps, const LightSites& sites,
                     const LampGeometry& geometry, const std::optional<KnownField>& known = {});

}  // namespace photorque
