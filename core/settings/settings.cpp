#include "core/settings/settings.h"

#include <algorithm>

#include "core/settings/read_log.h"
#include "core/text/format.h"

namespace photorque {
namespace {

size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<size_t> row(b.size() + 1);
  for (size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (size_t i = 1; i <= a.size(); ++i) {
    size_t diagonal = row[0];
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t replace = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replace});
    }
  }
  return row[b.size()];
}

// " (is LIKE in line N meant?)", or without a line on the command line, for the most similar key
// that was not requested yet, if there is one.
std::string misspelled(std::string_view key, const SettingsNode::Table& table,
                       const std::set<std::string>& asked) {
  std::set<std::string> unasked;
  for (const auto& [other, node] : table) {
    if (!asked.contains(other)) unasked.insert(other);
  }
  const std::string likest = nearest(key, unasked);
  if (likest.empty()) return "";
  const int line = table.find(likest)->second.where.line;
  return " (is \"" + likest + "\"" + (line > 0 ? " in line " + std::to_string(line) : "") +
         " meant?)";
}

}  // namespace

std::string as_written(const SettingsNode& table, std::string_view key) {
  const auto& keys = std::get<SettingsNode::Table>(table.value);
  if (keys.contains(key)) return std::string(key);
  const KeyUnit asked = unit_of_key(key);
  for (const auto& [written, node] : keys) {
    const KeyUnit unit = unit_of_key(written);
    if (!asked.unit.empty() && unit.stem == asked.stem && unit.dimension == asked.dimension) {
      return written;
    }
  }
  return std::string(key);
}

std::string format_setting(double x) {
  return printed("%.12g", x);
}

std::string describe(const SettingsNode& node) {
  if (const auto* b = std::get_if<bool>(&node.value)) return *b ? "true" : "false";
  if (const auto* i = std::get_if<int64_t>(&node.value)) return std::to_string(*i);
  if (const auto* d = std::get_if<double>(&node.value)) return format_setting(*d);
  if (const auto* s = std::get_if<std::string>(&node.value)) return "\"" + *s + "\"";
  if (const auto* a = std::get_if<SettingsNode::Array>(&node.value)) {
    return "an array of " + std::to_string(a->size());
  }
  return "a table";
}

