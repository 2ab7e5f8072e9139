// Magnetic moments of currents (eq. 26–28), and the field along an orbit that a coil cage applies.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "attitude/environment/igrf.h"
#include "attitude/environment/time_series.h"
#include "core/settings/typed_keys.h"
#include "core/transform.h"

namespace photorque {

// Vacuum permeability, CODATA 2018.
inline constexpr double vacuum_permeability_N_A2 = 1.25663706212e-6;

// Area vector of a closed polygon [m²], along its right-handed normal. It is independent of the
// origin, and also defined for a polygon that is not plane.
Vec3 polygon_area_m2(std::span<const Vec3> corners_m);

struct CurrentLoop {
  double current_A = 0.0;
  double turns = 1.0;
  Vec3 area_body_m2 = Vec3::Zero();  // of one turn, along its normal
};

// Eq. 28: m = Σ N I S [A m²].
Vec3 dipole_A_m2(std::span<const CurrentLoop> loops);

// Reads tables with the keys of current_loop_keys().
std::vector<CurrentLoop> read_current_loops(const std::vector<Settings>& loops);
std::vector<Key> current_loop_keys();

// A circular orbit about the Earth's centre, in inertial axes with z along the Earth's axis.
struct CircularOrbit {
  double radius_m = 6871.2e3;
  double inclination_rad = 0.0;
  double ascending_node_rad = 0.0;
  double phase_rad = 0.0;            // argument of latitude at time 0
  double greenwich_angle_rad = 0.0;  // of the Earth's zero meridian at time 0

  double motion_rad_s() const;
  // Unit vectors in inertial axes: to the ascending node, to the point a quarter of a turn further
  // along the orbit, and from the Earth's centre to the spacecraft.
  Vec3 node() const;
  Vec3 ahead() const;
  Vec3 up(double time_s) const;
};
inline constexpr double earth_gravitation_m3_s2 = 3.986004418e14;  // EGM2008

// Field along an orbit [T] in inertial axes (the lab frame), sampled every `interval_s` during
// `duration_s`. The Earth rotates with its field.
TimeSeries orbit_field_T(const CircularOrbit& orbit, double decimal_year, double duration_s,
                         double interval_s);
// Field along any path `position_m`, from the Earth's centre [m] as a function of time. The x axis
// is `greenwich_angle_rad` west of the zero meridian at time 0.
TimeSeries orbit_field_T(const std::function<Vec3(double)>& position_m, double greenwich_angle_rad,
                         double decimal_year, double from_s, double duration_s, double interval_s);

}  // namespace photorque
