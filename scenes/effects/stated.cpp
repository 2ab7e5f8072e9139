#include "scenes/effects/stated.h"

#include <algorithm>
#include <set>

#include "core/constants.h"
#include "core/errors.h"
#include "core/settings/settings.h"
#include "core/settings/typed_keys.h"
#include "core/text/format.h"
#include "scenes/effects/kind.h"
#include "sources/lamps/kind.h"

namespace photorque {
namespace {

size_t index_of(const Settings& effect, const LightEffectKind& kind, const LightParts& parts) {
  using Index = LightEffectKind::Index;
  if (kind.index == Index::none) return 0;
  if (kind.index == Index::frame) return effect.choice_or("axes", {"lab", "body"}, 0);
  if (kind.index == Index::wall) {
    const std::string node = effect.text("node");
    std::set<std::string> nodes;
    for (size_t w = 0; w < parts.walls.size(); ++w) {
      if (parts.walls[w].node == node) return w;
      nodes.insert(parts.walls[w].node);
    }
    throw effect.error("node", "\"" + node + "\"",
                       "a node of the scene other than the receiver: " + listed_names(nodes, node));
  }
  const size_t count = parts.count_of(kind.index);
  if (count == 0) {
    throw effect.error(
        "kind", "\"" + kind.name + "\"",
        "an effect on lamps, cells, strings or bypass diodes that the experiment has");
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

// Whether the effect has all parameters of the kind. Kinds with the same name differ in their
// parameters.
bool is_meant(const LightEffectKind& kind, const Settings& effect) {
  return std::ranges::all_of(kind.parameters,
                             [&](const EffectParameter& p) { return effect.has(p.key); });
}

// The value of a key of a lamp profile when its angular width is multiplied by a factor. The result
// is limited to widths that a lamp can have.
double widened(const std::string& key, double value, double factor) {
  if (key == "exponent") return std::min(value / (factor * factor), std::max(value, 1e9));
  constexpr double below = 1.0 - 1e-6;  // full widths must be below 180 deg
  const KeyUnit unit = unit_of_key(key);
  const double widest_rad = unit.stem == "half_angle" ? 0.5 * pi : below * pi;
  return std::min(value * factor, std::max(value, widest_rad / unit.to_SI));
}

// Multiplies all angular widths among the keys of a source by `scale`.
void widen(SettingsNode& source, double scale) {
  auto* table = std::get_if<SettingsNode::Table>(&source.value);
  if (table == nullptr) return;
  for (auto& [key, node] : *table) {
    const std::string stem = unit_of_key(key).stem;
    const bool is_width = stem == "fwhm" || stem == "half_angle" || stem == "halo_fwhm";
    if ((!is_width && key != "exponent") || !node.is_number()) continue;
    const double value = std::holds_alternative<double>(node.value)
                             ? std::get<double>(node.value)
                             : static_cast<double>(std::get<int64_t>(node.value));
    node.value = widened(key, value, scale);
  }
}

// Notices for the user: one line for each effect that a trace does not include.
std::vector<std::string> notices_of(const Experiment& experiment,
                                    const std::vector<Settings>& effects) {
  std::set<std::string> traced = {"led_failed"};
  for (const LightEffectKind& kind : all_light_effect_kinds()) {
    if (kind.is_traced) traced.insert(kind.name);
  }
  std::vector<std::string> notices;
  for (const Settings& effect : effects) {
    const std::string kind = effect.text("kind");
    if (traced.contains(kind)) continue;
    notices.push_back(effect.name() + ": " + kind +
                      " is used by diagnose only; a trace does not include it");
  }
  for (const Settings& effect : effects) {
    if (effect.text("kind") != "attitude_bias" || !experiment.file.settings.has("torque_map"))
      continue;
    notices.push_back(effect.name() +
                      ": attitude_bias acts at [attitude] only; the attitudes of a torque map, of "
                      "[array.tracker] and of [light] are used without it");
  }
  return notices;
}

constexpr int64_t most_objects = 1'000'000'000;

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
  return {IntegerKey("index", 0, most_objects, number, {.varies = true})};
}

std::vector<Beam> beams_under(const Experiment& experiment, const LightState& state) {
  std::vector<Beam> beams;
  const std::vector<Beam> all = beams_with_divergence(experiment, state.divergence);
  for (size_t l = 0; l < all.size(); ++l) {
    Beam beam = all[l];
    const double share = state.power * state.lamp_power[l];
    if (!(share > 0.0)) continue;
    beam.lab_from_emitter = displaced_pose(beam, state.lamp_aim[l], state.shift_m);
    if (share != 1.0) {
      beam.emitter = std::make_shared<const ScaledEmitter>(beam.emitter, share);
      if (beam.aperture) beam.aperture->exitance_W_m2 *= share;
    }
    beams.push_back(std::move(beam));
  }
  if (beams.empty()) {
    throw InputError({experiment.file.path.string()}, "effect", "no lamp with power",
                     "at least one lamp that the effects leave on");
  }
  return beams;
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

std::vector<Beam> beams_with_divergence(const Experiment& experiment, double scale) {
  if (scale == 1.0) return experiment.beams;
  const std::vector<SourceKind> kinds = all_source_kinds();
  std::vector<Beam> beams;
  for (const Settings& written : experiment.file.others("source")) {
    const auto name = written.text("kind");
    const auto kind = std::find_if(kinds.begin(), kinds.end(),
                                   [&](const SourceKind& k) { return k.name == name; });
    SettingsNode::Table table;
    for (const std::string& key : written.keys()) table[key] = written.raw(key);
    SettingsNode node{table, written.where()};
    widen(node, scale);
    SourceContext context;
    context.scene_radius_m = experiment.scene.radius_m();
    context.folder = experiment.file.path.parent_path();
    const Settings source(std::move(node), written.name());
    for (Beam& beam : kind->make(source, context)) beams.push_back(std::move(beam));
  }
  return beams;
}

RigidTransform displaced_pose(const Beam& beam, const Vec2& aim, const Vec3& shift_m) {
  RigidTransform pose = beam.lab_from_emitter;
  pose.translation_m += shift_m;
  if (aim.isZero(0.0)) return pose;
  const Vec3 d = pose.direction(Vec3::UnitZ());
  const auto across = [&](const Vec3& axis) {
    const Vec3 e = axis - axis.dot(d) * d;
    return e.norm() > 1e-9 ? Vec3(e.normalized()) : Vec3(Vec3::Zero());
  };
  const Vec3 turned_to = d + aim.x() * across(Vec3::UnitX()) + aim.y() * across(Vec3::UnitY());
  pose.rotation = (rotation_between(d, turned_to) * pose.rotation).normalized();
  return pose;
}

Quat biased_attitude(const Quat& lab_from_body, const Vec2& bias_rad) {
  return turn_by({bias_rad.x(), bias_rad.y(), 0.0}) * lab_from_body;
}

LightState stated_effects(const Experiment& experiment, const LightParts& parts) {
  LightState state = parts.nominal();
  const std::vector<LightEffectKind> kinds = all_light_effect_kinds();
  std::vector<std::string> names = {"led_failed"};
  for (const LightEffectKind& kind : kinds) names.push_back(kind.name);
  for (const Settings& effect : experiment.file.others("effect")) {
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
    meant->act(state, index_of(effect, *meant, parts), x);
    // Additional results of a diagnosis; they have no effect on a run but must count as read.
    for (const char* key : {"u_m", "v_m", "darkest"}) {
      if (effect.has(key)) effect.raw(key);
    }
    effect.finish();
  }
  return state;
}

std::vector<std::string> apply_stated_effects(Experiment& experiment) {
  const std::vector<Settings> effects = experiment.file.others("effect");
  if (effects.empty()) return {};
  const LightState state = stated_effects(experiment, light_parts(experiment));
  std::vector<std::string> notices = notices_of(experiment, effects);
  std::vector<Beam> beams = beams_under(experiment, state);
  experiment.lab_from_body.rotation =
      biased_attitude(experiment.lab_from_body.rotation, state.attitude_bias_rad);
  experiment.beams = std::move(beams);
  return notices;
}

}  // namespace photorque
