// Currents as magnets: their dipole, their field, and cages of coils. Source: eq. 26–28.
#pragma once

#include <array>
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

// Area vector of a closed polygon [m²]: its normal by the right hand along the corners. Independent
// of the origin; a polygon that is not plane has one too.
Vec3 polygon_area_m2(std::span<const Vec3> corners_m);

struct CurrentLoop {
  double current_A = 0.0;
  double turns = 1.0;
  Vec3 area_body_m2 = Vec3::Zero();  // of one turn, along its normal
};

// Eq. 28: m = Σ N I S [A m²].
Vec3 dipole_A_m2(std::span<const CurrentLoop> loops);

// Reads tables with current_A, turns (default 1) and either area_m2 (a vector) or corners_m (a
// polygon, at least three).
std::vector<CurrentLoop> read_current_loops(const std::vector<Settings>& loops);
std::vector<Key> current_loop_keys();

// Field of a current that flows along a straight wire from `from_m` to `to_m` [T]; a closed path of
// such wires is physical, one alone is not. Singular on the wire.
Vec3 straight_wire_field_T(const Vec3& from_m, const Vec3& to_m, double current_A,
                           const Vec3& at_m);

// Field of a closed polygon [T].
Vec3 polygon_field_T(std::span<const Vec3> corners_m, double current_A, const Vec3& at_m);

// A Helmholtz cage: three pairs of square coils around the platform, and the required field. The
// fields are those of straight wires, exact everywhere off the wires.

// Two equal square coils about a lab axis through the centre, one on each side of it.
struct CoilPair {
  double side_m = 0.0;     // > 0
  double spacing_m = 0.0;  // between the coils; most uniform at square_pair_spacing · side
  double turns = 1.0;      // of one coil
};
// Spacing over side at which the second derivative of the field on the axis vanishes.
inline constexpr double square_pair_spacing = 0.544506;

struct CoilCage {
  std::array<CoilPair, 3> pairs;  // about lab x, y and z

  // Field of all coils at a point of the lab [T], with these currents in the three pairs.
  Vec3 field_lab_T(const Vec3& currents_A, const Vec3& at_lab_m) const;
  // Currents that make this field at the centre [A].
  Vec3 currents_A(const Vec3& field_lab_T) const;
  // Largest deviation of the field from that at the centre over the corners and faces of a cube of
  // this edge, relative, for the worst of the three pairs: what a platform of this size feels.
  double nonuniformity(double edge_m) const;
};

// A circular orbit about the Earth's centre, in inertial axes whose z is the Earth's.
struct CircularOrbit {
  double radius_m = 6871.2e3;
  double inclination_rad = 0.0;
  double ascending_node_rad = 0.0;
  double phase_rad = 0.0;            // argument of latitude at time 0
  double greenwich_angle_rad = 0.0;  // of the Earth's zero meridian at time 0

  double motion_rad_s() const;
  // Unit vectors in inertial axes: towards the ascending node, a quarter turn further along the
  // orbit, and from the Earth's centre to the spacecraft.
  Vec3 node() const;
  Vec3 ahead() const;
  Vec3 up(double time_s) const;
};
inline constexpr double earth_gravitation_m3_s2 = 3.986004418e14;  // EGM2008

// Field along an orbit, in inertial axes (the lab frame), sampled every `interval_s` over
// `duration_s` [T]. The Earth and its field rotate below the orbit.
TimeSeries orbit_field_T(const CircularOrbit& orbit, double decimal_year, double duration_s,
                         double interval_s);
// Likewise along any path: from the Earth's centre [m] over time, in axes whose x is
// `greenwich_angle_rad` west of the zero meridian at time 0.
TimeSeries orbit_field_T(const std::function<Vec3(double)>& position_m, double greenwich_angle_rad,
                         double decimal_year, double from_s, double duration_s, double interval_s);

}  // namespace photorque
