#include "diagnosis/light/effects/kind.h"

#include <algorithm>
#include <cmath>

namespace photorque {

double value_of(const EffectParameter& parameter, double x) {
  switch (parameter.form) {
    case EffectParameter::Form::reciprocal:
      return x != 0.0 ? 1.0 / x : std::numeric_limits<double>::infinity();
    case EffectParameter::Form::root:
      return parameter.neutral + std::sqrt(std::max(0.0, x));
    case EffectParameter::Form::tangent:
      return std::atan(x);
    case EffectParameter::Form::offset:
      break;
  }
  return parameter.neutral + x;
}

double slope_of(const EffectParameter& parameter, double x) {
  switch (parameter.form) {
    case EffectParameter::Form::reciprocal:
      return -1.0 / (x * x);
    case EffectParameter::Form::root:
      return 0.5 / std::sqrt(std::max(1e-300, x));
    case EffectParameter::Form::tangent:
      return 1.0 / (1.0 + x * x);
    case EffectParameter::Form::offset:
      break;
  }
  return 1.0;
}

double x_of(const EffectParameter& parameter, double value) {
  const double off = value - parameter.neutral;
  switch (parameter.form) {
    case EffectParameter::Form::reciprocal:
      return std::isinf(value) ? 0.0 : 1.0 / value;
    case EffectParameter::Form::root:
      return off * off;
    case EffectParameter::Form::tangent:
      return std::tan(value);
    case EffectParameter::Form::offset:
      break;
  }
  return off;
}

}  // namespace photorque
