// An appendage on a spring, or sloshing liquid: one mode with two states. With the angle φ of the
// appendage relative to the body, its absolute rate σ about the axis a and its inertia J, which is
// part of the platform's:
//   φ' = σ − a·ω,  σ' = −ω_n² φ − 2 ζ ω_n φ',  T = a J (ω_n² φ + 2 ζ ω_n φ') − ω × (J a σ)
// and J a aᵀ no longer follows the body's acceleration.
//
// An appendage that is not symmetric about its axis changes the inertia by φ J S, and the rotation
// drives it. To first order in φ
//   σ' += ½ ωᵀ S ω,  T −= ½ a J ωᵀ S ω + J φ' S ω.
#include "attitude/disturbances/kind.h"
#include "core/constants.h"

namespace photorque::kinds::flexible_mode {
namespace {

constexpr VectorKey direction("axis", "rotation axis of the mode, body axes, any length");
constexpr ScalarKey frequency("frequency_Hz", Range::positive(),
                              "natural frequency of the mode while the body is at rest",
                              direction.end());
constexpr ScalarKey damping("damping", Range::not_negative(),
                            "damping ratio of the mode (1: critical damping)", frequency.end());
constexpr ScalarKey inertia(
    "inertia_kg_m2", Range::positive(),
    "moment of inertia of the appendage about the axis; it is included in that of the platform",
    damping.end());
constexpr auto slope =
    KeyOf<6>(
        "inertia_slope",
        "change of the platform's inertia with the angle of the appendage, per radian and as a "
        "multiple of `inertia_kg_m2`: [xx, yy, zz, xy, xz, yz]",
        inertia.end())
        .optional();

namespace key {
constexpr NumberKey initial_angle(
    "initial_angle_deg", 0.0, {},
    "angle of the appendage relative to the body at the start of a run");
constexpr NumberKey initial_rate(
    "initial_rate_rad_s", {}, "absolute rate of the appendage about the axis at the start of a run",
    {.usually = "that of the body"});
}  // namespace key

constexpr StateKey angle{"angle_rad", 0};
constexpr StateKey rate{"rate_rad_s", 1};

template <bool changes_inertia>
struct FlexibleMode final : LawOf<FlexibleMode<changes_inertia>> {
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    const Vec3Of<T> along = own[direction];
    const Vec3Of<T> axis = along / length(along);
    const T angular_frequency = 2.0 * pi * own[frequency];
    const T& J = own[inertia];
    const T phi = own.state(angle), sigma = own.state(rate);
    const Vec3Of<T>& omega = now.rate_body_rad_s;

    const T phi_rate = sigma - axis.dot(omega);
    T pull = angular_frequency * angular_frequency * phi +
             2.0 * own[damping] * angular_frequency * phi_rate;
    Mat3Of<T> detached = J * (axis * axis.transpose());
    if constexpr (changes_inertia) {
      const Mat3Of<T> S = own[slope];
      const Vec3Of<T> S_omega = S * omega;
      pull -= 0.5 * omega.dot(S_omega);
      now.torque_body_N_m -= J * phi_rate * S_omega;
      detached -= J * phi * S;
    }
    own.rate_of(angle) = phi_rate;
    own.rate_of(rate) = -pull;
    now.torque_body_N_m += J * pull * axis - omega.cross(J * sigma * axis);
    now.detach_inertia(detached);
  }
};

Disturbance read(const Settings& settings, const DisturbanceContext& context) {
  const PlacedParameters axis = direction_parameter(settings, direction);
  const Vec3 unit = vector_at(axis.parameters, 0).normalized();
  const double whole_kg_m2 = unit.dot(context.platform.inertia_kg_m2 * unit);
  const bool has_own_rate = settings.has(key::initial_rate);
  const Range part_of_whole{0.0, whole_kg_m2, true, true};
  const PlacedParameters f = parameters_of(settings, frequency),
                         zeta = parameters_of(settings, damping),
                         J = parameters_of(settings, inertia.within(part_of_whole));
  const std::vector<ExtraState> states{
      {.name = angle.name,
       .initial = settings.get(key::initial_angle),
       .key = std::string(key::initial_angle)},
      {.name = rate.name,
       .initial = has_own_rate ? settings.get(key::initial_rate) : 0.0,
       .per_body_rate = has_own_rate ? Vec3(Vec3::Zero()) : unit,
       .key = std::string(key::initial_rate)}};
  if (!settings.has(slope.name)) {
    return make_disturbance<FlexibleMode<false>>({axis, f, zeta, J}, Stage::torque, states);
  }
  return make_disturbance<FlexibleMode<true>>({axis, f, zeta, J, parameters_of(settings, slope)},
                                              Stage::torque, states);
}

}  // namespace

DisturbanceKind kind() {
  return {.name = "flexible_mode",
          .summary = "an appendage or liquid swings against the body",
          .read = read,
          .screening = {.parametrisations =
                            {{"an appendage or a liquid swings against the body",
                              {{direction.name,
                                {0.0, 0.0, 1.0},
                                0.6,
                                -EffectKey::unbounded,
                                EffectKey::unbounded,
                                true},
                               EffectKey::shape(frequency.name, 0.5, 1.0, 1e-3, 100.0),
                               EffectKey::shape(damping.name, 0.02, 0.05, 0.0, 2.0),
                               {inertia.name, {0.01}, 0.05, 0.0, EffectKey::unbounded, true, true},
                               {slope.name, {0, 0, 0, 0, 0, 0}, 0.5, -2.0, 2.0, true}}}},
                        .scan = Scan::mode,
                        .fast = true},
          .keys = {direction, frequency, damping, Key(inertia).range_that_varies(), slope,
                   key::initial_angle, key::initial_rate}};
}

}  // namespace photorque::kinds::flexible_mode
