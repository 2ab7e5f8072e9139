// A measured or fitted torque without a known law. It is a function of one or two variables of the
// motion, about stated axes, with free coefficients. The terms of two functions are multiplied.
// shape.cpp declares and reads the keys of the function.
#include <algorithm>
#include <cmath>

#include "attitude/disturbances/kind.h"
#include "attitude/disturbances/unknown/shape.h"
#include "core/constants.h"

namespace photorque {
namespace {

constexpr const char* kind_name = "empirical_torque";

class EmpiricalTorqueLaw final : public TorqueLaw<EmpiricalTorqueLaw> {
 public:
  explicit EmpiricalTorqueLaw(EmpiricalShape shape)
      : shape_(std::move(shape)), components_(static_cast<int>(shape_.components())) {}

  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    std::array<T, most_components> size;
    size.fill(T(0.0));
    const T* coefficients = own.parameters + shape_.first_coefficient();
    const MotionFunction& first = shape_.functions.front();
    const auto add = [&](int term, const T& value) {
      for (int c = 0; c < components_; ++c) {
        size[static_cast<size_t>(c)] += value * coefficients[term * components_ + c];
      }
    };
    if (shape_.functions.size() == 1) {
      each_term(first, own.parameters, now, add);
    } else {
      const MotionFunction& second = shape_.functions[1];
      const T* of_second = own.parameters + (first.own_key().empty() ? 0 : 1);
      const auto count = static_cast<int>(second.terms());
      each_term(first, own.parameters, now, [&](int i, const T& a) {
        each_term(second, of_second, now, [&](int j, const T& b) { add(i * count + j, a * b); });
      });
    }
    return along_axes(size, now);
  }

  // The cubics of a table over time meet at its knots, where their second derivative jumps. Steps
  // that end at the knots contain only polynomials and can be several times as long.
  std::vector<Switch> switches(std::span<const Parameter>) const override {
    std::vector<double> knots_s;
    for (const MotionFunction& f : shape_.functions) {
      if (f.of != MotionVariable::time || f.form != FunctionForm::table) continue;
      knots_s.insert(knots_s.end(), f.table.knots().begin(), f.table.knots().end());
    }
    return switches_at(knots_s);
  }

 private:
  static constexpr size_t most_components = 24;
  // Below these values, a torque along a direction decreases smoothly to zero: tilt in radians,
  // rate in rad/s, command in newton metres.
  static constexpr double least_tilt = 1e-6, least_rate = 1e-5, least_command = 1e-9;

  template <class T>
  static T sine_of_tilt(const EvaluationContext<T>& now) {
    const T x = now.lab_from_body(2, 0), y = now.lab_from_body(2, 1);
    return sqrt(x * x + y * y + T(least_tilt * least_tilt));
  }
  template <class T>
  static T size_of(const Vec3Of<T>& v, double least) {
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + T(least * least));
  }

  // The value of a variable. Not for the yaw, whose angle jumps at a whole turn.
  template <class T>
  static T value_of(const MotionFunction& f, const EvaluationContext<T>& now) {
    T x = now.time_s;
    if (f.of == MotionVariable::tilt) x = atan2(sine_of_tilt(now), T(now.lab_from_body(2, 2)));
    if (f.of == MotionVariable::rate) x = size_of(now.rate_body_rad_s, least_rate);
    if (f.of == MotionVariable::charge) x = now.charge_drawn_C;
    if (f.of == MotionVariable::command) x = size_of(now.command_body_N_m, least_command);
    return f.range ? held_within(x, *f.range) : x;
  }

