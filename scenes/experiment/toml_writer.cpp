#include "scenes/experiment/toml_writer.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/text/parse.h"

namespace photorque {
namespace {

std::string quoted(const std::string& text) {
  std::string all = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      all += '\\';
      all += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      char escaped[8];
      std::snprintf(escaped, sizeof escaped, "\\u%04x", static_cast<unsigned>(c));
      all += escaped;
    } else {
      all += c;
    }
  }
  return all + '"';
}

std::string key_text(const std::string& key) {
  const bool is_bare = !key.empty() && std::ranges::all_of(key, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
  });
  return is_bare ? key : quoted(key);
}

std::string real_text(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0.0 ? "inf" : "-inf";
  const std::string text = shortest(value);
  return text.find_first_of(".eE") == std::string::npos ? text + ".0" : text;
}

struct ValueWriter {
  std::string operator()(bool value) const { return value ? "true" : "false"; }
  std::string operator()(int64_t value) const { return std::to_string(value); }
  std::string operator()(double value) const { return real_text(value); }
  std::string operator()(const std::string& value) const { return quoted(value); }
  std::string operator()(const SettingsNode::Array& items) const {
    std::string all;
    for (const SettingsNode& item : items) all += (all.empty() ? "" : ", ") + toml_value(item);
    return "[" + all + "]";
  }
  std::string operator()(const SettingsNode::Table& table) const {
    std::string all;
    for (const auto& [key, value] : table) {
      all += (all.empty() ? "" : ", ") + key_text(key) + " = " + toml_value(value);
    }
    return all.empty() ? "{}" : "{ " + all + " }";
  }
};

const SettingsNode::Array* tables_of(const SettingsNode& node) {
  const auto* items = std::get_if<SettingsNode::Array>(&node.value);
  const bool all_tables = items != nullptr && !items->empty() &&
                          std::ranges::all_of(*items, [](const auto& i) { return i.is_table(); });
  return all_tables ? items : nullptr;
}

std::string section(const std::string& head, const SettingsNode& table) {
  std::string text = "\n" + head + "\n";
  for (const auto& [key, value] : std::get<SettingsNode::Table>(table.value)) {
    text += key_text(key) + " = " + toml_value(value) + "\n";
  }
  return text;
}

}  // namespace

std::string toml_value(const SettingsNode& node) {
  return std::visit(ValueWriter{}, node.value);
}

std::string toml_document(const SettingsNode::Table& root) {
  std::string values, sections;
  for (const auto& [key, node] : root) {
    const std::string name = key_text(key);
    if (node.is_table()) {
      sections += section("[" + name + "]", node);
    } else if (const auto* items = tables_of(node)) {
      for (const SettingsNode& item : *items) sections += section("[[" + name + "]]", item);
    } else {
      values += name + " = " + toml_value(node) + "\n";
    }
  }
  return values + sections;
}

}  // namespace photorque
