// The Earth's main magnetic field: IGRF-14 and the tilted-dipole shorthand of the source paper.
//
// IGRF-14 is the gradient of the potential of eq. 23, degree and order 13, linear between epochs of
// five years. It holds the field of the core; the crust adds up to a few hundred nT locally, a
// building's steel some µT, and the ionosphere tens of nT in quiet times: a measured field, where
// there is one, beats it in the laboratory.
#pragma once

#include <array>

#include "core/transform.h"

namespace photorque {

// On or above the WGS84 ellipsoid. Latitude within ±π/2; longitude positive east, any turn; height
// above the ellipsoid, not above sea.
struct GeodeticPosition {
  double latitude_rad = 0.0;
  double longitude_rad = 0.0;
  double height_m = 0.0;
};

// Distance from the Earth's centre, angle from the north pole within [0, π], longitude east.
struct GeocentricPosition {
  double radius_m = 6371.2e3;
  double colatitude_rad = 0.0;
  double longitude_rad = 0.0;
};

// The model frozen at one date, for many positions.
class GeomagneticModel {
 public:
  // `decimal_year` within [1900, 2035]: 2025–2030 uses the published secular variation, the five
  // years after extrapolate it (errors of order 100 nT). NumericalError outside.
  explicit GeomagneticModel(double decimal_year);

  // Geodetic north, east and down [T]. At a pole, north is that of the given longitude.
  // Agrees with the coefficients' own evaluation to 0.1 nT, the rounding of the ellipsoid's axes in
  // the reference implementation igrf14syn.
  Vec3 north_east_down_T(const GeodeticPosition& position) const;
  // Geocentric north (towards falling colatitude), east, and down (towards the centre) [T].
  Vec3 north_east_down_T(const GeocentricPosition& position) const;
  // The lab frame: x east, y north, z up [T].
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

// Field of a centred dipole at its equator, as the paper takes it (eq. 24); the dipole of IGRF-14
// at 2025.0 gives 2.97e-5 T.
inline constexpr double dipole_equatorial_field_T = 3.12e-5;

}  // namespace photorque
