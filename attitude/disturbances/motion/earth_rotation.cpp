// The lab rotates with the Earth: the inertial rate is ω + Ω_B. Gyros measure it and rotors react
// to it. The Earth's rate in lab axes follows from the latitude of the environment. In body axes
// Ω_B changes by −ω × Ω_B. Euler's equations for the inertial rate, written for ω, therefore have
// the additional torque
//   T = I (ω × Ω) − Ω × I ω − (ω + Ω) × I Ω.
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::earth_rotation {
namespace {

struct EarthRotation final : LawOf<EarthRotation> {
  template <class T>
  void apply(const ParametersAndStates<T>&, EvaluationContext<T>& now) const {
    const Vec3Of<T>& w = now.rate_body_rad_s;
    const Mat3Of<T>& inertia = now.inertia_kg_m2;
    const Vec3Of<T> earth = now.to_body(now.environment.earth_rate_lab_rad_s.template cast<T>());
    const Vec3Of<T> turned = w.cross(earth), sum = w + earth;
    const Vec3Of<T> own_momentum = inertia * w, carried = inertia * earth;
    now.torque_body_N_m += inertia * turned - earth.cross(own_momentum) - sum.cross(carried);
    now.inertial_rate_body_rad_s += earth;
  }
};

}  // namespace

DisturbanceKind kind() {
  return kind_of_law<EarthRotation, Stage::mass>(
      {.name = "earth_rotation",
       .summary = "the laboratory itself turns once a day",
       .screening = {.parametrisations =
                         {{"the rotation of the Earth acts on the platform and on the gyro", {}}},
                     .needs = Requirement::turning_laboratory},
       .sets = "the rotation of the laboratory"});
}

}  // namespace photorque::kinds::earth_rotation
