// Smooth interpolation of a wrench table: the torque between the nodes, with its derivatives.
#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "attitude/model/disturbance.h"
#include "core/numerics/dual.h"
#include "core/settings/settings.h"
#include "core/wrench.h"

namespace photorque {

// Cubic Hermite interpolation of a table's torque in both angles. It has continuous slopes, and is
// exact at the nodes and for a torque that is linear in the angles. (The slopes of core's bilinear
// wrench_at() jump at the nodes, which would shorten the steps of an integrator.)
class TorqueSurface {
 public:
  // Nodes at poles and at azimuths a turn apart are averaged first. NumericalError unless both axes
  // have at least two nodes.
  explicit TorqueSurface(const WrenchTable& table);

  struct Sample {
    Vec3 torque_body_N_m;
    Vec3 by_polar, by_around;  // derivatives of the torque [N m/rad]
  };
  // Up to one step beyond the table, the torque is that of the edge, because an integrator
  // evaluates torques beyond the tilt limit. NumericalError further out.
  Sample at(const TableAngles& angles) const;

  WrenchTable::Angles angles() const { return table_.angles; }

 private:
  // Coefficients of one cell between nodes: Σ c[4 j + i] s^j t^i, with s and t the position within
  // the cell (0 to 1) along the polar angle and the azimuth.
  using Patch = std::array<Vec3, 16>;
  Patch fit_patch(size_t polar, size_t around) const;
  double width_around_rad(size_t around) const;
  size_t cell_around(double& around_rad, bool* held) const;
  Vec3 through_nodes(double polar_rad, double around_rad) const;
  Vec3 row_at(size_t polar, double around_rad) const;
  Vec3 ghost_row(bool below, double around_rad, double* polar_rad) const;
  bool beyond_is_pole(bool below) const;

  WrenchTable table_;
  bool closed_ = false;         // covers the full circle
  std::vector<Patch> patches_;  // one per cell, the azimuth varying fastest
};

// Reads a table in the program's format: a CSV with heading_deg and tilt_deg, or azimuth_deg and
// elevation_deg, and torque_x_N_m, torque_y_N_m, torque_z_N_m about the centre of rotation, in any
// order and among other columns. Every pair of angles occurs once. Lines that start with # are
// skipped. InputError with the line for anything else.
WrenchTable read_wrench_table(const std::filesystem::path& path);

// The table over azimuth and elevation that `key` names. Throws InputError for a table over tilts,
// because `source` ("the wind") comes from all sides.
inline TorqueSurface sphere_of(const Settings& settings, std::string_view key,
                               const std::string& source) {
  TorqueSurface surface(read_wrench_table(file_of(settings, key)));
  if (surface.angles() != WrenchTable::Angles::azimuth_elevation) {
    throw settings.error(key, "a table over tilt and heading",
                         "one over azimuth and elevation: " + source + " comes from all sides");
  }
  return surface;
}

// The torque of a surface at a polar angle and the angle around the pole [N m, body axes].
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
    torque[k] = chain(polar_rad, around_rad, value[k], by_polar[k], by_around[k]);
  }
  return torque;
}

// The torque for light from a direction in body axes [N m]; the surface is over azimuth and
// elevation.
template <class T>
Vec3Of<T> look_up_towards(const TorqueSurface& surface, const Vec3Of<T>& light_body) {
  constexpr double pole_offset = 1e-9;  // off the pole, where the azimuth has no derivative
  const T x = light_body.x() + pole_offset, y = light_body.y(), across = sqrt(x * x + y * y);
  return look_up<T>(surface, atan2(light_body.z(), across), atan2(y, x));
}

}  // namespace photorque
