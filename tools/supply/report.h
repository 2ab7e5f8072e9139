// The comparison as tables and pictures, and comparison with the paper's figures.
#pragma once

#include "core/product.h"
#include "tools/runs/console.h"
#include "tools/supply/trade.h"

namespace photorque {

struct SupplyTrade {
  SupplyTask task;
  std::vector<SupplyOption> options;
  // Torque due to the battery's lithium at zero tilt, by the drawn fraction of its charge.
  std::vector<double> charge_fraction, battery_torque_N_m;
};

// Tables "supply" (a row per supply), "supply_by_tilt", "supply_figures", "battery_by_charge" and
// "paper_supply"; plots "supply_over_tilt" and "battery_torque_by_charge"; quantities NAME_….
Product supply_product(const SupplyTrade& trade);
void print_supply(const Console& console, const Product& product, const SupplyTrade& trade);

// Section III.B of the paper: each figure with the computed value and the reason for the
// difference; NaN if the comparison does not compute it.
Table paper_supply_table(const SupplyTrade& trade);

// Maximum fraction of monochromatic light that a single-junction cell can convert to electric
// power: every photon is absorbed, and recombination is purely radiative, into the front hemisphere
// only. Source: W. Shockley, H. J. Queisser, J. Appl. Phys. 32 (1961) 510, with the blackbody
// integral over photons above the gap; for one wavelength M. A. Green, Prog. Photovolt. 9 (2001)
// 257.
double radiative_limit(double wavelength_m, double irradiance_W_m2, double gap_J,
                       double temperature_K);

}  // namespace photorque
