// A wheel whose mass is not balanced about its axis: with its speed Ω and its angle Φ = ∫ Ω dt,
//   F = U_s Ω² e(Φ + φ_s),  T = r × F + U_d Ω² e(Φ + φ_d),
// where e(φ) = x' cos φ + y' sin φ turns in the plane of the wheel: x' is the projection of body x
// (of body y for an axis within 30 deg of x) onto that plane and y' = axis × x'. On a platform that
// slides, F acts too.
// Source: R. A. Masterson, D. W. Miller, R. L. Grogan, J. Sound Vib. 249 (2002) 575, the first
// harmonic. Left out: harmonics of the bearings, modes of the wheel, and U Ω′ of a change of speed.
#include <array>

#include "attitude/disturbances/kind.h"

namespace photorque::kinds::wheel_imbalance {
namespace {

constexpr VectorKey direction("axis", "axis of the wheel, body axes, any length");
constexpr ScalarKey static_imbalance("static_imbalance_g_cm", 0.0, Range::not_negative(),
                                     "mass of the wheel times its offset from the axis",
                                     direction.end());
constexpr ScalarKey dynamic_imbalance("dynamic_imbalance_g_cm2", 0.0, Range::not_negative(),
                                      "product of inertia of the wheel about its axis",
                                      static_imbalance.end());
constexpr ScalarKey static_phase("static_phase_deg", 0.0, {},
                                 "angle of the offset at t = 0 in the plane of the wheel, from the "
                                 "projection of body x (of body y for an axis near x)",
                                 dynamic_imbalance.end());
constexpr ScalarKey dynamic_phase("dynamic_phase_deg", 0.0, {},
                                  "angle of the torque of `dynamic_imbalance_g_cm2`, likewise",
                                  static_phase.end());
constexpr auto position =
    VectorKey("position_m",
              "centre of the wheel from the centre of rotation, body axes; with "
              "`static_imbalance_g_cm`",
              dynamic_phase.end())
        .optional();
// At higher speeds the phase would lose its digits within a day.
constexpr Range largest_rate{-1e6, 1e6};
constexpr auto speed = ScalarKey("speed_rad_s", largest_rate,
                                 "speed of the wheel relative to the body; without it, that of "
                                 "`wheel_x_rad_s` … in the commands or the recording",
                                 position.end())
                           .optional();
constexpr StateKey angle{"wheel_angle_rad", 0};

template <bool is_constant>
class WheelImbalance final : public LawOf<WheelImbalance<is_constant>> {
 public:
  explicit WheelImbalance(const Vec3& reference) : reference_(reference) {}

  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    const Vec3Of<T> along = own[direction], reference = reference_.template cast<T>();
    const Vec3Of<T> axis = along / length(along);
    const Vec3Of<T> in_plane = reference - reference.dot(axis) * axis;
    const Vec3Of<T> across = in_plane / length(in_plane), aside = axis.cross(across);
    T rate, turned;
    if constexpr (is_constant) {
      rate = own[speed];
      turned = rate * now.time_s;
    } else {
      rate = axis.dot(now.wheel_rad_s);
      turned = own.state(angle);
      own.rate_of(angle) = rate;
    }
    const auto towards = [&](const T& phase) -> Vec3Of<T> {
      return cos(turned + phase) * across + sin(turned + phase) * aside;
    };
    const T square = rate * rate;
    const Vec3Of<T> force_N = own[static_imbalance] * square * towards(own[static_phase]);
    const Vec3Of<T> place_m = own[position];
    now.torque_body_N_m +=
        place_m.cross(force_N) + own[dynamic_imbalance] * square * towards(own[dynamic_phase]);
    now.force_lab_N += now.lab_from_body * force_N;
  }

 private:
  Vec3 reference_;
};

Disturbance read(const Settings& settings, const DisturbanceContext&) {
  const PlacedParameters axis = direction_parameter(settings, direction);
  if (!settings.has(static_imbalance.name) && !settings.has(dynamic_imbalance.name)) {
    throw settings.error(static_imbalance.name, "nothing",
                         "this key, dynamic_imbalance_g_cm2 or both");
  }
  if (settings.has(static_imbalance.name) && !settings.has(position.name)) {
    throw settings.error(position.name, "nothing", "the place of the wheel");
  }
  constexpr std::array<double, 3> centre{};
  const PlacedParameters at_m = settings.has(position.name)
                                    ? parameters_of(settings, position)
                                    : fixed_parameter(position.name, centre, position.first);
  const PlacedParameters u_s = parameters_of(settings, static_imbalance),
                         u_d = parameters_of(settings, dynamic_imbalance),
                         phi_s = parameters_of(settings, static_phase),
                         phi_d = parameters_of(settings, dynamic_phase);
  constexpr double cosine_of_30_deg = 0.8660254037844386;
  const bool is_along_x =
      std::abs(vector_at(axis.parameters, 0).normalized().x()) > cosine_of_30_deg;
  const Vec3 reference = is_along_x ? Vec3::UnitY() : Vec3::UnitX();
  if (settings.has(speed.name)) {
    return make_disturbance<WheelImbalance<true>>(
        {axis, u_s, u_d, phi_s, phi_d, at_m, parameters_of(settings, speed)}, Stage::torque, {},
        reference);
  }
  return make_disturbance<WheelImbalance<false>>({axis, u_s, u_d, phi_s, phi_d, at_m},
                                                 Stage::torque, {{.name = angle.name}}, reference);
}

}  // namespace

DisturbanceKind kind() {
  return {.name = "wheel_imbalance",
          .summary = "a wheel that is not balanced shakes the platform at its speed",
          .read = read,
          .screening = {.reason_against = "its torque turns with the wheel, whose phase is unknown",
                        .needs = Requirement::wheel},
          .keys = {direction, static_imbalance, position, dynamic_imbalance, speed, static_phase,
                   dynamic_phase}};
}

}  // namespace photorque::kinds::wheel_imbalance
