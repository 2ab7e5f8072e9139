#include "scenes/experiment/toml.h"

#include <toml++/toml.h>
#include <algorithm>
#include <cctype>
#include <charconv>
#include <sstream>

#include "core/text/parse.h"

namespace photorque {
namespace {

SettingsNode to_settings(const toml::node& node, const std::string& name) {
  SettingsNode result;
  result.where = {name, static_cast<int>(node.source().begin.line)};
  if (const auto* table = node.as_table()) {
    SettingsNode::Table items;
    for (const auto& [key, item] : *table) {
      SettingsNode& entry = items[std::string(key.str())] = to_settings(item, name);
      // Line of the key: a table created by a dotted key has no separate line.
      entry.where.line = static_cast<int>(key.source().begin.line);
    }
    result.value = std::move(items);
  } else if (const auto* array = node.as_array()) {
    SettingsNode::Array items;
    for (const auto& item : *array) items.push_back(to_settings(item, name));
    result.value = std::move(items);
  } else {
    node.visit([&](const auto& leaf) {
      using Leaf = decltype(leaf);
      if constexpr (toml::is_date<Leaf> || toml::is_time<Leaf> || toml::is_date_time<Leaf>) {
        std::ostringstream iso;
        iso << leaf.get();
        result.value = iso.str();
      } else if constexpr (toml::is_value<Leaf>) {
        result.value = leaf.get();
      }
    });
  }
  return result;
}

// Nested tables are built, walked and freed by recursion. With this limit, and toml++'s limit of
// 256 nested values, the stack does not overflow.
constexpr size_t max_key_parts = 16;

// Position after the end of the string that begins at `begin`, or the end of the text.
size_t end_of_string(std::string_view text, size_t begin) {
  const char quote = text[begin];
  const bool multiline = text.substr(begin, 3) == std::string(3, quote);
  const size_t quotes = multiline ? 3 : 1;
  for (size_t i = begin + quotes; i < text.size(); ++i) {
    if (text[i] == '\\' && quote == '"') {
      ++i;
    } else if (text.substr(i, quotes) == std::string(quotes, quote)) {
      // Up to two more quotes may belong to the string's content.
      size_t end = i + quotes;
      while (multiline && end < std::min(i + quotes + 2, text.size()) && text[end] == quote) ++end;
      return end;
    } else if (text[i] == '\n' && !multiline) {
      return i;
    }
  }
  return text.size();
}

// Calls `use` with each character, string and comment of a text and its line.
template <class Use>
void for_each_token(std::string_view text, const Use& use) {
  int line = 1;
  for (size_t i = 0; i < text.size();) {
    const char c = text[i];
    size_t end = i + 1;
    if (c == '"' || c == '\'') end = end_of_string(text, i);
    if (c == '#') end = std::min(text.find('\n', i), text.size());
    const std::string_view token = text.substr(i, end - i);
    use(token, line);
    line += static_cast<int>(std::ranges::count(token, '\n'));
    i = end;
  }
}

// Throws InputError for keys with too many parts, before recursive functions process them.
void require_shallow(std::string_view text, const std::string& name) {
  size_t dots = 0;
  for_each_token(text, [&](std::string_view token, int line) {
    if (token == ".") ++dots;
    if (std::string_view("=,[]{}\n").find(token[0]) != std::string_view::npos) dots = 0;
    if (dots >= max_key_parts) {
      throw InputError({name, line}, "", "a key of more than 16 parts", "at most 16");
    }
  });
}

// A step of a key's path: a name, or an index if the name is empty.
struct Step {
  std::string name;
  size_t index = 0;
};

const InputLocation command_line{"--set", 0};

InputError wrong_key(const std::string& assignment) {
  return {command_line, "", "\"" + assignment + "\"",
          "KEY=VALUE, where KEY is like source[0].power_W"};
}

// "source[0].power_W" → source, [0], power_W. Empty if the text is not a path.
std::vector<Step> steps_of(std::string_view key) {
  std::vector<Step> steps;
  while (!key.empty()) {
    const size_t length = std::min(key.find_first_of(".["), key.size());
    if (length == 0) return {};
    steps.push_back({std::string(key.substr(0, length))});
    key.remove_prefix(length);
    while (key.starts_with('[')) {
      Step step;
      const auto [end, error] =
          std::from_chars(key.data() + 1, key.data() + key.size(), step.index);
      if (error != std::errc() || end == key.data() + key.size() || *end != ']') return {};
      steps.push_back(step);
      key.remove_prefix(static_cast<size_t>(end - key.data()) + 1);
    }
    if (key.empty()) break;
    if (!key.starts_with('.') || key.size() == 1) return {};
    key.remove_prefix(1);
  }
  if (steps.size() > 2 * max_key_parts) {  // each part may have an index
    throw InputError(command_line, "", "a key of more than 16 parts", "at most 16");
  }
  return steps;
}

bool is_bare_word(const std::string& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 ||
           std::string_view("_-./+:~").find(static_cast<char>(c)) != std::string_view::npos;
  });
}

