// Eddy currents in a conductor that turns in the ambient field: T = k (ω × B_B) × B_B. Valid if the
// field changes slowly in the conductor (skin depth ≫ thickness), which is always true at these
// rates.
// Source: G. L. Smith, A theoretical study of the torques induced by a magnetic field on rotating
// cylinders and spinning thin-wall cones, cone frustums, and general body of revolution, NASA TR
// R-129 (1962).
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::eddy_damping {
namespace {

constexpr ScalarKey damping("coefficient_N_m_s_per_T2", Range::not_negative(),
                            "k in T = k (ω × B) × B; a thin shell has (2π/3) σ R⁴ δ");

struct EddyDamping final : TorqueLaw<EddyDamping> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    const Vec3Of<T>& B_T = now.magnetic_field_body_T;
    const Vec3Of<T> swept = now.rate_body_rad_s.cross(B_T);
    return own[damping] * swept.cross(B_T);
  }
};

}  // namespace

DisturbanceKind kind() {
  return kind_of_law<EddyDamping, Stage::torque, damping>(
      {.name = "eddy_damping",
       .summary = "eddy currents brake a rotation across the ambient field",
       .screening = {
           .parametrisations = {{"eddy currents brake rotation across the ambient magnetic field",
                                 {EffectKey::not_negative(damping.name, 2e4)}}},
           .needs = Requirement::field}});
}

}  // namespace photorque::kinds::eddy_damping
