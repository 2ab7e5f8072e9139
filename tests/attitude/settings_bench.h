// Settings as an experiment file would hold them, written in the test itself.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/constants.h"
#include "core/settings/settings.h"

namespace photorque {

inline constexpr double g = standard_gravity_m_s2;

inline SettingsNode node(double x) {
  SettingsNode n;
  n.value = x;
  return n;
}
inline SettingsNode node(int x) {
  return node(static_cast<double>(x));
}
inline SettingsNode node(const char* text) {
  SettingsNode n;
  n.value = std::string(text);
  return n;
}
inline SettingsNode flag(bool on) {
  SettingsNode n;
  n.value = on;
  return n;
}
inline SettingsNode list(std::vector<SettingsNode> items) {
  SettingsNode n;
  n.value = SettingsNode::Array(std::move(items));
  return n;
}
inline SettingsNode numbers(const std::vector<double>& values) {
  std::vector<SettingsNode> items;
  for (const double x : values) items.push_back(node(x));
  return list(std::move(items));
}
inline SettingsNode table(const std::vector<std::pair<std::string, SettingsNode>>& entries) {
  SettingsNode n;
  SettingsNode::Table t;
  for (const auto& [key, value] : entries) t[key] = value;
  n.value = std::move(t);
  return n;
}
inline Settings settings_of(const SettingsNode& root) {
  return Settings(std::make_shared<SettingsNode>(root));
}

}  // namespace photorque