SettingsNode value_of(const std::string& text, const std::string& key) {
  SettingsNode node;
  require_shallow(text, command_line.file);
  try {
    SettingsNode document = to_settings(toml::parse("value = " + text), command_line.file);
    auto& table = std::get<SettingsNode::Table>(document.value);
    if (table.size() != 1) throw InputError(command_line, key, "\"" + text + "\"", "one value");
    node = std::move(table.begin()->second);
  } catch (const toml::parse_error&) {
    if (!is_bare_word(text)) {
      throw InputError(command_line, key, "\"" + text + "\"", "a TOML value or one bare word");
    }
    node.value = text;
  }
  return node;
}

void locate_on_command_line(SettingsNode& root) {
  for_each_node(root, [](SettingsNode& node) { node.where = command_line; });
}

// The item to which one step leads; creates a new key of a table.
SettingsNode& follow(SettingsNode& node, const Step& step, const std::string& key) {
  if (!step.name.empty()) {
    auto* table = std::get_if<SettingsNode::Table>(&node.value);
    if (table == nullptr) {
      throw InputError(command_line, key, step.name + " in " + describe(node),
                       "a table, or the index of one, as in source[0]");
    }
    const auto [item, is_new] = table->try_emplace(step.name);
    if (is_new) item->second.where = command_line;
    return item->second;
  }
  if (node.is_table() && step.index == 0) return node;  // [source] is short for one [[source]]
  auto* array = std::get_if<SettingsNode::Array>(&node.value);
  const size_t size = array == nullptr ? 0 : array->size();
  if (step.index >= size) {
    throw InputError(command_line, key, "index " + std::to_string(step.index),
                     array == nullptr ? "no index: this is " + describe(node)
                     : size == 0      ? "no index: the array is empty"
                     : size == 1      ? "index 0, the only one"
                                      : "an index from 0 to " + std::to_string(size - 1));
  }
  return (*array)[step.index];
}

void erase_other_units(SettingsNode::Table& table, const std::string& key) {
  const KeyUnit unit = unit_of_key(key);
  if (unit.unit.empty()) return;
  std::erase_if(table, [&](const auto& item) {
    const KeyUnit other = unit_of_key(item.first);
    return item.first != key && other.stem == unit.stem && other.dimension == unit.dimension;
  });
}

// Line `number` (counted from one) of a text, without surrounding blanks and comment.
std::string bare_line(const std::string& text, int number) {
  std::istringstream lines(text);
  std::string line;
  for (int i = 0; i < number && std::getline(lines, line); ++i) {
  }
  return std::string(trimmed(std::string_view(line).substr(0, line.find('#'))));
}

