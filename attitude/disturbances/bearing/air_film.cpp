#include "attitude/disturbances/bearing/air_film.h"

#include <cmath>

#include "core/constants.h"
#include "core/errors.h"
#include "core/numerics/quadrature.h"
#include "core/numerics/root.h"

namespace photorque {
namespace {

constexpr double gas_constant_J_kg_K = 287.05;  // dry air, as in Environment
constexpr double heat_ratio = 1.4;

// Where `f`, falling in x, crosses zero between two brackets, to 1e-14 of itself.
template <class Function>
double crossing(double low, double high, const Function& f) {
  return bisect(low, high, [&](double x) { return f(x) > 0.0; }, {200, 1e-14}).middle();
}

// The pressure falls like a logarithm or a Bessel function over the film: to rounding.
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

double feeding_number_1_m2(const PorousPad& pad, double gap_m) {
  return 12.0 * pad.permeability_per_thickness_m / (gap_m * gap_m * gap_m);
}

// e^{−x} I_ν(x) for ν = 0, 1: the plain function overflows for the thin films of strong feeding.
double scaled_bessel_i(int order, double x) {
  if (x < 500.0) return std::cyl_bessel_i(order, x) * std::exp(-x);
  const double m = 4.0 * order * order;  // Hankel's expansion
  return (1.0 - (m - 1.0) / (8.0 * x) + (m - 1.0) * (m - 9.0) / (128.0 * x * x)) /
         std::sqrt(2.0 * pi * x);
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
    throw NumericalError("air film: the load exceeds what the supply pressure can carry");
  }
  if (spare_N(widest_m) > 0.0) {
    throw NumericalError("air film: the load is too small for any film thinner than 1 % of R");
  }
  return crossing(0.0, widest_m, spare_N);
}

double porous_pad_pressure_Pa(const PorousPad& pad, double gap_m, double supply_Pa,
                              const FilmAir& air, double r_m) {
  const double lambda_1_m = std::sqrt(feeding_number_1_m2(pad, gap_m));
  const double x = lambda_1_m * r_m, rim = lambda_1_m * pad.radius_m;
  const double fraction = scaled_bessel_i(0, x) / scaled_bessel_i(0, rim) * std::exp(x - rim);
  const double supply2_Pa2 = supply_Pa * supply_Pa;
  return std::sqrt(supply2_Pa2 - (supply2_Pa2 - air.pressure_Pa * air.pressure_Pa) * fraction);
}

FilmState porous_pad_film(const PorousPad& pad, double gap_m, double supply_Pa,
                          const FilmAir& air) {
  const auto gauge_on_ring = [&](double r_m) {
    return 2.0 * pi * r_m *
           (porous_pad_pressure_Pa(pad, gap_m, supply_Pa, air, r_m) - air.pressure_Pa);
  };
  const double load_N = integrate(gauss_8, gauge_on_ring, 0.0, pad.radius_m, film_panels);
  const double lambda_1_m = std::sqrt(feeding_number_1_m2(pad, gap_m));
  const double rim = lambda_1_m * pad.radius_m;
  const double flow_kg_s = 2.0 * pi * rim * gap_m * gap_m * gap_m /
                           (24.0 * air.viscosity_Pa_s * gas_constant_J_kg_K * air.temperature_K) *
                           (supply_Pa * supply_Pa - air.pressure_Pa * air.pressure_Pa) *
                           scaled_bessel_i(1, rim) / scaled_bessel_i(0, rim);
  return {load_N, flow_kg_s, porous_pad_pressure_Pa(pad, gap_m, supply_Pa, air, 0.0)};
}

}  // namespace photorque
