// Circular current filaments anywhere in space: field, mutual inductance, force and torque, by
// complete elliptic integrals on one circle and quadrature round the other.
//
// Source of the field and the vector potential: W. R. Smythe, Static and Dynamic Electricity, 3rd
// ed. (1968), sec. 7.10. The mutual inductance is the circulation of the potential, the one
// integral of S. Babic and others, "Mutual inductance calculation between circular filaments
// arbitrarily positioned in space: alternative to Grover's formula", IEEE Trans. Magn. 46 (2010)
// 3591; coaxial circles have Maxwell's closed form (Treatise, art. 701). Thin wires in vacuum.
#pragma once

#include "core/transform.h"

namespace photorque {

struct CircularFilament {
  Vec3 centre_m = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();  // unit; the current goes round it by the right hand
  double radius_m = 1.0;        // > 0
};

// At a point off the wire, of 1 A.
Vec3 filament_field_T_A(const CircularFilament& filament, const Vec3& at_m);
Vec3 filament_potential_T_m_A(const CircularFilament& filament, const Vec3& at_m);

// Of two filaments that do not touch; relative error about 1e-13 where their distance is above a
// hundredth of their radii. NumericalError where the quadrature does not settle.
double mutual_inductance_H(const CircularFilament& a, const CircularFilament& b);
// Maxwell's closed form: coaxial circles at an axial distance.
double coaxial_inductance_H(double radius_a_m, double radius_b_m, double distance_m);

// What the current in `source` does to the current in `target`, both 1 A; torque about a point.
struct FilamentForce {
  Vec3 force_N_A2 = Vec3::Zero();
  Vec3 torque_N_m_A2 = Vec3::Zero();
};
FilamentForce filament_force(const CircularFilament& source, const CircularFilament& target,
                             const Vec3& about_m);

}  // namespace photorque
