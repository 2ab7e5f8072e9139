#include "scenes/effects/kind.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/numerics/root.h"
#include "core/settings/settings.h"
#include "core/text/format.h"
#include "photovoltaics/cell/front.h"

namespace photorque {
namespace {

using Numbers = std::span<const double>;

// Loss of light at 45° by Fresnel's law, in addition to the loss at normal incidence.
double slant_loss(double index) {
  CellFront front;
  front.index = index;
  constexpr double any_wavelength_m = 1e-6;
  return 1.0 - front.modifier(std::cos(0.25 * pi), any_wavelength_m);
}

constexpr double most_slanting = 2.0;

double index_of(double x) {
  const double loss = std::clamp(x, 0.0, 1.0) * slant_loss(most_slanting);
  const auto takes_less = [&](double index) { return slant_loss(index) < loss; };
  return bisect(1.0, most_slanting, takes_less, {50}).high;
}

}  // namespace

EffectParameter remaining_fraction(const std::string& meaning, double scale,
                                   const std::vector<double>& starts) {
  return {.key = "factor",
          .meaning = meaning,
          .neutral = 1.0,
          .scale = scale,
          .lowest = -1.0,
          .highest = 0.0,
          .starts = starts};
}

EffectParameter gain_factor(const std::string& meaning) {
  return {.key = "factor",
          .meaning = meaning,
          .neutral = 1.0,
          .scale = 0.1,
          .lowest = -0.95,
          .highest = 4.0};
}

EffectParameter from_zero(const std::string& key, const std::string& meaning, double scale,
                          double highest) {
  return {.key = key, .meaning = meaning, .scale = scale, .lowest = 0.0, .highest = highest};
}

LightEffectKind::Act multiplies(double LightState::*factor) {
  return [factor](LightState& state, size_t, Numbers x) { state.*factor *= 1.0 + x[0]; };
}

LightEffectKind::Act multiplies_one(std::vector<double> LightState::*factors) {
  return [factors](LightState& state, size_t index, Numbers x) {
    (state.*factors)[index] *= 1.0 + x[0];
  };
}

LightEffectKind::Act adds_to(double LightState::*term) {
  return [term](LightState& state, size_t, Numbers x) { state.*term += x[0]; };
}

double value_of(const EffectParameter& parameter, double x) {
  switch (parameter.form) {
    case EffectParameter::Form::reciprocal:
      return x != 0.0 ? 1.0 / x : std::numeric_limits<double>::infinity();
    case EffectParameter::Form::slant:
      return index_of(x);
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
    case EffectParameter::Form::slant: {
      // The derivative is infinite at both ends: use a finite difference.
      constexpr double step = 0.02;
      const double low = std::clamp(x - step, 0.0, 1.0 - 2.0 * step), high = low + 2.0 * step;
      return (index_of(high) - index_of(low)) / (high - low);
    }
    case EffectParameter::Form::tangent:
      return 1.0 / (1.0 + x * x);
    case EffectParameter::Form::offset:
      break;
  }
  return 1.0;
}

double x_of(const EffectParameter& parameter, double value) {
  switch (parameter.form) {
    case EffectParameter::Form::reciprocal:
      return std::isinf(value) ? 0.0 : 1.0 / value;
    case EffectParameter::Form::slant:
      return slant_loss(value) / slant_loss(most_slanting);
    case EffectParameter::Form::tangent:
      return std::tan(value);
    case EffectParameter::Form::offset:
      break;
  }
  return value - parameter.neutral;
}

std::string range_of(const EffectParameter& parameter) {
  const auto end_of = [&](double x) {
    return std::isinf(x) ? x : value_of(parameter, x) / unit_of_key(parameter.key).to_SI;
  };
  const auto [low, high] = std::minmax({end_of(parameter.lowest), end_of(parameter.highest)});
  const auto shown = [](double end) { return printed("%.3g", end); };
  if (std::isinf(low) && std::isinf(high)) return "";
  if (std::isinf(high)) return "at least " + shown(low);
  if (std::isinf(low)) return "at most " + shown(high);
  return "from " + shown(low) + " to " + shown(high);
}

std::vector<LightEffectKind> all_light_effect_kinds() {
  std::vector<LightEffectKind> all = lamp_effect_kinds();
  for (const auto& family : {surroundings_effect_kinds(), array_effect_kinds()}) {
    all.insert(all.end(), family.begin(), family.end());
  }
  return all;
}

}  // namespace photorque
