// An appendage on a spring, or sloshing liquid: one mode with its own two states.
//
// axis[3] (body, any length), frequency_Hz and damping (fraction of critical) of the appendage with
// the body held, inertia_kg_m2 (J, about the axis; part of the platform's inertia). With φ its
// angle beside the body and σ its absolute rate about the axis a:
//   φ' = σ − a·ω,  σ' = −ω_n² φ − 2 ζ ω_n φ',  T = a J (ω_n² φ + 2 ζ ω_n φ') − ω × (J a σ)
// while J a aᵀ no longer follows the body's acceleration. Small φ: the inertia stays as it is.
#include "attitude/disturbances/kind.h"
#include "core/constants.h"

namespace photorque {
namespace {

struct FlexibleMode final : LawOf<FlexibleMode> {
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    const Vec3Of<T> direction = own.vector(0);
    const Vec3Of<T> axis = direction / length(direction);
    const T angular_frequency = 2.0 * pi * own.parameter(3);
    const T& damping = own.parameter(4);
    const T& inertia = own.parameter(5);
    const T angle = own.states[0], rate = own.states[1];

    const T angle_rate = rate - axis.dot(now.rate_body_rad_s);
    const T pull = angular_frequency * angular_frequency * angle +
                   2.0 * damping * angular_frequency * angle_rate;
    own.state_rates[0] = angle_rate;
    own.state_rates[1] = -pull;

    const Vec3Of<T> momentum = inertia * rate * axis;
    now.torque_body_N_m += inertia * pull * axis - now.rate_body_rad_s.cross(momentum);
    const Mat3Of<T> about_axis = axis * axis.transpose();
    now.detach_inertia(inertia * about_axis);
  }
};

Disturbance read(const Settings& settings, const DisturbanceContext& context) {
  const Parameters axis = vector_parameter(settings, "axis");
  const Vec3 direction(axis[0].value, axis[1].value, axis[2].value);
  if (!(direction.norm() > 0.0)) throw settings.error("axis", "a zero vector", "a direction");
  const Vec3 unit = direction.normalized();
  const double whole_kg_m2 = unit.dot(context.platform.inertia_kg_m2 * unit);
  const Range part_of_whole{0.0, whole_kg_m2, true, true};
  return make_disturbance<FlexibleMode>(
      {axis, scalar_parameter(settings, "frequency_Hz", Range::positive()),
       scalar_parameter(settings, "damping", Range::not_negative()),
       scalar_parameter(settings, "inertia_kg_m2", part_of_whole)},
      Stage::torque, {{.name = "angle_rad"}, {.name = "rate_rad_s", .per_body_rate = unit}});
}

}  // namespace

DisturbanceKind flexible_mode_kind() {
  return {"flexible_mode", "an appendage or liquid swings against the body", read};
}

}  // namespace photorque
