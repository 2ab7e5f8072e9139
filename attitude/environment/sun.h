// Direction of the Sun from a spacecraft during a recording.
#pragma once

#include <array>
#include <optional>

#include "attitude/environment/time_series.h"
#include "core/constants.h"
#include "core/numerics/dual.h"
#include "core/settings/typed_keys.h"
#include "core/transform.h"

namespace photorque {

// An elliptic orbit about the Sun, in the ecliptic and equinox of J2000.
struct HeliocentricOrbit {
  double semi_major_axis_au = 1.0;  // > 0
  double eccentricity = 0.0;        // in [0, 1)
  double inclination_rad = 0.0;
  double ascending_node_rad = 0.0;
  double perihelion_rad = 0.0;    // argument of perihelion, from the node
  double mean_anomaly_rad = 0.0;  // at time 0

  // Positions and velocities at eight instants, in axes of the orbital plane: x to the perihelion,
  // y along the motion there.
  struct InPlane {
    std::array<Lanes, 2> position_au, velocity_au_s;
  };
  InPlane in_plane(const Lanes& time_s) const;
  Mat3 ecliptic_from_plane() const;
};

// The orbit of the Earth from its mean elements. The direction of the Sun is accurate to 0.02 deg
// from 1950 to 2050 (The Astronomical Almanac, low-precision formulas for the Sun's coordinates).
// `since_J2000_s`: time since 2000-01-01T12:00.
HeliocentricOrbit orbit_of_earth(double since_J2000_s);

// Vector from the spacecraft to the Sun in lab axes [au], a smooth function of time.
class SunPath {
 public:
  static SunPath fixed(const Vec3& towards_lab_au);
  // The length of the vectors in a table is ignored.
  static SunPath table(TimeSeries towards_lab, double distance_au);
  static SunPath orbit(const HeliocentricOrbit& orbit, const Mat3& lab_from_ecliptic);

  // Value and time derivative of each component.
  std::array<Vec3, 2> at(double time_s) const;
  std::array<Vec3Of<Lanes>, 2> at(const Lanes& time_s) const;

 private:
  // The value from the table, or the fixed one.
  std::array<Vec3, 2> of_table(double time_s) const;

  Vec3 fixed_au_ = Vec3::UnitX();
  std::optional<TimeSeries> table_;
  std::optional<HeliocentricOrbit> orbit_;
  Eigen::Matrix<double, 3, 2> lab_from_plane_ = {};
};

// Reads [environment.sun], whose keys are sun_table(). InputError unless exactly one of
// `direction`, `table` and `date` is given.
SunPath read_sun(const Settings& settings);
Key sun_table();

// Fraction of a luminous disc that an opaque disc leaves uncovered, in [0, 1], from the angular
// radii of both and the angle between their centres [rad]. The discs are treated as flat: for
// sources of some degrees the error is of the order of per cents.
double uncovered_fraction(double source_radius_rad, double cover_radius_rad, double separation_rad);

// Fraction of the Sun's disc that a planet of radius `planet_radius_m` at the origin leaves visible
// from a satellite: 1 in full light, 0 in the umbra. Positions in one frame from the planet's
// centre [m]. The satellite must be outside the planet.
double sunlit_fraction(const Vec3& satellite_m, const Vec3& sun_m, double planet_radius_m,
                       double sun_radius_m = 6.957e8);

}  // namespace photorque
