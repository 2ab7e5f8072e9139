#include "photovoltaics/array/heat.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/dry_air.h"
#include "core/numerics/root.h"
#include "core/text/parse.h"
#include "photovoltaics/array/keys.h"

namespace photorque {
namespace {

// 2 π⁵ k⁴/(15 h³ c²).
constexpr double stefan_boltzmann_W_m2_K4 = 5.670374419e-8;
// Temperature of the cosmic background: D. J. Fixsen, ApJ 707 (2009) 916.
constexpr double deep_space_K = 2.725;

namespace thermal_key {
constexpr CellHeat usual;
constexpr Range temperatures{coldest_cell_K, hottest_cell_K};
constexpr NumberKey air("air_K", temperatures, "temperature of the surrounding air",
                        {.usually = "`environment.air_temperature_K`, else 293.15"});
constexpr NumberKey surroundings(
    "surroundings_K", {1.0, hottest_cell_K},
    "temperature of the surroundings to which the faces radiate",
    {.usually = "`air_K`; with a disturbance `\"orbit\"` 2.725, deep space"});
constexpr NumberKey convection(
    "convection_W_m2_K", Range::not_negative(),
    "heat transfer coefficient of each face; 0: vacuum; wind adds about 4 W/m²K per m/s (McAdams)",
    {.usually = "natural convection in still air; with a disturbance `\"orbit\"` 0"});
constexpr NumberKey emissivity("emissivity", usual.emissivity, Range::fraction(),
                               "infrared emissivity of each face (cover glass 0.84)");
constexpr NumberKey absorptance(
    "absorptance", usual.absorptance, Range::fraction(),
    "absorbed fraction of the light on the cells; at least their efficiency");
constexpr IntegerKey faces("faces", usual.faces, 1, 2,
                           "number of faces that give off heat; 1: the back is insulated");
constexpr NumberKey capacity(
    "capacity_J_m2_K", usual.capacity_J_m2_K, Range::positive(),
    "heat capacity per area of the cells, for simulations over time; about 1 mm of glass");
constexpr NumberKey start("start_K", temperatures,
                          "initial temperature of the cells in simulations over time",
                          {.usually = "`air_K`; with a disturbance `\"orbit\"` 293.15"});
}  // namespace thermal_key

}  // namespace

std::string CellHeat::in_words() const {
  const auto hundredths = [](double x) { return shortest(std::round(100.0 * x) / 100.0); };
  const std::string air = "air of " + hundredths(air_K) + " K";
  std::string words = faces == 2 ? "both faces in " : "the front in ";
  if (!convection_W_m2_K) {
    words += "still " + air;
  } else if (*convection_W_m2_K > 0.0) {
    words +=
        air + " with " + hundredths(*convection_W_m2_K) + " W/m²K" + (faces == 2 ? " each" : "");
  } else {
    words += "a vacuum";
  }
  const bool elsewhere = convection_W_m2_K == 0.0 || surroundings_K != air_K;
  return words + ", emissivity " + hundredths(emissivity) +
         (elsewhere ? " to " + hundredths(surroundings_K) + " K" : "");
}

CellPlate::CellPlate(const CellHeat& heat, double area_m2)
    : heat_(heat), side_m_(std::sqrt(area_m2)) {}

double CellPlate::natural_convection_W_m2_K(double temperature_K) const {
  constexpr double heat_capacity_J_kg_K = 1007.0;  // dry air from 250 to 400 K, within 0.7 %
  const double film_K = 0.5 * (temperature_K + heat_.air_K);
  const double density = dry_air_density_kg_m3(heat_.air_pressure_Pa, film_K);
  const double viscosity = dry_air_viscosity_Pa_s(film_K);
  const double conductivity = dry_air_conductivity_W_m_K(film_K);
  const double prandtl = heat_capacity_J_kg_K * viscosity / conductivity;
  const double rayleigh = standard_gravity_m_s2 / film_K * std::abs(temperature_K - heat_.air_K) *
                          std::pow(side_m_, 3) * prandtl * std::pow(density / viscosity, 2);
  const double nusselt =
      std::pow(0.825 + 0.387 * std::pow(rayleigh, 1.0 / 6.0) /
                           std::pow(1.0 + std::pow(0.492 / prandtl, 9.0 / 16.0), 8.0 / 27.0),
               2);
  return nusselt * conductivity / side_m_;
}

double CellPlate::loss_W_m2(double temperature_K) const {
  const double convection_W_m2_K =
      heat_.convection_W_m2_K ? *heat_.convection_W_m2_K : natural_convection_W_m2_K(temperature_K);
  const double radiated_W_m2 = heat_.emissivity * stefan_boltzmann_W_m2_K4 *
                               (std::pow(temperature_K, 4) - std::pow(heat_.surroundings_K, 4));
  return heat_.faces * (convection_W_m2_K * (temperature_K - heat_.air_K) + radiated_W_m2);
}

double CellPlate::loss_slope_W_m2_K(double temperature_K) const {
  const double step_K = 1e-4 * temperature_K;
  return (loss_W_m2(temperature_K + step_K) - loss_W_m2(temperature_K - step_K)) / (2.0 * step_K);
}

double CellPlate::temperature_at_loss_K(double loss) const {
  constexpr double least_K = 1.0;
  if (loss_W_m2(least_K) >= loss) return least_K;
  if (loss_W_m2(hottest_cell_K) <= loss) return hottest_cell_K;
  return falling_root(least_K, hottest_cell_K, heat_.air_K, 1e-12, [&](double kelvin) {
    return FunctionAt{loss - loss_W_m2(kelvin), -loss_slope_W_m2_K(kelvin)};
  });
}

// The root of T − L⁻¹(α E − P(T)/A) by the secant method inside a bracket. The electric power is
// between zero and the absorbed light.
double CellPlate::steady_K(double light_W_m2,
                           const std::function<double(double)>& electric_W_m2) const {
  // The last secant step leaves an error of second order in this tolerance.
  constexpr double tolerance = 1e-6;
  const double absorbed_W_m2 = heat_.absorptance * light_W_m2;
  const auto within = [](double kelvin) {
    return std::clamp(kelvin, coldest_cell_K, hottest_cell_K);
  };
  double low = within(temperature_at_loss_K(0.0));
  double high = std::max(low, within(temperature_at_loss_K(absorbed_W_m2)));
  const auto excess_K = [&](double kelvin) {
    const double left_W_m2 = absorbed_W_m2 - std::max(0.0, electric_W_m2(kelvin));
    return kelvin - std::clamp(temperature_at_loss_K(std::max(0.0, left_W_m2)), low, high);
  };
  double at = high, excess = 0.0, slope = 1.0;
  for (int round = 0; round < 100 && high - low > tolerance * high; ++round) {
    const double before = at, excess_before = excess;
    if (round > 0) at -= excess / slope;
    if (round > 0 && !(at > low && at < high)) at = std::midpoint(low, high);
    excess = excess_K(at);
    if (round > 0 && at != before) slope = (excess - excess_before) / (at - before);
    if (!(slope > 0.0)) slope = 1.0;
    (excess < 0.0 ? low : high) = at;
    if (std::abs(excess) <= tolerance * at) break;
  }
  return std::clamp(at - excess / slope, low, high);
}

CellPlate::Step CellPlate::step(double from_K, double heating_W_m2, double step_s) const {
  constexpr double most_decay = 0.25, most_change_K = 10.0;
  constexpr int most_parts = 1000;
  Step step{from_K, 0.0};
  double left_s = step_s;
  for (int part = 1; left_s > 0.0; ++part) {
    // The loss is linearised at the start of the part, which is exact for a linear loss.
    const double loss = loss_W_m2(step.end_K), slope = loss_slope_W_m2_K(step.end_K);
    const double rest_W_m2 = heating_W_m2 - loss;
    const double longest_s = std::min(most_decay * heat_.capacity_J_m2_K / slope,
                                      most_change_K * heat_.capacity_J_m2_K / std::abs(rest_W_m2));
    const double part_s = part < most_parts ? std::min(left_s, longest_s) : left_s;
    const double decay = part_s * slope / heat_.capacity_J_m2_K;
    const double kept = decay > 0.0 ? -std::expm1(-decay) / decay : 1.0;
    step.end_K += rest_W_m2 * part_s * kept / heat_.capacity_J_m2_K;
    step.given_off_J_m2 += part_s * (loss + rest_W_m2 * (1.0 - kept));
    left_s = part_s < left_s ? left_s - part_s : 0.0;
  }
  return step;
}

CellHeat read_cell_heat(const Settings& array, const Surroundings& around) {
  using namespace thermal_key;
  const Settings s = array.table_or_empty(array_key::thermal);
  CellHeat heat;
  heat.air_K = s.get_or(air, around.air_K);
  heat.air_pressure_Pa = around.air_pressure_Pa;
  heat.surroundings_K = s.get_or(surroundings, around.is_vacuum ? deep_space_K : heat.air_K);
  if (s.has(convection)) {
    heat.convection_W_m2_K = s.get(convection);
  } else if (around.is_vacuum) {
    heat.convection_W_m2_K = 0.0;
  }
  heat.emissivity = s.get(emissivity);
  heat.absorptance = s.get(absorptance);
  heat.faces = static_cast<int>(s.get(faces));
  heat.capacity_J_m2_K = s.get(capacity);
  heat.start_K = s.get_or(start, around.is_vacuum ? CellHeat{}.start_K : heat.air_K);
  if (heat.emissivity == 0.0 && heat.convection_W_m2_K == 0.0) {
    throw s.error(emissivity, "0 where no air is",
                  "an emissivity > 0, or a convection_W_m2_K > 0, so that heat can leave");
  }
  return heat;
}

std::vector<Key> thermal_keys() {
  using namespace thermal_key;
  return {air, surroundings, convection, emissivity, absorptance, faces, capacity, start};
}

}  // namespace photorque
