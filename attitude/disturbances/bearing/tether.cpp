// A cable or hose that pulls the platform back to zero attitude, without hysteresis: T = −k r,
// where r is the rotation vector from zero attitude.
//
// r is the shortest rotation and changes its side at half a turn, as in the catalogue. With
// winds_up, whole turns n about body z are added, T = −k (r + 2π n z), so that the torque about z
// continues to increase; the part of r due to a tilt still changes its side. A run starts with less
// than half a turn. For a platform with one axis, r is the angle about it, always with whole turns.
#include <array>
#include <cmath>

#include "attitude/disturbances/kind.h"
#include "core/constants.h"

namespace photorque::kinds::tether {
namespace {

constexpr ScalarKey stiffness(
    "stiffness_N_m_per_rad", Range::not_negative(),
    "k in T = −k φ; φ is the smallest rotation to zero attitude and jumps at half a turn");

constexpr ScalarKey pull("pull_N_m", 0.0, {},
                         "torque at zero attitude, about the axis of a one-axis platform or "
                         "about body z; it vanishes at the angle pull/k",
                         stiffness.end());

namespace key {
constexpr FlagKey winds_up(
    "winds_up", false,
    "true: whole turns about body z count, φ + 2π n z; about one axis they always do");
}  // namespace key
// The angle about body z since the start, or the angle about the only axis. It only determines the
// number of whole turns, so its accuracy is not important.
constexpr StateKey twist{"tether_twist_rad"};

// Derivative of the twist angle t about body z in attitude = swing · twist, tan(t/2) = q_z/q_w.
template <class T>
T twist_rate(const QuatOf<T>& q, const Vec3Of<T>& rate) {
  // Upside down, this angle is undefined.
  const T cosine = q.w() * q.w() + q.z() * q.z() + 1e-9;
  return rate[2] +
         ((q.x() * q.z() - q.w() * q.y()) * rate[0] + (q.w() * q.x() + q.y() * q.z()) * rate[1]) /
             cosine;
}

template <class T>
T nearest_whole(const T& x) {
  return from_values(x, [](double value) { return std::array{std::round(value), 0.0}; });
}

class Tether final : public TorqueLaw<Tether> {
 public:
  Tether(bool winds_up, bool about_one_axis)
      : winds_up_(winds_up), about_one_axis_(about_one_axis) {}

  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    const QuatOf<T>& q = now.attitude;
    if (about_one_axis_) {
      const Vec3Of<T> axis = now.platform.axis.template cast<T>();
      own.rate_of(twist) = axis.dot(now.rate_body_rad_s);
      const T angle = whole_turns(own, T(2.0 * atan2(T(axis.dot(q.vec())), T(q.w()))));
      return (own[pull] - own[stiffness] * angle) * axis;
    }
    // q and −q are one attitude; w ≥ 0 selects the shorter rotation.
    const T side = where_at_least(q.w(), 0.0, T(1.0), T(-1.0));
    const Vec3Of<T> v = side * q.vec();
    const T sine = length(v);
    Vec3Of<T> wound = (2.0 * atan2(sine, side * q.w()) / sine) * v;
    if (winds_up_) {
      own.rate_of(twist) = twist_rate(q, now.rate_body_rad_s);
      const T from_attitude = 2.0 * atan2(T(side * q.z()), T(side * q.w()));
      wound[2] += whole_turns(own, from_attitude) - from_attitude;
    }
    Vec3Of<T> torque = -own[stiffness] * wound;
    torque[2] += own[pull];
    return torque;
  }

 private:
  // The angle plus the whole turns that bring it nearest to the twist.
  template <class T>
  T whole_turns(const ParametersAndStates<T>& own, const T& angle) const {
    return angle + 2.0 * pi * nearest_whole(T((own.state(twist) - angle) / (2.0 * pi)));
  }

  bool winds_up_, about_one_axis_;
};

Disturbance read(const Settings& settings, const DisturbanceContext& context) {
  const bool about_one_axis = context.platform.turns_about_one_axis(),
             winds_up = settings.get(key::winds_up) || about_one_axis;
  Disturbance d = make_disturbance<Tether>(
      {parameters_of(settings, stiffness), parameters_of(settings, pull)}, Stage::torque,
      winds_up ? std::vector<ExtraState>{{.name = twist.name, .is_turned_angle = about_one_axis}}
               : std::vector<ExtraState>{},
      winds_up, about_one_axis);
  d.is_abrupt = !about_one_axis;
  return d;
}

std::vector<Parametrisation> of_experiment(const DisturbanceContext& context) {
  Parametrisation p{"a cable pulls the platform back to zero attitude",
                    {EffectKey::not_negative(stiffness.name, 1e-5)}};
  const bool about_one_axis = context.platform.turns_about_one_axis();
  if (about_one_axis) {
    p.explanation = "a spring or a twisted line pulls back in proportion to the angle";
  }
  p.keys.push_back(about_one_axis ? EffectKey::number(pull.name, 1e-6)
                                  : EffectKey::fixed_at(pull.name, 0.0));
  return {p};
}

}  // namespace

DisturbanceKind kind() {
  return {.name = "tether",
          .summary = "a cable pulls back to zero attitude",
          .read = read,
          .screening = {.of_experiment = of_experiment,
                        .widths = "`stiffness_N_m_per_rad` 1e-05 (≥ 0), about one axis also "
                                  "`pull_N_m` 1e-06; needs a bearing",
                        .needs = Requirement::bearing},
          .keys = {stiffness, pull, key::winds_up}};
}

}  // namespace photorque::kinds::tether
