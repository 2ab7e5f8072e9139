#include "attitude/disturbances/kind.h"

#include <algorithm>

namespace photorque {

Disturbance read_disturbance(const Settings& settings, const DisturbanceContext& context) {
  const std::vector<DisturbanceKind> kinds = all_disturbance_kinds();
  std::vector<std::string> names;
  for (const DisturbanceKind& kind : kinds) names.push_back(kind.name);
  const DisturbanceKind& kind = kinds[settings.choice("kind", names)];
  Disturbance disturbance = kind.read(settings, context);
  disturbance.kind = kind.name;
  return disturbance;
}

std::vector<Disturbance> read_disturbances(const Settings& root,
                                           const DisturbanceContext& context) {
  std::vector<Disturbance> all;
  for (const Settings& settings : root.tables("disturbance")) {
    all.push_back(read_disturbance(settings, context));
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

}  // namespace photorque
