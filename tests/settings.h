// Settings and sources made by hand, for tests: {"power_W", {1.0}} is a key with its value.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/settings/settings.h"
#include "sources/lamps/kind.h"

namespace photorque::test {

inline SettingsNode numbers_node(const std::vector<double>& numbers) {
  SettingsNode::Array array;
  for (const double number : numbers) array.push_back({number});
  return {std::move(array), {}};
}

inline SettingsNode vector_node(double x, double y, double z) {
  return numbers_node({x, y, z});
}

// As if read from line 7 of test.toml.
inline Settings settings_of(SettingsNode::Table table, const std::string& name = "source[0]") {
  SettingsNode root{std::move(table)};
  for_each_node(root, [](SettingsNode& node) { node.where = {"test.toml", 7}; });
  return Settings(std::make_shared<SettingsNode>(std::move(root)), name);
}

inline SourceKind kind_called(const std::string& name) {
  for (SourceKind& kind : all_source_kinds()) {
    if (kind.name == name) return kind;
  }
  throw std::logic_error("no source kind " + name);
}

inline std::vector<Beam> make_beams(const std::string& kind, SettingsNode::Table table,
                                    const SourceContext& context = {}) {
  const Settings settings = settings_of(std::move(table));
  std::vector<Beam> beams = kind_called(kind).make(settings, context);
  settings.finish();
  return beams;
}

}  // namespace photorque::test
