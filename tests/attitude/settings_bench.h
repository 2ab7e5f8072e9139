// Settings as an experiment file holds them, written as TOML in the test itself.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "core/constants.h"
#include "core/text/format.h"
#include "core/text/parse.h"
#include "scenes/experiment/toml.h"

namespace photorque {

inline constexpr double g = standard_gravity_m_s2;

// A computed value as TOML: "rate_Hz = " + toml(2.0 * pi).
inline std::string toml(double value) {
  return shortest(value);
}
inline std::string toml(const std::filesystem::path& file) {
  return "'" + file.string() + "'";
}
inline std::string toml(std::span<const double> values) {
  return "[" + joined_text(values, ", ", shortest) + "]";
}

// The table of a list of keys: keys_node("mass_kg = 7, axis = [0, 0, 1]").
inline SettingsNode keys_node(const std::string& keys) {
  const SettingsNode root = parse_toml("keys = {" + keys + "}", "test.toml");
  return std::get<SettingsNode::Table>(root.value).at("keys");
}
inline Settings settings_of(const std::string& keys) {
  return Settings(keys_node(keys));
}

}  // namespace photorque