std::string nearest(std::string_view word, const std::set<std::string>& candidates) {
  std::string best;
  size_t best_distance = std::max<size_t>(2, word.size() / 2) + 1;
  for (const auto& candidate : candidates) {
    // A missing unit counts as one wrong letter.
    const bool lacks_unit = candidate.starts_with(std::string(word) + "_");
    const size_t distance = lacks_unit ? 1 : edit_distance(word, candidate);
    if (distance < best_distance) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

std::string listed_names(std::set<std::string> names, std::string_view wanted) {
  constexpr size_t most = 12;
  names.erase("");
  if (names.empty()) return "none";
  const std::string likest = nearest(wanted, names);
  std::string text = likest.empty() ? "" : "perhaps \"" + likest + "\"";
  if (!likest.empty() && names.size() == 1) return text;
  if (!likest.empty()) text += ", of ";
  size_t count = 0;
  for (const std::string& name : names) {
    if (++count > most) break;
    text += (count == 1 ? "\"" : ", \"") + name + "\"";
  }
  if (names.size() > most) text += " and " + std::to_string(names.size() - most) + " more";
  return text;
}

// The most similar known key, otherwise a list of the first known keys.
std::string expected_keys(std::string_view key, const std::set<std::string>& known) {
  const std::string likest = nearest(key, known);
  return likest.empty() ? "one of " + listed_names(known, key)
                        : "a known key, perhaps \"" + likest + "\"";
}

Settings::Settings(std::shared_ptr<const SettingsNode> root, std::string name)
    : node_(root.get()),
      root_(std::move(root)),
      log_(std::make_shared<Log>()),
      name_(std::move(name)) {}

Settings::Settings(const SettingsNode* node, std::shared_ptr<const SettingsNode> root,
                   std::shared_ptr<Log> log, std::string name)
    : node_(node), root_(std::move(root)), log_(std::move(log)), name_(std::move(name)) {}

std::string Settings::full_name(std::string_view key) const {
  // Messages name the key as the user wrote it.
  std::string written = as_written(*node_, key);
  if (name_.empty()) return written;
  return key.empty() ? name_ : name_ + "." + written;
}

InputLocation Settings::where() const {
  return node_->where;
}

InputError Settings::error(std::string_view key, const std::string& found,
                           const std::string& expected) const {
  const SettingsNode::Table& table = written();
  const auto it = table.find(key);
  return {it == table.end() ? node_->where : it->second.where, full_name(key), found, expected};
}

const SettingsNode::Table& Settings::written() const {
  return std::get<SettingsNode::Table>(node_->value);
}

Settings::Found Settings::find(std::string_view key) const {
  log_->asked[node_].insert(std::string(key));
  const SettingsNode::Table& table = written();
  const KeyUnit wanted = unit_of_key(key);
  const auto exact = table.find(key);
  Found found{exact == table.end() ? nullptr : &exact->second, wanted.to_SI};
  if (!wanted.unit.empty()) {
    for (const auto& [other_key, node] : table) {
      if (other_key == key) continue;
      const KeyUnit other = unit_of_key(other_key);
      if (other.stem != wanted.stem || other.dimension != wanted.dimension) continue;
      if (found.node != nullptr) {
        throw InputError(
            node.where, full_name(other_key),
            "the same quantity as " + std::string(exact == table.end() ? "another key" : key),
            "it once");
      }
      found = {&node, other.to_SI};
    }
  }
  if (found.node != nullptr) log_->read.insert(found.node);
  return found;
}

Settings::Found Settings::require(std::string_view key, const std::string& expected) const {
  if (const Found found = find(key); found.node != nullptr) return found;
  // A key of the same stem with no or a wrong unit is the most likely mistake.
  const KeyUnit wanted = unit_of_key(key);
  if (!wanted.unit.empty()) {
    for (const auto& [other_key, node] : written()) {
      if (other_key == wanted.stem || unit_of_key(other_key).stem == wanted.stem) {
        throw InputError(node.where, full_name(other_key),
                         "a key without a unit of " + wanted.dimension,
                         "the key " + std::string(key));
      }
    }
  }
  throw InputError(node_->where, full_name(key), "nothing",
                   expected + misspelled(key, written(), log_->asked[node_]));
}

bool Settings::has(std::string_view key) const {
  log_->asked[node_].insert(std::string(key));
  return written().contains(as_written(*node_, key));
}

Settings Settings::table(std::string_view key) const {
  const SettingsNode* node = require(key, "a table [" + full_name(key) + "]").node;
  as<SettingsNode::Table>(*node, key, "a table");
  return {node, root_, log_, full_name(key)};
}

Settings Settings::table_or_empty(std::string_view key) const {
  return has(key) ? table(key) : Settings(SettingsNode{}, full_name(key));
}

std::vector<Settings> Settings::tables(std::string_view key) const {
  const SettingsNode* node = find(key).node;
  std::vector<Settings> all;
  if (node == nullptr) return all;
  if (node->is_table()) {
    all.push_back({node, root_, log_, full_name(key)});
    return all;
  }
  const auto& array = as<SettingsNode::Array>(*node, key, "tables [[" + full_name(key) + "]]");
  for (size_t i = 0; i < array.size(); ++i) {
    const SettingsNode& item = array[i];
    const std::string item_name = full_name(key) + "[" + std::to_string(i) + "]";
    if (!item.is_table()) throw InputError(item.where, item_name, describe(item), "a table");
    log_->read.insert(&item);
    all.push_back({&item, root_, log_, item_name});
  }
  return all;
}

std::vector<std::string> Settings::keys() const {
  std::vector<std::string> all;
  for (const auto& [key, node] : written()) all.push_back(key);
  return all;
}

const SettingsNode& Settings::raw(std::string_view key) const {
  const SettingsNode& node = *require(key, "a value").node;
  log_->mark_all(node);
  return node;
}

void Settings::finish() const {
  for (const auto& [key, node] : written()) {
    if (!log_->read.contains(&node)) {
      const auto asked = log_->asked.find(node_);
      throw InputError(
          node.where, full_name(key), "an unknown key",
          asked == log_->asked.end() ? "only known keys" : expected_keys(key, asked->second));
    }
    if (node.is_table()) Settings(&node, root_, log_, full_name(key)).finish();
    if (const auto* array = std::get_if<SettingsNode::Array>(&node.value)) {
      for (size_t i = 0; i < array->size(); ++i) {
        const SettingsNode& item = (*array)[i];
        if (item.is_table()) {
          Settings(&item, root_, log_, full_name(key) + "[" + std::to_string(i) + "]").finish();
        }
      }
    }
  }
}

}  // namespace photorque
