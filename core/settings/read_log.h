// Declarations shared by the files of this folder.
#pragma once

#include <map>
#include <set>
#include <string>

#include "core/settings/settings.h"

namespace photorque {

// The keys that were read and requested. All views of one root share it, so that finish() on the
// root covers the reads of every part of the program.
struct Settings::Log {
  std::set<const SettingsNode*> read;
  std::map<const SettingsNode*, std::set<std::string>> asked;  // table → requested keys

  void mark_all(const SettingsNode& node) {
    for_each_node(node, [this](const SettingsNode& one) { read.insert(&one); });
  }
};

// The value of a node. InputError if it has another type.
template <class Value>
const Value& Settings::as(const SettingsNode& node, std::string_view key,
                          const std::string& expected) const {
  if (const auto* value = std::get_if<Value>(&node.value)) return *value;
  throw InputError(node.where, full_name(key), describe(node), expected);
}

// A number with at most twelve significant digits, without trailing zeros.
std::string format_setting(double x);

// The key of the same quantity as the user wrote it in the table; `key` if there is none.
std::string as_written(const SettingsNode& table, std::string_view key);

// "a number in (0, 90] deg": `range` is SI, `factor` the SI value of the unit.
std::string describe_range(Range range, double factor, const std::string& unit);
bool is_inside(double x, Range range);
// "one of "a", "b"".
std::string one_of(const std::vector<std::string>& choices);
// The expected words in place of `instead_of`, with a suggestion of the most similar one.
std::string one_of(const std::vector<std::string>& choices, const std::string& instead_of);
// The keys that are expected in the place of an unknown one.
std::string expected_keys(std::string_view key, const std::set<std::string>& known);

}  // namespace photorque
