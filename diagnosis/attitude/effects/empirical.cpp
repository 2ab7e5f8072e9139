#include "diagnosis/attitude/effects/empirical.h"

#include "core/constants.h"

namespace photorque {
namespace {

// All coefficients of a law are numbers of one key.
constexpr const char* coefficient = "coefficient";

constexpr ScalarKey numbered(int index) {
  return {coefficient, index};
}
constexpr VectorKey vector_from(int first) {
  return {coefficient, first};
}

// sin and cos of `order` times the heading, about the vertical.
class HeadingHarmonic final : public TorqueLaw<HeadingHarmonic> {
 public:
  explicit HeadingHarmonic(int order) : order_(order) {}

  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    const T x = now.lab_from_body(0, 0), y = now.lab_from_body(1, 0);
    const T size = sqrt(x * x + y * y + T(1e-30));
    const T c1 = x / size, s1 = y / size;
    T c = c1, s = s1;
    for (int k = 1; k < order_; ++k) {
      const T next = c * c1 - s * s1;
      s = s * c1 + c * s1;
      c = next;
    }
    const T size_N_m = own[of_cosine] * c + own[of_sine] * s;
    return size_N_m * now.lab_from_body.row(2).transpose();
  }

 private:
  static constexpr ScalarKey of_cosine = numbered(0), of_sine = numbered(1);
  int order_;
};

// Powers of the tilt: along the axis about which the platform leans (it rights or topples) and
// about the vertical.
class TiltPower final : public TorqueLaw<TiltPower> {
 public:
  explicit TiltPower(int power) : power_(power) {}

  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    const Vec3Of<T> up = now.lab_from_body.row(2).transpose();
    // z × up: as long as the sine of the tilt.
    const Vec3Of<T> lean(-up[1] / tilt_unit, up[0] / tilt_unit, T(0.0));
    const T square = lean[0] * lean[0] + lean[1] * lean[1];
    T factor = power_ % 2 == 1 ? T(1.0) : sqrt(square + T(1e-12));
    for (int k = 0; k < (power_ - 1) / 2; ++k) factor = factor * square;
    const T righting = own[along_lean] * factor;
    const T turning = own[about_vertical] * factor * sqrt(square + T(1e-12));
    return righting * lean + turning * up;
  }

 private:
  static constexpr ScalarKey along_lean = numbered(0), about_vertical = numbered(1);
  static constexpr double tilt_unit = 0.1;  // coefficients are torques at this tilt
  int power_;
};

// A drag along the rate with any power, and one that differs from axis to axis.
class RatePower final : public TorqueLaw<RatePower> {
 public:
  explicit RatePower(double power) : power_(power) {}

  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    const Vec3Of<T> w = now.rate_body_rad_s / T(rate_unit_rad_s);
    const T factor = pow(length(w) + T(1e-3), power_ - 1.0);
    const Vec3Of<T> shaped = factor * w;
    return -own[vector_from(0)].cwiseProduct(shaped);
  }

 private:
  static constexpr double rate_unit_rad_s = 0.1;
  double power_;
};

// Cosines in time over the run, for each axis of the body.
class TimeCosines final : public TorqueLaw<TimeCosines> {
 public:
  TimeCosines(double duration_s, int first, int count)
      : angular_frequency_(pi / duration_s), first_(first), count_(count) {}

  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    Vec3Of<T> sum = Vec3Of<T>::Constant(T(0.0));
    for (int j = 0; j < count_; ++j) {
      const T bounce = cos(now.time_s * T(angular_frequency_ * (first_ + j)));
      sum += bounce * own[vector_from(3 * j)];
    }
    return sum;
  }

 private:
  double angular_frequency_;
  int first_, count_;
};

