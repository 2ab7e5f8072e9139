#include "raytrace/surfaces/bsdf.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"

namespace photorque {

bool any_positive(const BandValues& fractions) {
  return std::ranges::any_of(fractions, [](double fraction) { return fraction > 0.0; });
}

OpticalSurface grey_surface(std::string name, double specular, double diffuse, double transmitted) {
  OpticalSurface surface;
  surface.name = std::move(name);
  surface.absorbed.fill(1.0 - specular - diffuse - transmitted);
  surface.specular.fill(specular);
  surface.diffuse.fill(diffuse);
  surface.transmitted.fill(transmitted);
  return surface;
}

namespace {

// Axes at a hit; z is the normal on the lit side.
struct HitFrame {
  Vec3 x, y, z;

  Vec3 to_outer(const Vec3& local) const { return local.x() * x + local.y() * y + local.z() * z; }
};

// The frame of the lobes: x lies in the plane of incidence.
HitFrame plane_of_incidence(const Incidence& incidence) {
  const Vec3& z = incidence.normal;
  const Vec3 along = -incidence.direction - incidence.cosine * z;
  const Vec3 x = along.squaredNorm() > 1e-20 ? along.normalized() : z.unitOrthogonal();
  return {x, z.cross(x), z};
}

// Any frame about the normal, for isotropic surfaces. No square root. Source: T. Duff et al.,
// "Building an Orthonormal Basis, Revisited" (JCGT 6(1), 2017).
HitFrame any_frame(const Vec3& n) {
  const double sign = std::copysign(1.0, n.z());
  const double a = -1.0 / (sign + n.z());
  const double b = n.x() * n.y() * a;
  return {{1.0 + sign * n.x() * n.x() * a, sign * b, -sign * n.x()},
          {b, sign + n.y() * n.y() * a, -n.y()},
          n};
}

Arrival arrival_in(const HitFrame& frame, const Incidence& incidence, const Vec3& axis) {
  const double along = axis.dot(frame.x), across = axis.dot(frame.y);
  const double length = std::hypot(along, across);
  return length > 0.0 ? Arrival(incidence.cosine, along / length, across / length)
                      : Arrival(incidence.cosine);
}

Vec3 mirrored(const Incidence& incidence) {
  const Vec3& n = incidence.normal;
  return incidence.direction - 2.0 * incidence.direction.dot(n) * n;
}

// Lobe of a component. Null for a mirror, for Lambert's law, and for transmitted and retroreflected
// light.
const Lobe* lobe_of(const OpticalSurface& surface, Component component) {
  if (!surface.bsdf) return nullptr;
  if (component == Component::specular) return surface.bsdf->specular.get();
  if (component == Component::diffuse) return surface.bsdf->diffuse.get();
  return nullptr;
}

}  // namespace

double PowerFractions::of(Component component) const {
  switch (component) {
    case Component::specular:
      return specular;
    case Component::diffuse:
      return diffuse;
    case Component::transmitted:
      return transmitted;
    case Component::retroreflected:
      break;
  }
  return retroreflected;
}

Incidence::Incidence(const Vec3& direction_in, const Vec3& normal_in)
    : direction(direction_in),
      normal(normal_in),
      cosine(std::clamp(-direction.dot(normal), 1e-9, 1.0)) {}

PowerFractions fractions_of(const OpticalSurface& surface, double cosine, size_t band) {
  const Bsdf* bsdf = surface.bsdf.get();
  if (bsdf != nullptr && bsdf->law) return bsdf->law->fractions(cosine, band);
  return {surface.absorbed[band], surface.specular[band], surface.diffuse[band],
          surface.transmitted[band], bsdf == nullptr ? 0.0 : bsdf->retroreflected[band]};
}

void set_fractions(OpticalSurface& surface, size_t band, const PowerFractions& fractions) {
  surface.absorbed[band] = fractions.absorbed;
  surface.specular[band] = fractions.specular;
  surface.diffuse[band] = fractions.diffuse;
  surface.transmitted[band] = fractions.transmitted;
}

Vec3 scattered_direction(const OpticalSurface& surface, Component component,
                         const Incidence& incidence, const Draw& draw) {
  if (const Lobe* lobe = lobe_of(surface, component)) {
    const HitFrame frame = plane_of_incidence(incidence);
    return frame.to_outer(lobe->direction(arrival_in(frame, incidence, surface.bsdf->axis), draw));
  }
  switch (component) {
    case Component::specular:
      return mirrored(incidence);
    case Component::diffuse:
      return any_frame(incidence.normal).to_outer(lambertian_direction(draw.u, draw.v));
    case Component::transmitted:
      break;
    case Component::retroreflected:
      return -incidence.direction;
  }
  return incidence.direction;
}

Vec3 mean_flow(const OpticalSurface& surface, Component component, const Incidence& incidence,
               double power) {
  if (const Lobe* lobe = lobe_of(surface, component)) {
    const HitFrame frame = plane_of_incidence(incidence);
    return power *
           frame.to_outer(lobe->mean_direction(arrival_in(frame, incidence, surface.bsdf->axis)));
  }
  switch (component) {
    case Component::specular:
      return power * mirrored(incidence);
    case Component::diffuse:
      return lambertian_mean * power * incidence.normal;
    case Component::transmitted:
      break;
    case Component::retroreflected:
      return -power * incidence.direction;
  }
  return power * incidence.direction;
}

Vec3 lambertian_direction(double u, double v) {
  const double radius = std::sqrt(u), angle = 2.0 * pi * v;
  return {radius * std::cos(angle), radius * std::sin(angle), std::sqrt(1.0 - u)};
}

}  // namespace photorque
