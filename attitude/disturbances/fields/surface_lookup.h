// A torque surface looked up at eight attitudes, with derivatives where they are asked for.
#pragma once

#include <array>

#include "attitude/disturbances/fields/torque_surface.h"
#include "core/numerics/dual.h"

namespace photorque {

// f(x, y) with its derivatives, from lanes of numbers.
inline Lanes combine_slopes(const Lanes&, const Lanes&, const Lanes& f, const Lanes&,
                            const Lanes&) {
  return f;
}
inline DualLanes combine_slopes(const DualLanes& x, const DualLanes& y, const Lanes& f,
                                const Lanes& by_x, const Lanes& by_y) {
  return DualLanes::chain(x, y, f, by_x, by_y);
}

// The torque of a surface at a polar angle and one around [N m, body axes].
template <class T>
Vec3Of<T> look_up(const TorqueSurface& surface, const T& polar_rad, const T& around_rad) {
  std::array<Lanes, 3> value, by_polar, by_around;
  for (int i = 0; i < Lanes::count; ++i) {
    const TorqueSurface::Sample at = surface.at({values(polar_rad)[i], values(around_rad)[i]});
    for (int k = 0; k < 3; ++k) {
      value[k].set(i, at.torque_body_N_m[k]);
      by_polar[k].set(i, at.by_polar[k]);
      by_around[k].set(i, at.by_around[k]);
    }
  }
  Vec3Of<T> torque;
  for (int k = 0; k < 3; ++k) {
    torque[k] = combine_slopes(polar_rad, around_rad, value[k], by_polar[k], by_around[k]);
  }
  return torque;
}

// The same for light from a direction in body axes, of a surface over azimuth and elevation.
template <class T>
Vec3Of<T> look_up_towards(const TorqueSurface& surface, const Vec3Of<T>& light_body) {
  constexpr double hair = 1e-9;  // off the pole, where the azimuth has no derivative
  const T x = light_body.x() + hair, y = light_body.y(), across = sqrt(x * x + y * y);
  return look_up<T>(surface, atan2(light_body.z(), across), atan2(y, x));
}

}  // namespace photorque