// A torque about the vertical or in body axes that fades or grows like exp(−t/τ).
class TimeDecay final : public TorqueLaw<TimeDecay> {
 public:
  explicit TimeDecay(double time_constant_s) : rate_1_s_(1.0 / time_constant_s) {}

  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    const T fade = exp(-now.time_s * T(rate_1_s_));
    const T vertical = fade * own[about_vertical];
    return fade * own[fixed_to_body] + vertical * now.lab_from_body.row(2).transpose();
  }

 private:
  static constexpr VectorKey fixed_to_body = vector_from(0);
  static constexpr ScalarKey about_vertical = numbered(fixed_to_body.end());
  double rate_1_s_;
};

// Powers of the charge drawn, in body axes.
class ChargePower final : public TorqueLaw<ChargePower> {
 public:
  ChargePower(double charge_C, int power) : charge_C_(charge_C), power_(power) {}

  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    T factor = T(1.0);
    const T fraction = now.charge_drawn_C / T(charge_C_);
    for (int k = 0; k < power_; ++k) factor = factor * fraction;
    return factor * own[vector_from(0)];
  }

 private:
  double charge_C_;
  int power_;
};

// What the actuators give beyond the command and its multiples: its square, and cross talk.
class CommandMatrix final : public TorqueLaw<CommandMatrix> {
  static constexpr ScalarKey of_square = numbered(6);

 public:
  // The other six are the matrix but for its diagonal, row by row.
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    const Vec3Of<T>& c = now.command_body_N_m;
    const Vec3Of<T> across(own[numbered(0)] * c[1] + own[numbered(1)] * c[2],
                           own[numbered(2)] * c[0] + own[numbered(3)] * c[2],
                           own[numbered(4)] * c[0] + own[numbered(5)] * c[1]);
    const T size = length(c) / T(1e-4);
    const Vec3Of<T> squared = size * c;
    return across + own[of_square] * squared;
  }
};

template <class LawType, class... Arguments>
EmpiricalLaw law(const std::string& variable, const std::string& description, size_t coefficients,
                 double scale, Arguments&&... arguments) {
  const std::vector<double> zeros(coefficients, 0.0);
  EmpiricalLaw result{
      variable, description,
      make_disturbance<LawType>({fixed_parameter(coefficient, zeros)}, Stage::torque, {},
                                std::forward<Arguments>(arguments)...),
      scale};
  result.disturbance.kind = "empirical_" + variable;
  return result;
}

}  // namespace

std::vector<EmpiricalLaw> empirical_laws(double duration_s, double charge_C, bool has_commands,
                                         double torque_N_m) {
  std::vector<EmpiricalLaw> all;
  for (int order = 1; order <= 8; ++order) {
    all.push_back(law<HeadingHarmonic>("heading", std::to_string(order) + " periods a turn", 2,
                                       torque_N_m, order));
  }
  for (int power = 2; power <= 5; ++power) {
    all.push_back(law<TiltPower>("tilt", "power " + std::to_string(power), 2, torque_N_m, power));
  }
  for (const double power : {1.0, 2.0, 3.0, 4.0}) {
    all.push_back(law<RatePower>("rate", "power " + std::to_string(static_cast<int>(power)), 3,
                                 torque_N_m, power));
  }
  all.push_back(law<TimeCosines>("time", "slow", 9, torque_N_m, duration_s, 1, 3));
  all.push_back(law<TimeCosines>("time", "faster", 24, torque_N_m, duration_s, 1, 8));
  for (const double fraction : {0.1, 0.3, 1.0}) {
    all.push_back(law<TimeDecay>("time", "fading", 4, torque_N_m, fraction * duration_s));
  }
  if (charge_C > 0.0) {
    all.push_back(law<ChargePower>("charge", "linear", 3, torque_N_m, charge_C, 1));
    all.push_back(law<ChargePower>("charge", "square", 3, torque_N_m, charge_C, 2));
  }
  if (has_commands) all.push_back(law<CommandMatrix>("command", "cross talk", 7, 0.2));
  return all;
}

}  // namespace photorque
