// CCSDS orbit ephemeris messages (OEM): the path of a spacecraft around the Earth.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "attitude/environment/epoch.h"
#include "core/transform.h"

namespace photorque {

// Axes of a reference frame of CCSDS near the Earth. Source: SANA registry of
// celestial body reference frames.
enum class FrameAxes {
  J2000,    // inertial, equator of J2000: EME2000, J2000, GCRF, ICRF…
  of_date,  // inertial, equator and equinox of date: TOD, MOD, TEME
  earth,    // turn with the Earth: ITRF…
  unknown,
};
FrameAxes axes_of_frame(std::string_view frame);

// The path of one object, from the states of an OEM and by the interpolation that it states
// (HERMITE, LAGRANGE or LINEAR; without one HERMITE of degree 7, four states). Axes are those of
// the message; of a frame that turns with the Earth, they are inertial and of date.
class OrbitEphemeris {
 public:
  // Reads an OEM of version 1, 2 or 3, KVN or XML. Segments have to follow each other without a
  // gap. Covariances and accelerations are not used. InputError for files that are no OEM, other
  // centres than the Earth, frames and time systems that are not known, other interpolations, and
  // states so far apart that the interpolation is uncertain by more than a thousandth of the
  // distance.
  explicit OrbitEphemeris(const std::filesystem::path& path);

  const std::string& object_name() const { return object_name_; }
  // First usable instant in UTC: time 0 of at().
  const Epoch& start() const { return start_; }
  double duration_s() const { return pieces_.back().to_s; }
  // Position from the Earth's centre [m] and velocity [m/s], `time_s` after the start, within
  // [0, duration] or a minute beside it; NumericalError elsewhere.
  std::array<Vec3, 2> at(double time_s) const;
  // Angle of the Earth's zero meridian from the x axis at the start.
  double greenwich_angle_rad() const { return greenwich_angle_rad_; }

 private:
  struct Reader;
  // Newton's polynomial between two neighbouring states.
  struct Piece {
    double from_s, to_s;
    std::vector<double> nodes_s;
    std::vector<Vec3> coefficients;
    std::array<Vec3, 2> at(double time_s) const;
  };

  std::string object_name_, file_;
  Epoch start_;
  double greenwich_angle_rad_ = 0.0;
  std::vector<Piece> pieces_;  // in order of time, without gaps
};

}  // namespace photorque
