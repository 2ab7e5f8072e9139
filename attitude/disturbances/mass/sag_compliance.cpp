#include "attitude/disturbances/mass/sag_compliance.h"

#include <cmath>

namespace photorque {
namespace {

// ∫ (displacement) dm [kg s²] of one clamped beam of mass m with an end mass M, per unit of
// transverse gravity. Per unit load, the end load displaces the end by l³/3EI and the mean of the
// beam by l³/8EI. The weight of the beam displaces the end by l³/8EI and its mean by l³/20EI.
double sagging_moment_kg_s2(double length_m, double end_mass_kg, double beam_mass_kg,
                            double bending_stiffness_N_m2) {
  const double M = end_mass_kg, m = beam_mass_kg;
  return length_m * length_m * length_m * (M * M / 3.0 + M * m / 4.0 + m * m / 20.0) /
         bending_stiffness_N_m2;
}

double sagging_moment_kg_s2(const DumbbellArms& arms) {
  return 2.0 * sagging_moment_kg_s2(arms.length_m, arms.end_mass_kg, arms.beam_mass_kg,
                                    arms.bending_stiffness_N_m2);
}

double sagging_moment_kg_s2(const CounterbalanceBeams& beams) {
  return beams.count * sagging_moment_kg_s2(beams.length_m, 0.0, beams.total_mass_kg / beams.count,
                                            beams.bending_stiffness_N_m2);
}

Mat3 across(const Vec3& axis) {
  const Vec3 a = axis.normalized();
  return Mat3::Identity() - a * a.transpose();
}

}  // namespace

Mat3 sag_compliance_s2(const DumbbellArms& arms, double platform_mass_kg) {
  return sagging_moment_kg_s2(arms) / platform_mass_kg * across(arms.axis_body);
}

Mat3 sag_compliance_s2(const CounterbalanceBeams& beams, double platform_mass_kg) {
  return sagging_moment_kg_s2(beams) / platform_mass_kg * across(Vec3::UnitZ());
}

double sag_torque_N_m(const DumbbellArms& arms, double tilt_rad, double gravity_m_s2) {
  return gravity_m_s2 * gravity_m_s2 * sagging_moment_kg_s2(arms) *
         (std::sin(tilt_rad) - 0.5 * std::sin(2.0 * tilt_rad));
}

double sag_torque_N_m(const CounterbalanceBeams& beams, double tilt_rad, double gravity_m_s2) {
  return gravity_m_s2 * gravity_m_s2 * sagging_moment_kg_s2(beams) * 0.5 * std::sin(2.0 * tilt_rad);
}

}  // namespace photorque
