#include "scenes/experiment/uncertain.h"

#include <algorithm>
#include <optional>

#include "core/errors.h"
#include "scenes/experiment/toml.h"

namespace photorque {
namespace {

std::optional<double> plain_number(const SettingsNode& node) {
  if (const auto* whole = std::get_if<int64_t>(&node.value)) return static_cast<double>(*whole);
  if (const auto* real = std::get_if<double>(&node.value)) return *real;
  return std::nullopt;
}

// Whether a table is { value = …, sigma = … }. No other table of lamps, arrays or attitudes has
// these keys, so a table with only one of them, or with another key, is an error.
bool is_value_with_sigma(const SettingsNode::Table& table, const std::string& path) {
  const bool has_value = table.contains("value"), has_sigma = table.contains("sigma");
  if (!has_value && !has_sigma) return false;
  for (const auto& [key, item] : table) {
    if (key == "value" || key == "sigma") continue;
    throw InputError(
        item.where, path + "." + key, "an unknown key",
        std::string(has_value && has_sigma ? "nothing beside" : "one of") + " value and sigma");
  }
  if (has_value && has_sigma) return true;
  const SettingsNode& one = table.begin()->second;
  throw InputError(one.where, path, has_value ? "no sigma" : "no value",
                   "{ value = ..., sigma = ... }");
}

void take(SettingsNode& node, const std::string& path, std::vector<UncertainKey>& all) {
  if (auto* array = std::get_if<SettingsNode::Array>(&node.value)) {
    for (size_t i = 0; i < array->size(); ++i) {
      take((*array)[i], path + "[" + std::to_string(i) + "]", all);
    }
    return;
  }
  auto* table = std::get_if<SettingsNode::Table>(&node.value);
  if (table == nullptr) return;
  if (!is_value_with_sigma(*table, path)) {
    for (auto& [key, inner] : *table) take(inner, path + "." + key, all);
    return;
  }
  const SettingsNode value = table->at("value"), sigma = table->at("sigma");
  UncertainKey key{path, plain_numbers(value), plain_numbers(sigma), value.is_array()};
  if (key.value.empty()) {
    throw InputError(value.where, path + ".value", describe(value), "a number or numbers");
  }
  const bool is_good = key.sigma.size() == key.value.size() &&
                       std::ranges::all_of(key.sigma, [](double s) { return s >= 0.0; });
  if (!is_good) {
    throw InputError(sigma.where, path + ".sigma", describe(sigma),
                     "as many numbers >= 0 as its value has");
  }
  node = value;
  all.push_back(std::move(key));
}

}  // namespace

std::vector<double> plain_numbers(const SettingsNode& node) {
  if (const auto one = plain_number(node)) return {*one};
  std::vector<double> all;
  const auto* array = std::get_if<SettingsNode::Array>(&node.value);
  if (array == nullptr) return {};
  for (const SettingsNode& item : *array) {
    const auto one = plain_number(item);
    if (!one) return {};
    all.push_back(*one);
  }
  return all;
}

std::vector<UncertainKey> uncertain_keys(const std::filesystem::path& path, const std::string& text,
                                         std::span<const std::string> overrides) {
  SettingsNode root = parse_toml(text, path.string());
  for (const std::string& assignment : overrides) apply_override(root, assignment);
  return take_uncertainty(root);
}

std::vector<UncertainKey> take_uncertainty(SettingsNode& root) {
  std::vector<UncertainKey> all;
  auto* tables = std::get_if<SettingsNode::Table>(&root.value);
  if (tables == nullptr) return all;
  for (const char* name : {"array", "attitude", "source"}) {
    const auto found = tables->find(name);
    if (found != tables->end()) take(found->second, name, all);
  }
  return all;
}

}  // namespace photorque
