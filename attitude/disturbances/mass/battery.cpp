#include "attitude/disturbances/mass/battery.h"

namespace photorque {
namespace {

Mat3 point_inertia_m2(const Vec3& p_m) {
  return p_m.squaredNorm() * Mat3::Identity() - p_m * p_m.transpose();
}

}  // namespace

Vec3 com_shift_m_C(std::span<const BatteryCell> cells, double platform_mass_kg,
                   double lithium_per_charge_kg_C) {
  Vec3 moment_m = Vec3::Zero();
  for (const BatteryCell& cell : cells) moment_m += cell.charge_fraction * cell.electrodes_body_m;
  return lithium_per_charge_kg_C / platform_mass_kg * moment_m;
}

Mat3 inertia_change_kg_m2_C(std::span<const BatteryCell> cells, double lithium_per_charge_kg_C) {
  Mat3 sum_m2 = Mat3::Zero();
  for (const BatteryCell& cell : cells) {
    const Vec3 anode_m = cell.position_body_m - 0.5 * cell.electrodes_body_m;
    const Vec3 cathode_m = cell.position_body_m + 0.5 * cell.electrodes_body_m;
    sum_m2 += cell.charge_fraction * (point_inertia_m2(cathode_m) - point_inertia_m2(anode_m));
  }
  return lithium_per_charge_kg_C * sum_m2;
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
