// Compliance: displacement of the centre of mass per unit of gravity.
//
// The weight of an elastic structure displaces its centre of mass by C g_B, with a symmetric C [s²]
// in body axes. If the platform is balanced at zero tilt, the torque at another attitude is
// m C (g_B − g_B,ref) × g_B (disturbance elastic_sag). The functions compute C for the two
// structures of the paper. Their beams are slender, clamped at the middle, and bend only across
// their length. Source: eq. 2 and 3, corrected by Euler–Bernoulli's deflections (docs/physics.md).
#pragma once

#include "core/transform.h"

namespace photorque {

// Two opposite arms along `axis_body`, each a beam with an instrument at its end.
struct DumbbellArms {
  Vec3 axis_body = Vec3::UnitX();       // any length but zero
  double length_m = 0.0;                // of one arm, > 0
  double end_mass_kg = 0.0;             // M_s, at the end of one arm
  double beam_mass_kg = 0.0;            // m_l, of one arm
  double bending_stiffness_N_m2 = 0.0;  // EI, > 0
};

// `count` equal counterbalance beams along the body's z axis, clamped at the plate.
struct CounterbalanceBeams {
  double length_m = 0.0;
  double total_mass_kg = 0.0;           // m_l, of all beams together
  double bending_stiffness_N_m2 = 0.0;  // EI of one beam
  int count = 1;                        // N_l
};

// Compliance of the centre of mass of the whole platform [s²]; `platform_mass_kg` is the total
// mass.
Mat3 sag_compliance_s2(const DumbbellArms& arms, double platform_mass_kg);
Mat3 sag_compliance_s2(const CounterbalanceBeams& beams, double platform_mass_kg);

// Torque [N m] about a horizontal axis perpendicular to the arms (beams), for a tilt about that
// axis, balanced at zero tilt. Dumbbell, whose arms tilt: ∝ sin θ − ½ sin 2θ; tabletop: ∝ sin 2θ.
// Positive: increases the tilt.
double sag_torque_N_m(const DumbbellArms& arms, double tilt_rad, double gravity_m_s2);
double sag_torque_N_m(const CounterbalanceBeams& beams, double tilt_rad, double gravity_m_s2);

}  // namespace photorque
