#include "attitude/injection/injection.h"

#include <algorithm>

#include "core/errors.h"

namespace photorque {

const std::vector<double>& InjectedEffect::numbers(const std::string& key, size_t count) const {
  const auto found = parameters.find(key);
  if (found == parameters.end() || found->second.size() != count) {
    throw NumericalError("the injected " + kind + " has no " + std::to_string(count) +
                         " numbers for " + key);
  }
  return found->second;
}

Triple InjectedEffect::triple(const std::string& key) const {
  const std::vector<double>& three = numbers(key, 3);
  return {three[0], three[1], three[2]};
}

namespace injected {

DrawExample random_direction(const std::string& key, double size) {
  return [=](RandomDraw& draw, const ExampleConditions&) {
    return EffectNumbers{{key, list(times(size, draw.direction()))}};
  };
}

DrawExample fixed_size(const std::string& key, double size) {
  return [=](RandomDraw&, const ExampleConditions&) { return EffectNumbers{{key, {size}}}; };
}

DrawExample either_sign(const std::string& key, double size) {
  return [=](RandomDraw& draw, const ExampleConditions&) {
    return EffectNumbers{{key, {draw.sign() * size}}};
  };
}

DrawExample nothing_to_draw() {
  return [](RandomDraw&, const ExampleConditions&) { return EffectNumbers{}; };
}

std::vector<double> list(const Triple& v) {
  return {v.begin(), v.end()};
}

double tone_Hz(RandomDraw& draw, const ExampleConditions& conditions) {
  return draw.log_uniform(0.15, std::min(3.0, conditions.max_tone_Hz));
}

}  // namespace injected
}  // namespace photorque
