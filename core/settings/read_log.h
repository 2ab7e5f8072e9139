// Declarations shared by the files of this room.
#pragma once

#include <map>
#include <set>
#include <string>

#include "core/settings/settings.h"

namespace photorque {

// The keys that were read and requested: shared by all views of one root, so that finish() on the
// root sees the reads of every part of the program.
struct Settings::Log {
  std::set<const SettingsNode*> read;
  std::map<const SettingsNode*, std::set<std::string>> asked;  // table → keys asked for

  void mark_all(const SettingsNode& node) {
    read.insert(&node);
    if (const auto* array = std::get_if<SettingsNode::Array>(&node.value)) {
      for (const auto& item : *array) mark_all(item);
    } else if (const auto* table = std::get_if<SettingsNode::Table>(&node.value)) {
      for (const auto& [key, item] : *table) mark_all(item);
    }
  }
};

// Twelve significant digits, as people write numbers.
std::string format_setting(double x);

// The key of the same quantity as the user wrote it in the table; `key` where there is none.
std::string as_written(const SettingsNode& table, std::string_view key);

// "a number in (0, 90] deg": `range` is SI, `factor` the unit's.
std::string describe_range(Range range, double factor, const std::string& unit);
bool is_inside(double x, Range range);
// "one of "a", "b"".
std::string one_of(const std::vector<std::string>& choices);
// The expectation for a word that is none of them, with the most similar.
std::string one_of(const std::vector<std::string>& choices, const std::string& instead_of);
// The keys that are expected in the place of an unknown one.
std::string expected_keys(std::string_view key, const std::set<std::string>& known);

}  // namespace photorque
