// A measured or fitted torque without a known law. It is a function of one or two variables of the
// motion, about stated axes, with free coefficients. The terms of two functions are multiplied.
// shape.cpp reads the function, keys.cpp declares its keys.
#include "attitude/disturbances/kind.h"
#include "attitude/disturbances/unknown/law.h"

namespace photorque {
namespace {

constexpr const char* kind_name = "empirical_torque";

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
             ? scalar_parameter(settings, ScalarKey(empirical_coefficients, first))
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
