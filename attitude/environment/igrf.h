// The Earth's main magnetic field: IGRF-14 and the tilted-dipole approximation of the source paper.
//
// IGRF-14 is the gradient of the potential of eq. 23 up to degree and order 13, linear between
// epochs of five years. It describes the field of the core. The crust adds up to a few hundred nT
// locally, steel in a building some µT, and the ionosphere tens of nT in quiet times. A measured
// field is therefore more accurate in a laboratory.
#pragma once

#include <array>

#include "core/constants.h"
#include "core/transform.h"

namespace photorque {

// A position on or above the WGS84 ellipsoid. Latitude in ±π/2; longitude positive to the east,
// with any number of turns; height above the ellipsoid, not above sea level.
struct GeodeticPosition {
  double latitude_rad = 0.0;
  double longitude_rad = 0.0;
  double height_m = 0.0;
};

// Distance from the Earth's centre, angle from the north pole in [0, π], longitude to the east.
struct GeocentricPosition {
  double radius_m = reference_radius_of_earth_m;
  double colatitude_rad = 0.0;
  double longitude_rad = 0.0;
};

// The model at one date, for many positions.
class GeomagneticModel {
 public:
  // `decimal_year` in [1900, 2035]. 2025–2030 uses the published secular variation; the five years
  // after it are extrapolated (errors of order 100 nT). NumericalError outside.
  explicit GeomagneticModel(double decimal_year);

  // Field to geodetic north, east and down [T]. At a pole, north is that of the given longitude.
  // The difference from the reference implementation igrf14syn is 0.1 nT, due to its rounded axes
  // of the ellipsoid.
  Vec3 north_east_down_T(const GeodeticPosition& position) const;
  // Field to geocentric north (towards decreasing colatitude), east and down (to the centre) [T].
  Vec3 north_east_down_T(const GeocentricPosition& position) const;
  // Field in the lab frame: x east, y north, z up [T].
  Vec3 lab_T(const GeodeticPosition& position) const;
  // Field of the model's centred dipole (degree 1) at its equator, at 6371.2 km [T].
  double dipole_equatorial_field_T() const;

 private:
  static constexpr int degree = 13;
  static constexpr int count = (degree + 1) * (degree + 2) / 2;
  static constexpr int index(int n, int m) { return n * (n + 1) / 2 + m; }

  std::array<double, count> g_nT_{};
  std::array<double, count> h_nT_{};
};

// Field of a centred dipole at its equator, as assumed in the paper (eq. 24). The dipole of IGRF-14
// at 2025.0 gives 2.97e-5 T.
inline constexpr double dipole_equatorial_field_T = 3.12e-5;

}  // namespace photorque
