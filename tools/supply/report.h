// The trade as tables and pictures, and the paper's figures compared with ours.
#pragma once

#include "core/product.h"
#include "tools/runs/console.h"
#include "tools/supply/trade.h"

namespace photorque {

struct SupplyTrade {
  SupplyTask task;
  std::vector<SupplyOption> options;
  // Torque of the battery's lithium by the fraction of its charge that is drawn, at zero tilt.
  std::vector<double> charge_fraction, battery_torque_N_m;
};

// Tables "supply" (a row per way), "supply_by_tilt", "supply_figures", "battery_by_charge" and
// "paper_supply"; plots "supply_over_tilt" and "battery_torque_by_charge"; quantities NAME_….
Product supply_product(const SupplyTrade& trade);
void print_supply(const Console& console, const Product& product, const SupplyTrade& trade);

// Section III.B of the paper: each figure with ours and why they differ; ours is NaN where nothing
// in the trade gives it.
Table paper_supply_table(const SupplyTrade& trade);

// The largest fraction of light of one wavelength that a cell of one junction can turn into
// electric power: every photon is absorbed, all that recombines radiates, into the hemisphere in
// front alone. Source: W. Shockley, H. J. Queisser, J. Appl. Phys. 32 (1961) 510, with the
// blackbody integral over photons above the gap; for one wavelength M. A. Green, Prog. Photovolt. 9
// (2001) 257.
double radiative_limit(double wavelength_m, double irradiance_W_m2, double gap_J,
                       double temperature_K);

}  // namespace photorque
