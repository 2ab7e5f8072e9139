#include "diagnosis/light/model/field.h"

#include <algorithm>
#include <cmath>

#include "diagnosis/light/model/illumination.h"
#include "photovoltaics/cell/front.h"

namespace photorque {
namespace {

bool differs_in_boxes(const LampGeometry& a, const LampGeometry& b) {
  LampGeometry same = a;
  same.boxes = b.boxes;
  return same == b;
}

}  // namespace

LampGeometry geometry_of(const LightState& state, size_t lamp, bool enters_cells) {
  return {lamp,
          state.lamp_aim[lamp],
          state.divergence,
          state.shift_m,
          state.attitude_bias_rad,
          state.boxes,
          enters_cells ? state.glass_index : std::nullopt};
}

LampField lamp_field(const LightLab& lab, const LampSet& lamps, const LightSites& sites,
                     const LampGeometry& geometry, const std::optional<KnownField>& known) {
  Illumination lamp(lab, lamps, sites, geometry);
  std::optional<Illumination> before;
  if (known && differs_in_boxes(geometry, *known->geometry)) {
    before.emplace(lab, lamps, sites, *known->geometry);
  }
  size_t attitude = std::numeric_limits<size_t>::max();
  const auto unchanged = [&](size_t output) -> const double* {
    if (!before) return nullptr;
    const size_t now = sites.outputs[output].attitude;
    if (now != attitude) before->move_to(attitude = now);
    const bool changes = lamp.meets_boxes(output) || before->meets_boxes(output);
    return changes ? nullptr : &(*known->field)[output];
  };
  std::optional<CellFront> front;
  if (sites.enters_cells) {
    if (lab.has_array()) front = lab.design().front;
    if (geometry.glass_index) {
      front.emplace();
      front->index = *geometry.glass_index;
    }
  }
  const double wavelength_m = lamps.beams[geometry.lamp].spectrum.centre_m;
  return lamp.over_places(
      [&](const Vec3& point) {
        double E = lamp.on(point, lab.normal_body(), no_wall);
        if (front && E > 0.0) {
          const Vec3 to = (lamp.lamp_body_m() - point).normalized();
          E *= front->modifier(std::clamp(to.dot(lab.normal_body()), 0.0, 1.0), wavelength_m);
        }
        return E;
      },
      unchanged);
}

}  // namespace photorque
