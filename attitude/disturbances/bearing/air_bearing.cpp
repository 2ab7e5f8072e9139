#include "attitude/disturbances/bearing/air_bearing.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/errors.h"
#include "core/numerics/quadrature.h"
#include "core/numerics/root.h"

namespace photorque {

namespace {

// ∫ sin³θ from 0 to θ, the closed form of eq. 17. The half angle keeps the precision for small θ.
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

namespace {

constexpr double gas_constant_J_kg_K = 287.05;  // dry air, as in Environment
constexpr double heat_ratio = 1.4;

// The zero of `f`, which decreases in x, between two brackets, to a relative error of 1e-14.
template <class Function>
double crossing(double low, double high, const Function& f) {
  return bisect(low, high, [&](double x) { return f(x) > 0.0; }, {200, 1e-14}).middle();
}

// Number of panels that integrates the pressure in the film (logarithm or Bessel function) to
// rounding errors.
constexpr int film_panels = 16;

// Isentropic flow through a hole, choked below the critical pressure ratio.
double nozzle_flow_kg_s(const OrificeFeed& feed, double downstream_Pa, double temperature_K) {
  const double g = heat_ratio;
  const double critical = std::pow(2.0 / (g + 1.0), g / (g - 1.0));
  const double ratio = std::fmax(downstream_Pa / feed.supply_Pa, critical);
  const double speed =
      std::sqrt(2.0 * g / (g - 1.0) * (std::pow(ratio, 2.0 / g) - std::pow(ratio, (g + 1.0) / g)) /
                (gas_constant_J_kg_K * temperature_K));
  return feed.discharge_coefficient * feed.hole_area_m2 * feed.supply_Pa * speed;
}

// ∫ dθ / sin θ from the recess to θ.
double film_length(const SphericalSocket& socket, double theta) {
  return std::log(std::tan(0.5 * theta) / std::tan(0.5 * socket.recess_half_angle_rad));
}

double film_load_N(const SphericalSocket& socket, double inlet_Pa, double ambient_Pa) {
  const double recess = socket.recess_half_angle_rad, rim = socket.half_angle_rad;
  const double fall_Pa2 = inlet_Pa * inlet_Pa - ambient_Pa * ambient_Pa;
  const double whole = film_length(socket, rim);
  const auto gauge_on_vertical = [&](double theta) {
    const double square = inlet_Pa * inlet_Pa - fall_Pa2 * film_length(socket, theta) / whole;
    return (std::sqrt(square) - ambient_Pa) * std::sin(theta) * std::cos(theta);
  };
  const double sine = std::sin(recess);
  return 2.0 * pi * socket.radius_m * socket.radius_m *
         (0.5 * sine * sine * (inlet_Pa - ambient_Pa) +
          integrate(gauss_8, gauge_on_vertical, recess, rim, film_panels));
}

void require_feed(const SphericalSocket& socket, const OrificeFeed& feed, const FilmAir& air) {
  if (!(socket.recess_half_angle_rad > 0.0) || !(feed.supply_Pa > air.pressure_Pa)) {
    throw NumericalError(
        "air film: an orifice-fed socket needs a recess and a supply above ambient pressure");
  }
}

}  // namespace

FilmState orifice_fed_film(const SphericalSocket& socket, const OrificeFeed& feed,
                           const FilmAir& air) {
  require_feed(socket, feed, air);
  const double h3_m3 = socket.gap_m * socket.gap_m * socket.gap_m;
  const double conductance = pi * h3_m3 /
                             (12.0 * air.viscosity_Pa_s * gas_constant_J_kg_K * air.temperature_K *
                              film_length(socket, socket.half_angle_rad));
  const auto film_flow_kg_s = [&](double inlet_Pa) {
    return conductance * (inlet_Pa * inlet_Pa - air.pressure_Pa * air.pressure_Pa);
  };
  const double inlet_Pa = crossing(air.pressure_Pa, feed.supply_Pa, [&](double p_Pa) {
    return nozzle_flow_kg_s(feed, p_Pa, air.temperature_K) - film_flow_kg_s(p_Pa);
  });
  return {film_load_N(socket, inlet_Pa, air.pressure_Pa), film_flow_kg_s(inlet_Pa), inlet_Pa};
}

double gap_under_load_m(const SphericalSocket& socket, const OrificeFeed& feed, const FilmAir& air,
                        double load_N) {
  require_feed(socket, feed, air);
  const auto spare_N = [&](double gap_m) {
    SphericalSocket at = socket;
    at.gap_m = gap_m;
    return orifice_fed_film(at, feed, air).load_N - load_N;
  };
  const double widest_m = 1e-2 * socket.radius_m;
  if (load_N >= film_load_N(socket, feed.supply_Pa, air.pressure_Pa)) {
    throw NumericalError("air film: the load exceeds the capacity of the supply pressure");
  }
  if (spare_N(widest_m) > 0.0) {
    throw NumericalError("air film: the load is too small for any film thinner than 1 % of R");
  }
  return crossing(0.0, widest_m, spare_N);
}

}  // namespace photorque