  // The variable within its range. Beyond an end it continues by at most a twentieth of the range's
  // width, with a slope that decreases from 1 to 0.
  template <class T>
  static T held_within(const T& x, const std::array<double, 2>& range) {
    const double margin = 0.05 * (range[1] - range[0]);
    return from_values(x, [&](double a) {
      const double end = a > range[1] ? range[1] : range[0];
      const double beyond = a > range[1] ? a - range[1] : range[0] - a;
      if (!(beyond > 0.0)) return std::array{a, 1.0};
      const double slope = std::exp(-beyond / margin), moved = margin * (1.0 - slope);
      return std::array{a > range[1] ? end + moved : end - moved, slope};
    });
  }

  template <class T, class Visit>
  static void each_term(const MotionFunction& f, const T* own, const EvaluationContext<T>& now,
                        const Visit& visit) {
    switch (f.form) {
      case FunctionForm::harmonics:
        return each_harmonic(f, own, now, visit);
      case FunctionForm::power:
        return visit(0, exp(own[0] * log(value_of(f, now) / f.reference)));
      case FunctionForm::powers:
        return each_power(f, now, visit);
      case FunctionForm::decay:
        return visit(0, exp(-value_of(f, now) / own[0]));
      case FunctionForm::cosines:
        return each_cosine(f, now, visit);
      case FunctionForm::table:
        return each_knot(f.table, value_of(f, now), visit);
    }
  }

  template <class T, class Visit>
  static void each_harmonic(const MotionFunction& f, const T* own, const EvaluationContext<T>& now,
                            const Visit& visit) {
    T c1, s1;
    if (f.of == MotionVariable::yaw) {
      const T x = now.lab_from_body(0, 0), y = now.lab_from_body(1, 0);
      const T size = sqrt(x * x + y * y + T(1e-30));
      c1 = x / size;
      s1 = y / size;
    } else {
      const T angle = 2.0 * pi * value_of(f, now) / own[0];
      c1 = cos(angle);
      s1 = sin(angle);
    }
    T c = T(1.0), s = T(0.0);
    int order = 0, term = 0;
    for (const int wanted : f.orders) {
      for (; order < wanted; ++order) {
        const T next = c * c1 - s * s1;
        s = s * c1 + c * s1;
        c = next;
      }
      visit(term++, c);
      if (wanted > 0) visit(term++, s);  // sin(0) is zero
    }
  }

  template <class T, class Visit>
  static void each_power(const MotionFunction& f, const EvaluationContext<T>& now,
                         const Visit& visit) {
    const T x = value_of(f, now) / f.reference;
    T power = T(1.0);
    int order = 0, term = 0;
    for (const int wanted : f.orders) {
      for (; order < wanted; ++order) power = power * x;
      visit(term++, power);
    }
  }

  template <class T, class Visit>
  static void each_cosine(const MotionFunction& f, const EvaluationContext<T>& now,
                          const Visit& visit) {
    const T angle = pi / f.reference * value_of(f, now);
    int term = 0;
    for (const int order : f.orders) visit(term++, cos(static_cast<double>(order) * angle));
  }

  // Visits only the knots that have weight at one of the eight instants.
  template <class T, class Visit>
  static void each_knot(const SmoothTable& table, const T& x, const Visit& visit) {
    std::array<SmoothTable::Weights, Lanes::count> at;
    int first = static_cast<int>(table.knots().size()), last = 0;
    for (int lane = 0; lane < Lanes::count; ++lane) {
      at[static_cast<size_t>(lane)] = table.at(values(x)[lane]);
      first = std::min(first, at[static_cast<size_t>(lane)].first);
      last = std::max(last, at[static_cast<size_t>(lane)].first + 3);
    }
    for (int knot = first; knot <= last; ++knot) {
      Lanes value(0.0), slope(0.0);
      for (int lane = 0; lane < Lanes::count; ++lane) {
        const SmoothTable::Weights& w = at[static_cast<size_t>(lane)];
        const int k = knot - w.first;
        if (k < 0 || k > 3) continue;
        value.set(lane, w.value[static_cast<size_t>(k)]);
        slope.set(lane, w.slope[static_cast<size_t>(k)]);
      }
      visit(knot, chain(x, value, slope));
    }
  }

