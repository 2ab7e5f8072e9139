#include "attitude/disturbances/bearing/air_bearing.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"

namespace photorque {
namespace {

double cube(double x) {
  return x * x * x;
}

// ∫ sin³θ from 0 to θ, the closed form of eq. 17; the half angle keeps its digits for small θ.
double integral_sin_cubed(double theta) {
  const double s = std::sin(0.5 * theta);
  return 4.0 / 3.0 * s * s * s * s * (3.0 - 2.0 * s * s);
}

// ∫ θ sin θ cos θ from 0 to θ.
double integral_theta_sin_cos(double theta) {
  return (std::sin(2.0 * theta) - 2.0 * theta * std::cos(2.0 * theta)) / 8.0;
}

// ∫ sin θ cos θ from 0 to θ.
double integral_sin_cos(double theta) {
  return 0.5 * std::sin(theta) * std::sin(theta);
}

}  // namespace

double load_capacity_N(const SphericalSocket& socket, double inlet_Pa, double ambient_Pa) {
  const double rim = socket.half_angle_rad, recess = socket.recess_half_angle_rad;
  const double film = integral_sin_cos(rim) - integral_sin_cos(recess);
  const double moment = integral_theta_sin_cos(rim) - integral_theta_sin_cos(recess);
  const double fallen = (moment - recess * film) / (rim - recess);
  const double gauge_Pa = inlet_Pa - ambient_Pa;
  return 2.0 * pi * socket.radius_m * socket.radius_m * gauge_Pa * (integral_sin_cos(rim) - fallen);
}

double load_capacity_as_published_N(const SphericalSocket& socket, double inlet_Pa,
                                    double ambient_Pa) {
  const double rim = socket.half_angle_rad;
  const double sine = std::sin(rim) / rim;
  return 2.0 * pi * socket.radius_m * socket.radius_m *
         (inlet_Pa * (1.0 - sine) + ambient_Pa * (sine - std::cos(rim)));
}

FilmDrag film_drag(const SphericalSocket& socket, double viscosity_Pa_s) {
  const double rim = socket.half_angle_rad, recess = socket.recess_half_angle_rad;
  const double sin_cubed = integral_sin_cubed(rim) - integral_sin_cubed(recess);
  const double area = std::cos(recess) - std::cos(rim);  // solid angle over 2π
  const double radius2_m2 = socket.radius_m * socket.radius_m;
  const double scale =
      2.0 * pi * viscosity_Pa_s * radius2_m2 * radius2_m2 / socket.gap_m * socket.sheared_fraction;
  return {scale * sin_cubed, scale * (area - 0.5 * sin_cubed)};
}

double spring_gap_m(double rated_gap_m, double rated_load_N, double stiffness_N_m, double load_N) {
  return std::max(0.0, rated_gap_m + (rated_load_N - load_N) / stiffness_N_m);
}

}  // namespace photorque
