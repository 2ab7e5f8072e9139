#include <cmath>
#include <limits>

#include "core/constants.h"
#include "photovoltaics/cell/cell.h"
#include "photovoltaics/cell/model.h"
#include "tools/supply/trade.h"

namespace photorque {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

const SupplyOption* option_of(const SupplyTrade& trade, const std::string& symbol) {
  for (const SupplyOption& option : trade.options) {
    if (option.symbol == symbol) return &option;
  }
  return nullptr;
}

double figure(const SupplyOption* option, const std::string& name) {
  if (option == nullptr) return none;
  for (const auto& [key, estimate] : option->figures) {
    if (key == name) return estimate.value;
  }
  return none;
}

// The first supply by light; null if there is none.
const SupplyOption* first_beam(const SupplyTrade& trade) {
  for (const SupplyOption& option : trade.options) {
    if (!std::isnan(figure(&option, "emitted_W"))) return &option;
  }
  return nullptr;
}

// Efficiency of a known cell of 1 cm² in sunlight of 1000 W/m² with this short-circuit current.
double in_sunlight(const char* cell, double short_circuit_A) {
  for (const NamedCell& known : known_cells()) {
    if (known.name != cell) continue;
    const CellCurve curve(known.model.reference);
    return curve.maximum_power(curve.photocurrent_A(short_circuit_A)).power_W() / 0.1;
  }
  return none;
}

double efficiency(const SupplyOption* option, const SupplyTask& task) {
  return option == nullptr ? none : task.load_W / option->source_W.value;
}

}  // namespace

// The dark current is the photon flux above the gap from a blackbody into a hemisphere, 2π/(h³c²) ∫
// E² exp(−E/kT) dE. At these energies Planck's denominator equals the exponential.
double radiative_limit(double wavelength_m, double irradiance_W_m2, double gap_J,
                       double temperature_K) {
  const double thermal_J = boltzmann_J_K * temperature_K;
  const double photon_J = planck_J_s * speed_of_light_m_s / wavelength_m;
  if (photon_J < gap_J) return 0.0;
  const double photons = 2.0 * pi / (std::pow(planck_J_s, 3) * std::pow(speed_of_light_m_s, 2)) *
                         thermal_J *
                         (gap_J * gap_J + 2.0 * gap_J * thermal_J + 2.0 * thermal_J * thermal_J) *
                         std::exp(-gap_J / thermal_J);
  const double ratio = irradiance_W_m2 / photon_J / photons;  // photocurrent over dark current
  // Maximum of v (ratio − e^v + 1) with v = qV/kT: solve e^v (1 + v) = 1 + ratio by Newton's
  // method.
  double v = std::log1p(ratio);
  for (int i = 0; i < 50; ++i) {
    v -= (v + std::log1p(v) - std::log1p(ratio)) / (1.0 + 1.0 / (1.0 + v));
  }
  return v * thermal_J * (ratio - std::expm1(v)) / (ratio * photon_J);
}

Table paper_supply_table(const SupplyTrade& trade) {
  Table table = Table::of("paper_supply", "Section III.B of the paper compared with photorque");
  const auto row = [&](const char* quantity, double published, double ours, const char* why) {
    table.row()
        .set("quantity", quantity)
        .set("why", why)
        .set("published", published)
        .set("ours", ours);
  };
  constexpr double paper_load_W = 25.0, day_h = 24.0;
  const double energy_Wh = paper_load_W * day_h;
  row("energy_25_W_24_h_Wh", 360.0, energy_Wh, "25 W x 24 h is 600 Wh; 360 Wh is 15 W x 24 h");
  row("load_of_360_Wh_in_24_h_W", paper_load_W, 360.0 / day_h, "360 Wh in 24 h is 15 W");
  row("battery_lightest_kg", 2.5, energy_Wh / 250.0,
      "600 Wh at 250 Wh/kg, the best packs; 2.5 kg correspond to 240 Wh/kg for 600 Wh, and to 144 "
      "Wh/kg for 360 Wh");
  row("battery_heaviest_kg", 6.0, energy_Wh / 100.0,
      "600 Wh at 100 Wh/kg, rugged packs; for 360 Wh, 6 kg correspond to 60 Wh/kg. The masses "
      "agree with 600 Wh");
  const SupplyOption* low = option_of(trade, "microwave_2_45_GHz");
  const SupplyOption* high = option_of(trade, "microwave_5_8_GHz");
  row("rectifier_2_45_GHz", 0.90, 0.90, "an input: the best rectenna published");
  row("rectifier_5_8_GHz", 0.82, 0.82, "an input, likewise");
  row("transmission_2_45_GHz", 1.0, figure(low, "transmission"),
      "almost unitary only near the aperture; at a wavelength of 12 cm, the beam of an aperture of "
      "0.4 m is wider than the array at 1 m");
  row("transmission_5_8_GHz", 1.0, figure(high, "transmission"),
      "at a wavelength of 5 cm, the beam hardly widens");
  row("mains_to_load_2_45_GHz", none, efficiency(low, trade.task),
      "includes generator, beam and rectifier; the paper gives the rectifier only");
  row("mains_to_load_5_8_GHz", none, efficiency(high, trade.task), "likewise");
  const SupplyOption* coils = option_of(trade, "induction");
  row("induction_link_parallel", none, figure(coils, "link_efficiency"),
      "the paper: most efficient when parallel");
  row("induction_link_tilted", none, figure(coils, "best_link_efficiency_tilted"),
      "at the largest tilt; coils near the centre of rotation remain coupled, and the loss is "
      "small");
  row("silicon_in_sunlight_usual", 0.15, in_sunlight("silicon_back_surface_field", 37e-3),
      "the simplest cell of array.cell, without a module; commercial modules give a sixth less");
  row("silicon_in_sunlight_best", 0.25, in_sunlight("silicon_heterojunction", 41e-3),
      "the best cell of array.cell, at 41 mA/cm2 and 0.750 V");
  constexpr double gallium_arsenide_J = 1.424 * elementary_charge_C;
  row("laser_858_nm", 0.689, radiative_limit(858e-9, 11.4e4, gallium_arsenide_J, 298.15),
      "photorque gives the limit of one junction with radiative losses only, at 858 nm, 11.4 "
      "W/cm2, 25 degC; the cell of [42] reaches most of it");
  const SupplyOption* light = first_beam(trade);
  row("light_on_cells", 0.90, figure(light, "light_on_cells_fraction"),
      "90.2 % on the array; the rest falls into gaps of 1 mm between the cells");
  row("conversion_730_nm", 0.38, figure(light, "conversion_fraction"),
      "quantum efficiency 0.95, 0.72 V per cell, uneven light on cells in series; within the 30 to "
      "40 % of the paper");
  row("array_0_deg_W", 30.0, figure(light, "array_W"), "follows from the two above");
  row("array_30_deg_W", 23.0, figure(light, "sum_of_cells_tilted_W"),
      "the theoretical maximum, sum of the cells' maximum powers, at the largest tilt of the "
      "trade");
  row("array_30_deg_one_tracker_W", none, figure(light, "array_tilted_W"),
      "one operating point for all cells gives less, as stated in the paper");
  return table;
}

}  // namespace photorque
