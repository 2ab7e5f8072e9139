#include "attitude/disturbances/mass/battery.h"

namespace photorque {
Vec3 com_shift_m_C(std::span<const BatteryCell> cells, double platform_mass_kg,
                   double lithium_per_charge_kg_C) {
  Vec3 moment_m = Vec3::Zero();
  for (const BatteryCell& cell : cells) moment_m += cell.charge_fraction * cell.electrodes_body_m;
  return lithium_per_charge_kg_C / platform_mass_kg * moment_m;
}

double energy_J(std::span<const LoadPhase> profile) {
  double sum_J = 0.0;
  for (const LoadPhase& phase : profile) sum_J += phase.duration_s * phase.power_W;
  return sum_J;
}

double battery_mass_kg(double energy_J, double specific_energy_J_kg) {
  return energy_J / specific_energy_J_kg;
}

}  // namespace photorque
