#include "attitude/environment/igrf.h"

#include <cmath>
#include <numbers>
#include <string>

#include "core/errors.h"

namespace photorque {
namespace {

constexpr double first_epoch = 1900.0;
constexpr double years_per_epoch = 5.0;
constexpr int epochs = 26;
constexpr double last_year = 2035.0;

struct CoefficientRow {
  bool is_h;
  int n;
  int m;
  std::array<double, epochs> value_nT;
  double rate_nT_per_year;
};

constexpr CoefficientRow coefficient_rows[] = {
#include "attitude/environment/igrf14_coefficients.inc"
};

double at_year(const CoefficientRow& row, double decimal_year) {
  const double steps = (decimal_year - first_epoch) / years_per_epoch;
  const int before = std::min(static_cast<int>(steps), epochs - 1);
  const double rate = before < epochs - 1
                          ? (row.value_nT[before + 1] - row.value_nT[before]) / years_per_epoch
                          : row.rate_nT_per_year;
  return row.value_nT[before] + rate * (steps - before) * years_per_epoch;
}

}  // namespace

GeomagneticModel::GeomagneticModel(double decimal_year) {
  if (!(decimal_year >= first_epoch && decimal_year <= last_year))
    throw NumericalError("geomagnetic field: year " + std::to_string(decimal_year) +
                         " is outside IGRF-14's 1900 to 2035");
  for (const CoefficientRow& row : coefficient_rows)
    (row.is_h ? h_nT_ : g_nT_)[index(row.n, row.m)] = at_year(row, decimal_year);
}

// Sums the gradient of eq. 23 by degree and order. P is the Schmidt semi-normalised associated
// Legendre function and D its derivative in θ. Q = P / sin θ for m ≥ 1 has a separate recursion
// that starts at 1. There is no division by sin θ, so the poles need no special case.
Vec3 GeomagneticModel::north_east_down_T(const GeocentricPosition& position) const {
  const double c = std::cos(position.colatitude_rad);
  const double s = std::sin(position.colatitude_rad);
  const double ratio = reference_radius_of_earth_m / position.radius_m;
  std::array<double, count> P{}, D{}, Q{};
  P[0] = 1.0;
  std::array<double, degree + 1> radial{};
  radial[0] = ratio * ratio;
  for (int n = 1; n <= degree; ++n) radial[n] = radial[n - 1] * ratio;

  Vec3 field_nT = Vec3::Zero();
  for (int m = 0; m <= degree; ++m) {
    if (m > 0) {
      const double k = m == 1 ? 1.0 : std::sqrt((2.0 * m - 1.0) / (2.0 * m));
      const int here = index(m, m), diagonal = index(m - 1, m - 1);
      P[here] = k * s * P[diagonal];
      D[here] = k * (s * D[diagonal] + c * P[diagonal]);
      Q[here] = k * P[diagonal];
    }
    const double cos_m = std::cos(m * position.longitude_rad);
    const double sin_m = std::sin(m * position.longitude_rad);
    for (int n = std::max(m, 1); n <= degree; ++n) {
      const int here = index(n, m);
      if (n > m) {
        const double scale = 1.0 / std::sqrt(double(n * n - m * m));
        const double a = (2.0 * n - 1.0) * scale;
        const double b = std::sqrt(double((n - 1) * (n - 1) - m * m)) * scale;
        const int one = index(n - 1, m), two = n - 2 >= m ? index(n - 2, m) : 0;
        const double use_two = n - 2 >= m ? b : 0.0;
        P[here] = a * c * P[one] - use_two * P[two];
        D[here] = a * (c * D[one] - s * P[one]) - use_two * D[two];
        Q[here] = a * c * Q[one] - use_two * Q[two];
      }
      const double in_phase = g_nT_[here] * cos_m + h_nT_[here] * sin_m;
      const double quadrature = g_nT_[here] * sin_m - h_nT_[here] * cos_m;
      field_nT += radial[n] *
                  Vec3(in_phase * D[here], m * quadrature * Q[here], -(n + 1) * in_phase * P[here]);
    }
  }
  return field_nT * 1e-9;
}

Vec3 GeomagneticModel::north_east_down_T(const GeodeticPosition& position) const {
  const double e2 = earth_flattening * (2.0 - earth_flattening);
  const double sin_lat = std::sin(position.latitude_rad), cos_lat = std::cos(position.latitude_rad);
  const double prime_vertical_m =
      earth_equatorial_radius_m / std::sqrt(1.0 - e2 * sin_lat * sin_lat);
  const double axis_distance_m = (prime_vertical_m + position.height_m) * cos_lat;
  const double plane_distance_m = (prime_vertical_m * (1.0 - e2) + position.height_m) * sin_lat;
  const double colatitude_rad = std::atan2(axis_distance_m, plane_distance_m);
  const Vec3 geocentric = north_east_down_T(GeocentricPosition{
      std::hypot(axis_distance_m, plane_distance_m), colatitude_rad, position.longitude_rad});
  // The geodetic vertical is tilted from the geocentric one by ψ about the common east axis.
  const double psi = position.latitude_rad - (std::numbers::pi / 2.0 - colatitude_rad);
  return {geocentric.x() * std::cos(psi) + geocentric.z() * std::sin(psi), geocentric.y(),
          geocentric.z() * std::cos(psi) - geocentric.x() * std::sin(psi)};
}

Vec3 GeomagneticModel::lab_T(const GeodeticPosition& position) const {
  const Vec3 ned_T = north_east_down_T(position);
  return {ned_T.y(), ned_T.x(), -ned_T.z()};
}

double GeomagneticModel::dipole_equatorial_field_T() const {
  return Vec3(g_nT_[index(1, 0)], g_nT_[index(1, 1)], h_nT_[index(1, 1)]).norm() * 1e-9;
}

}  // namespace photorque
