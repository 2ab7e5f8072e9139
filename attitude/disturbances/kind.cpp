#include "attitude/disturbances/kind.h"

#include <algorithm>
#include <map>
#include <span>

#include "core/errors.h"
#include "core/text/format.h"
#include "core/text/parse.h"

namespace photorque {

namespace {

// Whether a written key is the quantity of `key`, possibly in another unit.
bool is_same_quantity(const std::string& written, std::string_view key) {
  const KeyUnit a = unit_of_key(written), b = unit_of_key(key);
  return a.stem == b.stem && (a.dimension == b.dimension || a.unit.empty() || b.unit.empty());
}

}  // namespace

const std::vector<DisturbanceKind>& disturbance_kinds() {
  static const std::vector<DisturbanceKind> kinds = all_disturbance_kinds();
  return kinds;
}

const DisturbanceKind* find_kind(const std::string& name) {
  for (const DisturbanceKind& kind : disturbance_kinds()) {
    if (kind.name == name) return &kind;
  }
  return nullptr;
}

Disturbance read_disturbance(const Settings& settings, const DisturbanceContext& context) {
  const std::vector<DisturbanceKind>& kinds = disturbance_kinds();
  std::vector<std::string> names;
  for (const DisturbanceKind& kind : kinds) names.push_back(kind.name);
  const DisturbanceKind& kind = kinds[settings.choice("kind", names)];
  Disturbance disturbance = [&] {
    try {
      return kind.read(settings, context);
    } catch (const InputError&) {
      if (settings.keys().size() > 1) throw;
      constexpr size_t most = 8;
      const std::span<const Key> shown(kind.keys.data(), std::min(most, kind.keys.size()));
      throw settings.error("kind", in_quotes(kind.name) + " without its keys",
                           "also " + joined_text(shown, ", ", &Key::name) +
                               (kind.keys.size() > most ? ", …" : "") + " (docs/disturbances.md)");
    }
  }();
  disturbance.kind = kind.name;
  disturbance.per_recording =
      settings.flag_or("per_recording", false) || kind.screening.per_recording;
  return disturbance;
}

Key disturbance_table() {
  std::vector<Key::Choice> kinds;
  for (const DisturbanceKind& kind : disturbance_kinds()) {
    const std::string& unranked = kind.budget.reason_against;
    kinds.push_back({kind.name, kind.summary, kind.keys,
                     screening_text(kind.screening) +
                         (unranked.empty() ? "" : ". Not ranked by `budget`: " + unranked)});
  }
  return Key::tables(
      "disturbance",
      {Key::choice("kind", std::move(kinds), "kind of the effect"),
       FlagKey("per_recording", false,
               "`diagnose` fits its parameters with a sigma separately for each recording")},
      "the effects on the platform");
}

std::vector<Disturbance> read_disturbances(const Settings& root,
                                           const DisturbanceContext& context) {
  std::vector<Disturbance> all;
  std::map<std::string, std::string> set_by;
  for (const Settings& settings : root.tables("disturbance")) {
    all.push_back(read_disturbance(settings, context));
    const DisturbanceKind* kind = find_kind(all.back().kind);
    if (kind == nullptr || kind->sets.empty()) continue;
    const auto [before, is_first] = set_by.emplace(kind->sets, kind->name);
    if (is_first) continue;
    throw settings.error("kind", in_quotes(kind->name) + " behind " + in_quotes(before->second),
                         "one disturbance that sets " + kind->sets);
  }
  return all;
}

Disturbance make_disturbance_of(
    const std::string& kind, const std::vector<std::pair<std::string, std::vector<double>>>& values,
    const DisturbanceContext& context) {
  SettingsNode::Table table;
  table["kind"].value = kind;
  for (const auto& [key, numbers] : values) {
    SettingsNode& node = table[key];
    if (numbers.size() == 1) {
      node.value = numbers.front();
      continue;
    }
    SettingsNode::Array array(numbers.size());
    for (size_t i = 0; i < numbers.size(); ++i) array[i].value = numbers[i];
    node.value = array;
  }
  auto root = std::make_shared<SettingsNode>();
  root->value = std::move(table);
  const Settings settings(root, kind);
  Disturbance disturbance = read_disturbance(settings, context);
  settings.finish();
  return disturbance;
}

size_t index_of(const Disturbance& disturbance, std::string_view key) {
  const Parameters& all = disturbance.parameters;
  auto found = std::find_if(all.begin(), all.end(), [&](const auto& p) { return p.key == key; });
  if (found == all.end()) {
    found = std::find_if(all.begin(), all.end(),
                         [&](const auto& p) { return is_same_quantity(p.key, key); });
  }
  if (found != all.end()) return static_cast<size_t>(found - all.begin());
  throw NumericalError(disturbance.kind + " has no parameter " + std::string(key));
}

Parameter& parameter_of(Disturbance& disturbance, std::string_view key) {
  return disturbance.parameters[index_of(disturbance, key)];
}

const Parameter& parameter_of(const Disturbance& disturbance, std::string_view key) {
  return disturbance.parameters[index_of(disturbance, key)];
}

Vec3 vector_of(const Disturbance& disturbance, std::string_view key) {
  return vector_at(disturbance.parameters, index_of(disturbance, key));
}

void set_vector(Disturbance& disturbance, std::string_view key, const Vec3& value_SI) {
  const size_t first = index_of(disturbance, key);
  for (size_t k = 0; k < 3; ++k) {
    disturbance.parameters.at(first + k).value = value_SI[static_cast<Eigen::Index>(k)];
  }
}

const ExtraState& state_of(const Disturbance& disturbance, std::string_view name) {
  for (const ExtraState& state : disturbance.states) {
    if (state.name == name) return state;
  }
  throw NumericalError(disturbance.kind + " has no state " + std::string(name));
}

ExtraState& state_of(Disturbance& disturbance, std::string_view name) {
  return const_cast<ExtraState&>(state_of(std::as_const(disturbance), name));
}

}  // namespace photorque
