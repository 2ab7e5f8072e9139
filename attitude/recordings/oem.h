// CCSDS orbit ephemeris messages (OEM): the path of a spacecraft around the Earth.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "attitude/environment/epoch.h"
#include "core/transform.h"

namespace photorque {

// The path of one object, interpolated between the states of an OEM by the method that it states
// (HERMITE, LAGRANGE or LINEAR; by default HERMITE of degree 7, with four states). Axes are those
// of the message. For a frame that rotates with the Earth, they are inertial and of date.
class OrbitEphemeris {
 public:
  // Reads an OEM of version 1, 2 or 3, KVN or XML. Segments must follow one another without a gap.
  // Covariances and accelerations are not used. InputError for a file that is no OEM, a centre
  // other than the Earth, and unknown frames, time systems or interpolations. InputError also for
  // states so far apart that the uncertainty of the interpolation exceeds 0.1 % of the distance.
  explicit OrbitEphemeris(const std::filesystem::path& path);

  const std::string& object_name() const { return object_name_; }
  // First usable time in UTC: time 0 of at().
  const Epoch& start() const { return start_; }
  double duration_s() const { return pieces_.back().to_s; }
  // Position from the Earth's centre [m] and velocity [m/s] at `time_s` after the start, in [0,
  // duration] or within a minute of it. NumericalError elsewhere.
  std::array<Vec3, 2> at(double time_s) const;
  // Angle of the Earth's zero meridian from the x axis at the start [rad].
  double greenwich_angle_rad() const { return greenwich_angle_rad_; }

 private:
  struct Reader;
  // Newton's interpolation polynomial between two neighbouring states.
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
