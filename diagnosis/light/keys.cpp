#include "diagnosis/light/keys.h"

#include "core/settings/typed_keys.h"
#include "scenes/effects/kind.h"

namespace photorque {
namespace {

constexpr int64_t most = 1'000'000'000;

Key key_of(const EffectParameter& parameter) {
  // Two kinds may have a key of equal name but with different ranges, so the meaning contains the
  // range.
  const std::string range = range_of(parameter);
  const std::string meaning = parameter.meaning + (range.empty() ? "" : ", " + range);
  if (parameter.count > 1) {
    return NumbersKey(parameter.key, {}, meaning, {.size = parameter.count});
  }
  return NumberKey(parameter.key, Range{}, meaning);
}

std::vector<Key> place_keys(LightEffectKind::Index index) {
  using Index = LightEffectKind::Index;
  if (index == Index::none) return {};
  if (index == Index::wall) return {TextKey("node", "node of the wall in the scene")};
  if (index == Index::frame) {
    return {Key::choice_or("axes", words({"lab", "body"}), 0, "axes to which the object is fixed")};
  }
  const char* const number =
      index == Index::lamp ? "number of the LED, from 0, over all sources in the order of the file"
      : index == Index::cell   ? "number of the cell: row · columns + column, from 0"
      : index == Index::string ? "number of the string along the serpentine, from 0"
                               : "number of the bypass diode along the serpentine, from 0";
  return {IntegerKey("index", 0, most, number, {.varies = true})};
}

}  // namespace

std::vector<Key::Choice> light_effects() {
  std::vector<Key::Choice> all;
  for (const LightEffectKind& kind : all_light_effect_kinds()) {
    std::vector<Key> keys = place_keys(kind.index);
    for (const EffectParameter& parameter : kind.parameters) keys.push_back(key_of(parameter));
    add_choice(all, {kind.name, kind.explanation, std::move(keys)});
    // A failed LED gives no light at all, so it has no strength.
    if (kind.name == "led_derated") {
      all.push_back({"led_failed", "an LED gives no light", place_keys(kind.index)});
    }
  }
  return all;
}

}  // namespace photorque
