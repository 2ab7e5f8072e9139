#include "diagnosis/light/written.h"

#include <algorithm>

#include "core/text/format.h"
#include "diagnosis/light/effects/kind.h"

namespace photorque {
namespace {

size_t index_of(const Settings& effect, const LightEffectKind& kind, const LightLab& lab) {
  size_t count = 0;
  switch (kind.index) {
    case LightEffectKind::Index::none:
      return 0;
    case LightEffectKind::Index::lamp:
      count = lab.lamps();
      break;
    case LightEffectKind::Index::cell:
      count = lab.cells().size();
      break;
    case LightEffectKind::Index::string:
      count = lab.strings();
      break;
    case LightEffectKind::Index::bypass:
      count = lab.bypasses();
      break;
    case LightEffectKind::Index::frame:
      return effect.choice_or("axes", {"lab", "body"}, 0);
    case LightEffectKind::Index::wall: {
      const std::string node = effect.text("node");
      for (size_t w = 0; w < lab.walls().size(); ++w) {
        if (lab.walls()[w].node == node) return w;
      }
      throw effect.error("node", "\"" + node + "\"", "a node of the scene beside the receiver");
    }
  }
  if (count == 0) {
    throw effect.error("kind", "\"" + kind.name + "\"", "an effect on what the experiment has");
  }
  return static_cast<size_t>(effect.integer("index", 0, static_cast<int64_t>(count) - 1));
}

std::vector<double> numbers_of(const Settings& effect, const EffectParameter& parameter) {
  if (parameter.count == 1) return {effect.number(parameter.key)};
  std::vector<double> numbers = effect.numbers(parameter.key);
  if (numbers.size() != parameter.count) {
    throw effect.error(parameter.key, std::to_string(numbers.size()) + " numbers",
                       std::to_string(parameter.count));
  }
  return numbers;
}

// Kinds that share a name differ in their parameters.
bool is_meant(const LightEffectKind& kind, const Settings& effect) {
  return std::ranges::all_of(kind.parameters,
                             [&](const EffectParameter& p) { return effect.has(p.key); });
}

}  // namespace

LightState written_state(const LightLab& lab) {
  LightState state = lab.nominal();
  const std::vector<LightEffectKind> kinds = all_light_effect_kinds();
  std::vector<std::string> names = {"led_failed"};
  for (const LightEffectKind& kind : kinds) names.push_back(kind.name);
  for (const Settings& effect : lab.experiment().file.others("effect")) {
    const size_t choice = effect.choice("kind", names);
    const bool failed = choice == 0;
    const std::string name = failed ? "led_derated" : names[choice];
    const LightEffectKind* meant = nullptr;
    for (const LightEffectKind& kind : kinds) {
      if (kind.name != name) continue;
      if (meant == nullptr || (!failed && is_meant(kind, effect))) meant = &kind;
    }
    std::vector<double> x;
    for (const EffectParameter& p : meant->parameters) {
      if (failed) {
        x.push_back(-1.0);
        continue;
      }
      for (const double value : numbers_of(effect, p)) {
        const double number = x_of(p, value);
        if (!(number >= p.lowest && number <= p.highest)) {
          throw effect.error(p.key, readable_number(value / unit_of_key(p.key).to_SI, 6),
                             "a number of " + name + ": " + range_of(p));
        }
        x.push_back(number);
      }
    }
    meant->act(state, index_of(effect, *meant, lab), x);
    // What a diagnosis says beside the numbers that act.
    for (const char* said : {"u_m", "v_m", "darkest"}) {
      if (effect.has(said)) effect.raw(said);
    }
    effect.finish();
  }
  return state;
}

}  // namespace photorque
