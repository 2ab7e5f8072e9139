// Wheels with measured speeds: T = −J (Ω' + ω × Ω), where ω is the inertial rate. The inertia of
// the body includes the wheels at rest.
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::wheel_momentum {
namespace {

constexpr ScalarKey common_inertia(
    "inertia_kg_m2", Range::not_negative(),
    "J in T = −J (Ω′ + ω × Ω), Ω the measured speeds (`wheel_x_rad_s` … in the recording), about a "
    "wheel's own axis: one number for all, or three for those about body x, y and z");
constexpr VectorKey axis_inertia{common_inertia.name};

struct EqualWheels final : TorqueLaw<EqualWheels> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    const Vec3Of<T> by_inertia =
        now.wheel_rad_s2 + now.inertial_rate_body_rad_s.cross(now.wheel_rad_s);
    return -own[common_inertia] * by_inertia;
  }
};

struct OwnWheels final : TorqueLaw<OwnWheels> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    const Vec3Of<T> momentum = own[axis_inertia].cwiseProduct(now.wheel_rad_s),
                    change = own[axis_inertia].cwiseProduct(now.wheel_rad_s2);
    return momentum.cross(now.inertial_rate_body_rad_s) - change;
  }
};

}  // namespace

DisturbanceKind kind() {
  return {.name = "wheel_momentum",
          .summary = "wheels whose speed was measured exchange momentum with the body",
          .read = read_one_or_three<EqualWheels, OwnWheels, common_inertia>,
          .screening =
              {.parametrisations = {{"a wheel on board exchanges angular momentum with the body",
                                     {{.key = common_inertia.name,
                                       .start = {0.0},
                                       .scale = 1e-3,
                                       .lowest = 0.0,
                                       .times_inertia = true}}}},
               .needs = Requirement::wheel},
          .keys = {Key(common_inertia).one_or_several(3)}};
}

}  // namespace photorque::kinds::wheel_momentum
