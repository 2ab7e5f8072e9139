// Three reaction wheels along the body axes under quaternion feedback.
//
// The wheels apply the body torque −k_p sgn(e_w) 2 e_v − k_d (ω − ω_t) that rotates the body to the
// target attitude, with e = target⁻¹ ⊗ attitude. The torque of each motor is limited, and a motor
// does not drive its wheel beyond its largest rate. The bearings have friction.
//
// Source of the feedback law: B. Wie, H. Weiss, A. Arapostathis, J. Guid. Control Dyn. 12 (1989)
// 375.
#include <array>

#include "attitude/disturbances/kind.h"

namespace photorque::kinds::wheel_control {
namespace {

constexpr ScalarKey gain_on_angle("gain_N_m_per_rad", Range::not_negative(),
                                  "controller gain: torque per attitude error");
constexpr ScalarKey gain_on_rate("gain_N_m_s", Range::not_negative(),
                                 "controller gain: torque per rate error", gain_on_angle.end());
constexpr ScalarKey viscous("viscous_N_m_s", 0.0, Range::not_negative(),
                            "viscous friction of a wheel", gain_on_rate.end());
constexpr ScalarKey dry("dry_N_m", 0.0, Range::not_negative(), "dry friction of a wheel",
                        viscous.end());

namespace key {
constexpr Vec3Key target_axis("target_axis", {0.0, 0.0, 1.0},
                              "rotation axis of the target attitude, any length");
constexpr NumberKey target_angle("target_angle_deg", 0.0, {}, "rotation angle about `target_axis`");
constexpr Vec3Key target_rate("target_rate_rad_s", {0.0, 0.0, 0.0},
                              "rate of the target, body axes");
constexpr NumberKey wheel_inertia("wheel_inertia_kg_m2", Range::positive(),
                                  "moment of inertia of each wheel; included in the inertia of the "
                                  "platform and below its smallest moment",
                                  {.varies = true});
constexpr NumberKey largest_torque("largest_torque_N_m", Range::positive(),
                                   "largest torque of the motor of a wheel");
constexpr NumberKey largest_rate("largest_rate_rad_s", Range::positive(),
                                 "largest rate of a wheel relative to the body");
}  // namespace key

// Absolute axial rate of each wheel.
constexpr std::array<StateKey, 3> wheel = {
    {{"wheel_x_rad_s", 0}, {"wheel_y_rad_s", 1}, {"wheel_z_rad_s", 2}}};

// x for |x| far below `limit`, ±limit far above. Smooth; at half the limit it is 1.5 % below x.
template <class T>
T saturated(const T& x, double limit) {
  const T u = x / limit, square = u * u;
  return x / sqrt(sqrt(1.0 + square * square));
}

// 1 while the wheel is below its largest rate, decreasing to 0 over the last per cent. `fraction`
// is its rate divided by the largest one, positive if the motor drives it further.
template <class T>
T headroom(const T& fraction) {
  // Limited, because the exponential would overflow; the result is 0 there.
  const T bounded = where_at_least(fraction, 1.2, T(1.2), fraction);
  return 1.0 / (1.0 + exp(1200.0 * (bounded - 0.995)));
}

struct WheelSettings {
  Quat lab_from_target = Quat::Identity();
  Vec3 target_rate_body_rad_s = Vec3::Zero();
  double wheel_inertia_kg_m2 = 0.0;
  double largest_torque_N_m = 0.0;
  double largest_rate_rad_s = 0.0;
};

class WheelControl final : public LawOf<WheelControl> {
 public:
  explicit WheelControl(const WheelSettings& settings) : settings_(settings) {}

  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    const double inertia = settings_.wheel_inertia_kg_m2;
    const Vec3Of<T> wanted_N_m = feedback(own, now);
    Vec3Of<T> momentum, on_wheel;
    for (int k = 0; k < 3; ++k) {
      const T& spin = own.state(wheel[size_t(k)]);
      const T relative = spin - now.rate_body_rad_s[k];
      const T fraction = relative / settings_.largest_rate_rad_s;
      const T motor = saturated(T(-wanted_N_m[k]), settings_.largest_torque_N_m);
      // A motor cannot speed up a wheel that is at its largest rate in that direction.
      const T forward = where_at_least(values(motor), 0.0, T(1.0), T(-1.0));
      on_wheel[k] = motor * headroom(T(fraction * forward)) - friction(own, relative);
      momentum[k] = inertia * spin;
      own.rate_of(wheel[size_t(k)]) = on_wheel[k] / inertia;
    }
    now.torque_body_N_m -= on_wheel + now.inertial_rate_body_rad_s.cross(momentum);
    now.detach_inertia(Mat3(inertia * Mat3::Identity()).template cast<T>());
  }

 private:
  template <class T>
  Vec3Of<T> feedback(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    const QuatOf<T> error = settings_.lab_from_target.conjugate().template cast<T>() * now.attitude;
    const T shortest = where_at_least(values(error.w()), 0.0, T(1.0), T(-1.0));
    const Vec3Of<T> off = now.rate_body_rad_s - settings_.target_rate_body_rad_s.template cast<T>();
    return T(-2.0 * shortest * own[gain_on_angle]) * error.vec() - own[gain_on_rate] * off;
  }

  template <class T>
  T friction(const ParametersAndStates<T>& own, const T& relative) const {
    // Rate within which dry friction changes its sign, the creep of a wheel.
    constexpr double creep_rad_s = 0.1;
    return own[viscous] * relative +
           own[dry] * relative / sqrt(relative * relative + creep_rad_s * creep_rad_s);
  }

  WheelSettings settings_;
};

Disturbance read(const Settings& settings, const DisturbanceContext& context) {
  WheelSettings wheels;
  const double angle_rad = settings.get(key::target_angle);
  const Vec3 axis = direction_of(settings, key::target_axis);
  wheels.lab_from_target = Quat(Eigen::AngleAxisd(angle_rad, axis.normalized()));
  wheels.target_rate_body_rad_s = settings.get(key::target_rate);
  const double min_kg_m2 = context.platform.inertia_kg_m2.diagonal().minCoeff();
  wheels.wheel_inertia_kg_m2 =
      settings.get(key::wheel_inertia.within({0.0, min_kg_m2, true, true}));
  wheels.largest_torque_N_m = settings.get(key::largest_torque);
  wheels.largest_rate_rad_s = settings.get(key::largest_rate);
  std::vector<ExtraState> states;
  for (int k = 0; k < 3; ++k) {
    states.push_back({.name = wheel[size_t(k)].name,
                      .initial = 0.0,
                      .scale = wheels.largest_rate_rad_s,
                      .per_body_rate = Vec3::Unit(k)});
  }
  return make_disturbance<WheelControl>(
      {parameters_of(settings, gain_on_angle), parameters_of(settings, gain_on_rate),
       parameters_of(settings, viscous), parameters_of(settings, dry)},
      Stage::torque, std::move(states), wheels);
}

}  // namespace

DisturbanceKind kind() {
  return {
      .name = "wheel_control",
      .summary = "reaction wheels turn the platform to a target attitude",
      .read = read,
      .screening = {.reason_against = "a controller is known; its torque is in the commands"},
      .keys = {gain_on_angle, gain_on_rate, key::target_axis, key::target_angle, key::target_rate,
               key::wheel_inertia, key::largest_torque, key::largest_rate, viscous, dry}};
}

}  // namespace photorque::kinds::wheel_control
