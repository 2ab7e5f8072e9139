#include "diagnosis/light/model/illumination.h"

#include <algorithm>
#include <cmath>

#include "photovoltaics/cell/front.h"
#include "scenes/effects/stated.h"

namespace photorque {

Illumination::Illumination(const LightLab& lab, const LampSet& lamps, const LightSites& sites,
                           const LampGeometry& geometry)
    : lab_(lab),
      sites_(sites),
      geometry_(geometry),
      light_(*lamps.tables[geometry.lamp]),
      pose_(displaced_pose(lamps.beams[geometry.lamp], geometry.aim, geometry.shift_m)) {}

void Illumination::move_to(size_t attitude) {
  const Quat q = biased_attitude(sites_.lab_from_body[attitude], geometry_.attitude_bias_rad);
  const Mat3 rotation = (q.conjugate() * pose_.rotation).normalized().toRotationMatrix();
  const double radius_m = std::isfinite(light_.radius_m()) ? light_.radius_m() : 0.0;
  lamp_body_m_ = q.conjugate() * pose_.translation_m;
  lamp_from_body_ = rotation.transpose();
  offset_m_ = -(lamp_from_body_ * lamp_body_m_);
  side_m_ = radius_m * rotation.col(0);
  up_m_ = radius_m * rotation.col(1);
  obstacles_.emplace(lab_, geometry_.boxes, q);
}

bool Illumination::meets_boxes(size_t output) const {
  const LightSites::Group& group = sites_.groups[sites_.outputs[output].group];
  for (size_t i = group.first_point; i < group.first_point + group.count; ++i) {
    if (obstacles_->meets_boxes(sites_.points_body_m[i], lamp_body_m_, side_m_.norm())) return true;
  }
  return false;
}

double Illumination::on(const Vec3& point, const Vec3& normal, size_t skipped) const {
  const Vec3 p = lamp_from_body_ * point + offset_m_, n = lamp_from_body_ * normal;
  const double E = light_.irradiance_W_m2(p, n);
  if (!(E > 0.0)) return 0.0;
  if (!obstacles_->any()) return E;
  const Obstacles::Open open = obstacles_->visible(point, lamp_body_m_, side_m_, up_m_, skipped);
  if (open.moment.isZero()) return open.fraction * E;
  // The irradiance varies over the aperture. To first order a visible part contributes like the
  // whole aperture shifted to its position.
  constexpr double aside = 0.5;
  const double step_m = aside * side_m_.norm();
  double E_open = open.fraction * E;
  for (int k = 0; k < 2; ++k) {
    const Vec3 step = step_m * Vec3::Unit(k);
    const double more = light_.irradiance_W_m2(p - step, n) - light_.irradiance_W_m2(p + step, n);
    E_open += open.moment[k] * more / (2.0 * aside);
  }
  return std::max(0.0, E_open);
}

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
  if (known) {
    LampGeometry same = geometry;
    same.boxes = known->geometry->boxes;
    if (same == *known->geometry) before.emplace(lab, lamps, sites, *known->geometry);
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
  const auto on = [&](const Vec3& point) {
    double E = lamp.on(point, lab.normal_body(), no_wall);
    if (front && E > 0.0) {
      const Vec3 to = (lamp.lamp_body_m() - point).normalized();
      E *= front->modifier(std::clamp(to.dot(lab.normal_body()), 0.0, 1.0), wavelength_m);
    }
    return E;
  };
  return lamp.over_places(on, unchanged);
}

}  // namespace photorque