// The expected text for a line that is not valid TOML, with hints for common mistakes.
std::string expected_line(const std::string& line) {
  const size_t equals = line.find('=');
  if (equals == std::string::npos) return "TOML";
  const std::string key(trimmed(std::string_view(line).substr(0, equals)));
  const std::string value(trimmed(std::string_view(line).substr(equals + 1)));
  if (key.empty()) return "TOML";
  if (value.empty()) return "TOML, a value behind " + key + " =";
  const auto is_letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
  const bool is_word = is_letter(value[0]) || value[0] == '/' || value[0] == '.';
  if (is_word && value.find('"') == std::string::npos) {
    return "TOML, text in quotes: " + key + " = \"" + value + "\"";
  }
  const bool is_number = value.find_first_not_of("+-0123456789.,eE") == std::string::npos;
  const size_t comma = value.find(',');
  if (is_number && comma != std::string::npos && comma == value.rfind(',')) {
    std::string with_point = value;
    with_point[comma] = '.';
    return "TOML, a decimal point: " + key + " = " + with_point;
  }
  return "TOML";
}

}  // namespace

SettingsNode parse_toml(const std::string& text, const std::string& name) {
  for (const char* ending : {".stl", ".obj", ".gltf", ".glb"}) {
    if (!name.ends_with(ending)) continue;
    throw InputError({name}, "", "a model of a scene",
                     "an experiment (photorque new EXPERIMENT.toml --scene MODEL makes one)");
  }
  for (const char* ending : {".csv", ".csv.gz", ".tsv"}) {
    if (!name.ends_with(ending)) continue;
    throw InputError({name}, "", "a table of readings",
                     "an experiment (TOML): photorque diagnose --guess FILE writes one for a "
                     "recording or a curve; for fit-cell it has a table [fit] with curves = "
                     "[\"FILE\"]");
  }
  require_text(text, {name, 1});
  require_shallow(text, name);
  try {
    return to_settings(toml::parse(text, name), name);
  } catch (const toml::parse_error& error) {
    const InputLocation where{name, static_cast<int>(error.source().begin.line)};
    throw InputError(where, "", "a syntax error (" + std::string(error.description()) + ")",
                     expected_line(bare_line(text, where.line)));
  }
}

std::vector<TomlComment> toml_comments(const std::string& text) {
  std::vector<TomlComment> comments;
  int depth = 0;           // of open brackets
  bool has_value = false;  // on this line so far
  for_each_token(text, [&](std::string_view token, int line) {
    const char c = token[0];
    if (c == '#') {
      comments.push_back({line, std::string(trimmed(token)), has_value || depth > 0});
    }
    if (c == '\n') has_value = false;
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    has_value = has_value || std::string_view(" \t\r\n#").find(c) == std::string_view::npos;
  });
  return comments;
}

void apply_override(SettingsNode& root, const std::string& assignment) {
  const size_t equals = assignment.find('=');
  if (equals == std::string::npos) throw wrong_key(assignment);
  const std::string key = assignment.substr(0, equals);
  const std::vector<Step> steps = steps_of(key);
  if (steps.empty()) throw wrong_key(assignment);

  SettingsNode value = value_of(assignment.substr(equals + 1), key);
  locate_on_command_line(value);
  SettingsNode* holder = &root;
  for (size_t i = 0; i + 1 < steps.size(); ++i) holder = &follow(*holder, steps[i], key);
  follow(*holder, steps.back(), key) = std::move(value);
  if (auto* table = std::get_if<SettingsNode::Table>(&holder->value)) {
    erase_other_units(*table, steps.back().name);
  }
}

const SettingsNode* find_setting(const SettingsNode& root, const std::string& key) {
  const std::vector<Step> steps = steps_of(key);
  const SettingsNode* node = steps.empty() ? nullptr : &root;
  for (const Step& step : steps) {
    if (node == nullptr) return nullptr;
    if (const auto* table = std::get_if<SettingsNode::Table>(&node->value)) {
      if (step.name.empty() && step.index == 0) continue;
      const auto at = step.name.empty() ? table->end() : table->find(step.name);
      node = at == table->end() ? nullptr : &at->second;
    } else {
      const auto* items = std::get_if<SettingsNode::Array>(&node->value);
      const bool there = items != nullptr && step.name.empty() && step.index < items->size();
      node = there ? &(*items)[step.index] : nullptr;
    }
  }
  return node;
}

}  // namespace photorque
