#include "diagnosis/light/keys.h"

#include "scenes/effects/kind.h"

namespace photorque {
namespace {

constexpr int64_t most = 1'000'000'000;

Key key_of(const EffectParameter& parameter) {
  // Two kinds may have a name in common but different ranges.
  const std::string range = range_of(parameter);
  const std::string meaning = "of the effect" + (range.empty() ? "" : ", " + range);
  if (parameter.count > 1) return Key::numbers(parameter.key, {}, meaning).of_size(parameter.count);
  return Key::number(parameter.key, {}, meaning);
}

std::vector<Key> place_keys(LightEffectKind::Index index) {
  const auto number_of = [](const char* what) {
    return std::vector{Key::integer("index", 0, most, what).range_that_varies()};
  };
  switch (index) {
    case LightEffectKind::Index::none:
      return {};
    case LightEffectKind::Index::lamp:
      return number_of("of the LED, over all sources in the order of the file, from 0");
    case LightEffectKind::Index::cell:
      return number_of("of the cell, row · columns + column, from 0");
    case LightEffectKind::Index::string:
      return number_of("of the string, along the serpentine, from 0");
    case LightEffectKind::Index::bypass:
      return number_of("of the bypass diode, along the serpentine, from 0");
    case LightEffectKind::Index::wall:
      return {Key::text("node", "of the scene, beside the receiver")};
    case LightEffectKind::Index::frame:
      return {
          Key::choice_or("axes", words({"lab", "body"}), 0, "axes to which the object is fixed")};
  }
  return {};
}

}  // namespace

std::vector<Key> light_sensor_keys() {
  const auto noise = [](const char* name, const char* what) {
    return Key::number_or(name, 0.0, Range::not_negative(), what);
  };
  return {
      Key::table(
          "irradiance",
          {noise("noise_W_m2", "standard deviation of a reading"),
           noise("relative_noise", "standard deviation as a fraction of the reading, added")},
          "instrument of scans of the light"),
      Key::table(
          "array",
          {noise("voltage_noise_V", "of a reading"), noise("current_noise_A", "of a reading"),
           Key::number(
               "tracker_step_V", Range::not_negative(),
               "voltage step of the tracker; its recorded voltage is then an input of the model")
               .usually_is("the tracker is assumed to be at the highest maximum")},
          "instruments of the array")};
}

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
