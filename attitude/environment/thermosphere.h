// The mean density of the atmosphere at the altitudes of satellites.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "core/constants.h"
#include "core/transform.h"

namespace photorque {

// Altitude above the ellipsoid WGS 84 of a point given from the Earth's centre in axes whose z is
// the Earth's: r − a (1 − f z²/r²). Accurate to 0.1 km in low orbits.
template <class T>
T ellipsoid_altitude_m(const Eigen::Matrix<T, 3, 1>& position_m) {
  using std::sqrt;
  const T square_m2 = position_m.dot(position_m);
  const T height = position_m.z() * position_m.z() / square_m2;
  return sqrt(square_m2) - earth_equatorial_radius_m * (1.0 - earth_flattening * height);
}

// A mean atmosphere from 100 to 1000 km. The density of a day differs from it by factors.
// Source: D. A. Vallado, Fundamentals of Astrodynamics and Applications, 4th ed. (2013), table 8-4
// (CIRA-72). Its densities are met exactly; their logarithm is interpolated by monotone cubics,
// which are smooth for an integrator and up to 4 % below the table's exponentials between the rows.
// Below 100 km the density is held, above 1000 km it falls with the table's last scale height.
class Thermosphere {
 public:
  Thermosphere();

  // Density [kg/m³] and its derivative [kg/m⁴] at an altitude above the ellipsoid.
  std::array<double, 2> at(double altitude_m) const;

 private:
  std::vector<double> altitude_m_, log_density_, slope_1_m_;
};

}  // namespace photorque
