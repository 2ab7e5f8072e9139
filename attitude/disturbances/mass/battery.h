// The effect of a discharging lithium-ion battery on a platform: lithium migrates from anode to
// cathode and displaces the centre of mass. Source: eq. 30–34.
#pragma once

#include <span>

#include "core/constants.h"
#include "core/transform.h"

namespace photorque {

// Lithium per charge, one ion per electron, M/F: 7.19e-8 kg/C or 0.2589 g/Ah. Molar mass 6.94 g/mol
// (IUPAC 2021, conventional value; natural sources vary by 0.4 %).
inline constexpr double lithium_kg_C = 6.94e-3 / faraday_C_mol;
// Eq. 31: the 0.3 g/Ah of the transport rules, which count all lithium in a cell and round up.
inline constexpr double lithium_as_published_kg_C = 0.3e-3 / 3600.0;

// One cell, anywhere on the platform.
struct BatteryCell {
  // Vector from the mean position of the lithium in the charged cell (anode) to that in the empty
  // cell (cathode), body axes. The paper assumes half the length of the cell. In wound and stacked
  // cells, electrodes alternate about every 0.1 mm, so that this is too large by orders of
  // magnitude.
  Vec3 electrodes_body_m = Vec3::Zero();
  // Fraction of the battery's charge that passes through this cell: 1 in series, 1/n of n in
  // parallel.
  double charge_fraction = 1.0;
};

// Shift of the platform's centre of mass per charge drawn [m/C] (eq. 30). Equal cells mounted in
// opposition cancel.
inline Vec3 com_shift_m_C(std::span<const BatteryCell> cells, double platform_mass_kg,
                          double lithium_per_charge_kg_C = lithium_kg_C) {
  Vec3 moment_m = Vec3::Zero();
  for (const BatteryCell& cell : cells) moment_m += cell.charge_fraction * cell.electrodes_body_m;
  return lithium_per_charge_kg_C / platform_mass_kg * moment_m;
}

}  // namespace photorque
