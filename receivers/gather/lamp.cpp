#include "receivers/gather/lamp.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace photorque {

FirstContact::FirstContact(const OpticalSurface& surface, bool front, const BandValues& fraction,
                           int bands)
    : surface_(surface), front_(front), fraction_(fraction), bands_(bands) {
  for (size_t band = 0; band < static_cast<size_t>(bands); ++band) {
    specular_ += fraction[band] * surface.specular[band];
    diffuse_ += fraction[band] * surface.diffuse[band];
    transmitted_ += fraction[band] * surface.transmitted[band];
  }
}

// Arriving momentum minus the expected leaving momentum over all components, including heat
// radiation.
Vec3 FirstContact::by_law(const Vec3& direction, const Vec3& normal) const {
  const Incidence incidence(direction, normal);
  std::array<double, components.size()> carried{};
  double absorbed = 0.0;
  for (size_t band = 0; band < static_cast<size_t>(bands_); ++band) {
    const PowerFractions fractions = fractions_of(surface_, incidence.cosine, band);
    absorbed += fraction_[band] * fractions.absorbed;
    for (const Component c : components) {
      carried[static_cast<size_t>(c)] += fraction_[band] * fractions.of(c);
    }
  }
  Vec3 kept = direction;
  for (const Component c : components) {
    const double power = carried[static_cast<size_t>(c)];
    if (power > 0.0) kept -= mean_flow(surface_, c, incidence, power);
  }
  const Bsdf& bsdf = *surface_.bsdf;
  const double lit_emission = front_ ? bsdf.front_emission : 1.0 - bsdf.front_emission;
  return kept - bsdf.reemitted * absorbed * (2.0 * lit_emission - 1.0) * lambertian_mean * normal;
}

std::vector<std::shared_ptr<const DiscLight>> lights_of(std::span<const Beam> beams) {
  std::map<const Emitter*, std::shared_ptr<const DiscLight>> known;
  std::vector<std::shared_ptr<const DiscLight>> different, lights;
  for (const Beam& beam : beams) {
    auto& light = known[beam.emitter.get()];
    if (!light) {
      light = std::make_shared<const DiscLight>(*beam.emitter, *beam.aperture);
      const auto same = std::find_if(different.begin(), different.end(),
                                     [&](const auto& other) { return light->same_as(*other); });
      if (same != different.end()) {
        light = *same;
      } else {
        different.push_back(light);
      }
    }
    lights.push_back(light);
  }
  return lights;
}

PlacedLamp::PlacedLamp(const Beam& beam, std::shared_ptr<const DiscLight> light,
                       const RigidTransform& body_from_lab, const Bands& bands,
                       double scene_diameter_m)
    : light_(std::move(light)),
      body_from_emitter_(body_from_lab * beam.lab_from_emitter),
      emitter_from_body_(body_from_emitter_.inverse()),
      fraction_(band_fractions(beam.spectrum, bands)),
      scene_diameter_m_(scene_diameter_m),
      reach_slope_(std::tan(std::min(light_->reach_rad(), 1.5))),
      wide_(light_->reach_rad() > 1.5) {
  double total = 0.0;
  for (const double fraction : fraction_) total += fraction;
  for (double& fraction : fraction_) fraction /= total;
}

bool PlacedLamp::misses(const Ball& ball) const {
  if (light_->parallel()) return false;
  const Vec3 at = emitter_from_body_.point(ball.centre_m);
  if (at.z() + ball.radius_m <= 0.0) return true;
  if (wide_) return false;
  const double reach = light_->radius_m() + (at.z() + ball.radius_m) * reach_slope_;
  return std::hypot(at.x(), at.y()) - ball.radius_m > reach;
}