  template <class T>
  Vec3Of<T> along_axes(const std::array<T, most_components>& size,
                       const EvaluationContext<T>& now) const {
    Vec3Of<T> sum = Vec3Of<T>::Constant(T(0.0));
    const T* s = size.data();
    for (const TorqueAxes axes : shape_.axes) {
      sum += along(axes, s, now);
      s += components_of(axes);
    }
    return sum;
  }

  template <class T>
  static Vec3Of<T> along(TorqueAxes axes, const T* s, const EvaluationContext<T>& now) {
    const Vec3Of<T>& w = now.rate_body_rad_s;
    const Vec3Of<T>& c = now.command_body_N_m;
    const Vec3Of<T> up = now.lab_from_body.row(2).transpose();
    switch (axes) {
      case TorqueAxes::body:
        return {s[0], s[1], s[2]};
      case TorqueAxes::lab:
        return now.to_body({s[0], s[1], s[2]});
      case TorqueAxes::vertical:
        return s[0] * up;
      case TorqueAxes::lean: {
        const T size = s[0] / sine_of_tilt(now);
        return {-(up[1] * size), up[0] * size, T(0.0)};
      }
      case TorqueAxes::rate:
        return T(-s[0] / size_of(w, least_rate)) * w;
      case TorqueAxes::rate_by_axis: {
        const T size = size_of(w, least_rate);
        return {-(s[0] * w[0] / size), -(s[1] * w[1] / size), -(s[2] * w[2] / size)};
      }
      case TorqueAxes::command:
        return T(s[0] / size_of(c, least_command)) * c;
      case TorqueAxes::cross_talk: {
        const T size = size_of(c, least_command);
        return {(s[0] * c[1] + s[1] * c[2]) / size, (s[2] * c[0] + s[3] * c[2]) / size,
                (s[4] * c[0] + s[5] * c[1]) / size};
      }
    }
    return Vec3Of<T>::Constant(T(0.0));
  }

  EmpiricalShape shape_;
  int components_;
};

Disturbance read(const Settings& settings, const DisturbanceContext&) {
  const EmpiricalShape shape = read_shape(settings);
  Disturbance d = empirical_torque(shape);
  for (size_t p = 0; p < shape.first_coefficient(); ++p) {
    const Uncertain own = settings.uncertain(d.parameters[p].key, Range::positive());
    d.parameters[p].value = own.value;
    d.parameters[p].sigma = own.sigma;
  }
  d.parameters.resize(shape.first_coefficient());
  const int first = static_cast<int>(d.parameters.size());
  const bool is_one_number =
      shape.coefficients() == 1 && count_as_written(settings, empirical_coefficients) == 0;
  append(d.parameters,
         is_one_number
             ? parameters_of(settings, ScalarKey(empirical_coefficients, first))
             : array_parameter(settings, empirical_coefficients, shape.coefficients(), first));
  return d;
}

}  // namespace

Disturbance empirical_torque(const EmpiricalShape& shape) {
  Disturbance d = make_disturbance<EmpiricalTorqueLaw>({}, Stage::torque, {}, shape);
  d.kind = kind_name;
  for (const MotionFunction& f : shape.functions) {
    const std::string key = f.own_key();
    if (!key.empty()) d.parameters.push_back({key, -1, f.own, 0.0});
  }
  const std::vector<double> zeros(shape.coefficients(), 0.0);
  append(d.parameters,
         fixed_parameter(empirical_coefficients, zeros, static_cast<int>(d.parameters.size())));
  return d;
}

namespace kinds::empirical_torque {

DisturbanceKind kind() {
  return {.name = kind_name,
          .summary = "a fitted or measured torque without a known law",
          .read = read,
          .screening = {.reason_against = "diagnose fits it if no known law is sufficient"},
          .keys = empirical_shape_keys()};
}

}  // namespace kinds::empirical_torque

}  // namespace photorque
