// The battery current: the load minus the power of the solar array, at the battery's voltage. The
// power of the array is multiplied by the illumination. If a recording or a file of commands has
// the battery current, it is the only current.
//
// If the battery's capacity is known, a controller reduces the current exponentially within about
// the last per cent: a full battery is not charged, an empty one not discharged.
#include <cmath>

#include "attitude/disturbances/kind.h"
#include "core/constants.h"

namespace photorque::kinds::power_balance {
namespace {

constexpr ScalarKey load(
    "load_W", Range::not_negative(),
    "power drawn: the battery current is (load − array)/`platform.battery_voltage_V`, tapered when "
    "full or empty; without effect where a recording has the current");

namespace key {
constexpr NumberKey array_power(
    "array_power_W", 0.0, Range::not_negative(),
    "power of the array at zero tilt; proportional to the cosine of the tilt; *or*");
constexpr NumbersKey tilt(
    "tilt_deg", {0.0, pi, false, false},
    "tilts of a table, rising; the last value holds beyond its end; with `power_W`",
    {.optional = true});
constexpr NumbersKey power("power_W", Range::not_negative(),
                           "power of the array at each tilt of the table", {.optional = true});
}  // namespace key
constexpr ScalarKey array_scale("array_scale", 1.0, Range::not_negative(),
                                "factor on the power of the array", load.end());

// A monotone cubic through points (F. N. Fritsch, J. Butland, SIAM J. Sci. Stat. Comput. 5 (1984)
// 300). It is smooth, and has no maximum between points.
class MonotoneCurve {
 public:
  MonotoneCurve(std::vector<double> x, std::vector<double> y)
      : x_(std::move(x)), y_(std::move(y)), slope_(x_.size(), 0.0) {
    const auto secant = [this](size_t i) { return (y_[i + 1] - y_[i]) / (x_[i + 1] - x_[i]); };
    for (size_t i = 1; i + 1 < x_.size(); ++i) {
      const double before = secant(i - 1), after = secant(i);
      if (before * after <= 0.0) continue;
      const double part =
          (x_[i + 1] - x_[i] + (x_[i + 1] - x_[i - 1])) / (3.0 * (x_[i + 1] - x_[i - 1]));
      slope_[i] = before * after / (part * after + (1.0 - part) * before);
    }
    if (x_.size() > 1) {
      slope_.front() = secant(0);
      slope_.back() = secant(x_.size() - 2);
    }
  }

  // Value and slope; constant beyond the last point.
  std::array<double, 2> at(double x) const {
    if (x >= x_.back() || x_.size() == 1) return {y_.back(), 0.0};
    const auto after = std::upper_bound(x_.begin() + 1, x_.end() - 1, x);
    const size_t i = static_cast<size_t>(after - x_.begin()) - 1;
    const double h = x_[i + 1] - x_[i], u = (x - x_[i]) / h, v = 1.0 - u;
    const double value = v * v * (1 + 2 * u) * y_[i] + u * u * (1 + 2 * v) * y_[i + 1] +
                         h * u * v * (v * slope_[i] - u * slope_[i + 1]);
    const double slope = 6 * u * v * (y_[i + 1] - y_[i]) / h + v * (1 - 3 * u) * slope_[i] +
                         u * (3 * u - 2) * slope_[i + 1];
    return {value, slope};
  }

 private:
  std::vector<double> x_, y_, slope_;
};

// sin²(tilt/2), which is smooth at zero tilt, where the tilt is not.
template <class T>
T half_tilt_sine_squared(const EvaluationContext<T>& now) {
  return now.attitude.x() * now.attitude.x() + now.attitude.y() * now.attitude.y();
}

class PowerBalance final : public LawOf<PowerBalance> {
 public:
  explicit PowerBalance(MonotoneCurve power_W) : power_W_(std::move(power_W)) {}

  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    const T at_tilt_W =
        from_values(half_tilt_sine_squared(now), [this](double x) { return power_W_.at(x); });
    now.array_power_W += own[array_scale] * now.illumination * at_tilt_W;
    if (now.current_is_measured) return;
    T current_A = (own[load] - now.array_power_W) / now.platform.battery_voltage_V;
    if (now.platform.battery_capacity_C) {
      current_A *= controller(now.charge_drawn_C, current_A, *now.platform.battery_capacity_C);
    }
    now.battery_current_A += current_A;
  }

 private:
  // Fraction of the current that flows: 1 − exp(−room/δ), where room is the charge that can still
  // flow.
  template <class T>
  static T controller(const T& drawn_C, const T& current_A, double capacity_C) {
    const T room_C = where_at_least(values(current_A), 0.0, T(capacity_C - drawn_C), drawn_C);
    const T bounded_C = where_at_least(values(room_C), 0.0, room_C, T(0.0));
    return 1.0 - exp(-bounded_C / (taper_fraction * capacity_C));
  }

  static constexpr double taper_fraction = 0.002;

  MonotoneCurve power_W_;
};

MonotoneCurve read_curve(const Settings& settings) {
  if (!settings.has(key::tilt)) {
    // cos(tilt) = 1 − 2 sin²(tilt/2): a straight line down to zero at 90 deg.
    const double power_W = settings.get(key::array_power);
    return {{0.0, 0.5}, {power_W, 0.0}};
  }
  const std::vector<double> tilt_rad = settings.get(key::tilt);
  const std::vector<double> power_W = settings.get(key::power);
  if (tilt_rad.empty() || power_W.size() != tilt_rad.size()) {
    throw settings.error(key::power, std::to_string(power_W.size()) + " numbers",
                         std::to_string(tilt_rad.size()) + ", one for each tilt");
  }
  std::vector<double> x;
  for (const double tilt : tilt_rad) {
    x.push_back(std::pow(std::sin(tilt / 2), 2));
    if (x.size() > 1 && !(x.back() > x[x.size() - 2])) {
      throw settings.error(key::tilt, "tilts out of order", "rising tilts");
    }
  }
  return {x, power_W};
}

Disturbance read(const Settings& settings, const DisturbanceContext&) {
  return make_disturbance<PowerBalance>(
      {parameters_of(settings, load), parameters_of(settings, array_scale)}, Stage::torque, {},
      read_curve(settings));
}

}  // namespace

DisturbanceKind kind() {
  return {.name = "power_balance",
          .summary = "the battery supplies the part of the load that the array does not deliver",
          .read = read,
          .screening =
              {.reason_against =
                   "acts on the battery; it affects the motion only through battery_discharge"},
          .sets = "the battery's current",
          .keys = {load, key::array_power, key::tilt, key::power, array_scale}};
}

}  // namespace photorque::kinds::power_balance