Ball PlacedLamp::aperture_ball(const Ball& ball) const {
  const Vec3 at = emitter_from_body_.point(ball.centre_m);
  if (light_->parallel()) {
    const double far = scene_diameter_m_;
    return {body_from_emitter_.point(at - far * Vec3::UnitZ()), far * reach_slope_ + ball.radius_m};
  }
  const double seen = (std::max(at.z(), 0.0) + ball.radius_m) * reach_slope_ + ball.radius_m;
  if (!wide_ && seen < light_->radius_m()) {
    return {body_from_emitter_.point({at.x(), at.y(), 0.0}), seen};
  }
  return {body_from_emitter_.translation_m, light_->radius_m()};
}

bool PlacedLamp::smooth_over(const Ball& ball) const {
  if (light_->parallel()) return true;
  const Vec3 at = emitter_from_body_.point(ball.centre_m);
  if (at.z() < 2.0 * ball.radius_m) return false;
  if (light_->fades_out()) return true;
  // Kinks lie where a circle about the axis touches the rim of an edge's light, d = |R ± h tan θ|.
  const double d = at.head<2>().norm(), radius_m = light_->radius_m();
  for (const double slope : light_->angles().edge_slopes()) {
    if (std::isinf(slope)) continue;
    const double foot_m = at.z() * slope, reach_m = ball.radius_m * std::hypot(1.0, slope);
    for (const double kink_m : {radius_m + foot_m, radius_m - foot_m, foot_m - radius_m}) {
      if (std::abs(d - kink_m) <= reach_m) return false;
    }
  }
  return true;
}

double PlacedLamp::scale_m(const Ball& ball) const {
  if (light_->parallel()) return INFINITY;
  const double h = emitter_from_body_.point(ball.centre_m).z();
  return std::min(h, h * std::tan(std::min(light_->angles().steepest_rad(), 0.8)));
}

double PlacedLamp::typical_W_m2(const Ball& ball) const {
  if (light_->parallel()) return light_->exitance_W_m2();
  const double h = std::max(emitter_from_body_.point(ball.centre_m).z(), 0.0);
  return light_->typical_W_m2(h);
}

bool PlacedLamp::sampled_by_direction(double height_m) const {
  const double half = std::min(light_->half_flux_rad(), 1.5);
  return light_->parallel() || height_m * std::tan(half) < 0.7 * light_->radius_m();
}

double PlacedLamp::sampled_W_m2(const RayBlock& rays, size_t i, bool directed, const Vec3& at_m,
                                const Vec3& normal, Vec3& from_m) const {
  if (directed) return along_direction_W_m2(rays.direction_at(i), at_m, normal, from_m);
  from_m = rays.origin_at_m(i);
  return from_point_W_m2(from_m, at_m, normal);
}

double PlacedLamp::along_direction_W_m2(const Vec3& direction, const Vec3& at_m, const Vec3& normal,
                                        Vec3& from_m) const {
  const double facing = -normal.dot(direction);
  if (facing <= 0.0) return 0.0;
  if (light_->parallel()) {
    from_m = at_m - scene_diameter_m_ * direction;
    return light_->exitance_W_m2() * facing;
  }
  if (!(direction.z() > 0.0) || !(at_m.z() > 0.0)) return 0.0;
  from_m = at_m - at_m.z() / direction.z() * direction;
  const double radius = light_->radius_m();
  if (from_m.head<2>().squaredNorm() > radius * radius) return 0.0;
  return light_->exitance_W_m2() * facing / direction.z();
}

double PlacedLamp::from_point_W_m2(const Vec3& from_m, const Vec3& at_m, const Vec3& normal) const {
  const Vec3 between = at_m - from_m;
  const double distance2 = between.squaredNorm();
  const double facing = -normal.dot(between);
  if (!(between.z() > 0.0) || facing <= 0.0) return 0.0;
  const double distance = std::sqrt(distance2);
  const double rise = between.head<2>().squaredNorm() / (distance * (distance + between.z()));
  return light_->emitter().power_W() * light_->angles().intensity_per_flux(rise) * facing /
         (distance2 * distance);
}

}  // namespace photorque
