#include "attitude/studies/cable.h"

#include "core/constants.h"

namespace photorque {

namespace {

// Annealed copper (ASM Handbook vol. 2).
constexpr double copper_modulus_Pa = 1.17e11;
constexpr double copper_poisson = 0.34;
// Silicone rubber.
constexpr double insulation_density_kg_m3 = 1150.0;

double fourth(double x) {
  return x * x * x * x;
}

double copper_area_m2(const PowerCable& cable) {
  return cable.strands * 0.25 * pi * cable.strand_diameter_m * cable.strand_diameter_m;
}

double insulation_area_m2(const PowerCable& cable) {
  const double outer = 0.25 * pi * cable.insulation_diameter_m * cable.insulation_diameter_m;
  return outer - copper_area_m2(cable);
}

// Second moments of area of one wire: of its strands, each about its axis, and of the tube of
// insulation.
double strands_m4(const PowerCable& cable) {
  return cable.strands * pi / 64.0 * fourth(cable.strand_diameter_m);
}

double tube_m4(const PowerCable& cable) {
  const double inner_m2 = 4.0 / pi * copper_area_m2(cable);
  return pi / 64.0 * (fourth(cable.insulation_diameter_m) - inner_m2 * inner_m2);
}

}  // namespace

double bending_stiffness_N_m_rad(const PowerCable& cable) {
  const double stiffness_N_m2 = cable.wires * (copper_modulus_Pa * strands_m4(cable) +
                                               cable.insulation_modulus_Pa * tube_m4(cable));
  return 4.0 * stiffness_N_m2 / cable.length_m;
}

double twisting_stiffness_N_m_rad(const PowerCable& cable) {
  const double copper_shear_Pa = copper_modulus_Pa / (2.0 * (1.0 + copper_poisson));
  const double stiffness_N_m2 =
      cable.wires * 2.0 *
      (copper_shear_Pa * strands_m4(cable) + cable.insulation_modulus_Pa / 3.0 * tube_m4(cable));
  return stiffness_N_m2 / cable.length_m;
}

double cable_mass_kg(const PowerCable& cable) {
  return cable.wires * cable.length_m *
         (copper_density_kg_m3 * copper_area_m2(cable) +
          insulation_density_kg_m3 * insulation_area_m2(cable));
}

double loop_resistance_ohm(const PowerCable& cable) {
  return 2.0 * copper_resistivity_ohm_m * cable.length_m /
         (copper_area_m2(cable) * 0.5 * cable.wires);
}

}  // namespace photorque
