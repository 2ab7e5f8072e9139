// Typed access to the user's keys, in files and on the command line.
//
// A reader (TOML, glTF extras, command line) fills a tree of SettingsNode; the program reads it
// through Settings. Every value is converted to SI here and nowhere else, from the unit that its
// key names as a suffix. A key that was not requested is an error that suggests the nearest
// requested key.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/errors.h"
#include "core/transform.h"

namespace photorque {

// One value as written. Tables keep their keys sorted.
struct SettingsNode {
  using Array = std::vector<SettingsNode>;
  using Table = std::map<std::string, SettingsNode, std::less<>>;
  std::variant<bool, int64_t, double, std::string, Array, Table> value = Table{};
  InputLocation where = {};

  bool is_table() const { return std::holds_alternative<Table>(value); }
  bool is_array() const { return std::holds_alternative<Array>(value); }
  bool is_number() const {
    return std::holds_alternative<int64_t>(value) || std::holds_alternative<double>(value);
  }
};

// Calls `visit` with the node and with every node below it, each before those below itself.
template <class Node, class Visit>
void for_each_node(Node& node, const Visit& visit) {
  visit(node);
  if (auto* table = std::get_if<SettingsNode::Table>(&node.value)) {
    for (auto& [key, item] : *table) for_each_node(item, visit);
  } else if (auto* items = std::get_if<SettingsNode::Array>(&node.value)) {
    for (auto& item : *items) for_each_node(item, visit);
  }
}

// A short description for error messages: "-3", "\"abc\"", "an array of 2".
std::string describe(const SettingsNode& node);

// Closed or open bounds on a number, in SI units. The default admits every finite number.
struct Range {
  double low = -1e308;
  double high = 1e308;
  bool low_open = false;
  bool high_open = false;

  static constexpr Range positive() { return {0.0, 1e308, true, false}; }
  static constexpr Range not_negative() { return {0.0, 1e308, false, false}; }
  static constexpr Range fraction() { return {0.0, 1.0, false, false}; }
};

// A number with the user's one-sigma uncertainty (0: exact). SI units.
struct Uncertain {
  double value = 0.0;
  double sigma = 0.0;
};
struct UncertainVec3 {
  Vec3 value = Vec3::Zero();
  Vec3 sigma = Vec3::Zero();
};

// A view of one table. Copies share the record of which keys were read.
//
// Keys carry their unit: `number("radius_m")` also accepts `radius_mm` when the user wrote that,
// and always returns metres. Known suffixes are those of unit_of_key() below. Angles return radians
// whatever the key says.
//
// Every accessor throws InputError with file, line, key, the value found and the value expected
// when the key is missing (unless a default is given), of the wrong type, not finite, or out of
// range.
class Settings {
 public:
  // `name` is the name of this table in messages; empty for the root of a file.
  explicit Settings(std::shared_ptr<const SettingsNode> root, std::string name = "");
  explicit Settings(SettingsNode root = {}, std::string name = "")
      : Settings(std::make_shared<const SettingsNode>(std::move(root)), std::move(name)) {}

  bool has(std::string_view key) const;

  // The value of a typed key (core/settings/typed_keys.h) within its range. If the user did not
  // write it: its default, or `otherwise`.
  template <class TypedKey>
  auto get(const TypedKey& key) const {
    return key.read(*this);
  }
  template <class TypedKey, class Value>
  auto get_or(const TypedKey& key, const Value& otherwise) const -> decltype(key.read(*this)) {
    if (!has(key)) return otherwise;
    return key.read(*this);
  }

  double number(std::string_view key, Range range = {}) const;
  double number_or(std::string_view key, double otherwise_SI, Range range = {}) const;
  Uncertain uncertain(std::string_view key, Range range = {}) const;
  UncertainVec3 uncertain_vector(std::string_view key) const;
  // A real number without a fractional part, such as 1e8, is accepted.
  int64_t integer(std::string_view key, int64_t low, int64_t high) const;
  bool flag_or(std::string_view key, bool otherwise) const;
  std::string text(std::string_view key) const;
  std::string text_or(std::string_view key, std::string_view otherwise) const;
  // One of `choices`, returned as its index; the message lists them.
  size_t choice(std::string_view key, const std::vector<std::string>& choices) const;
  size_t choice_or(std::string_view key, const std::vector<std::string>& choices,
                   size_t otherwise) const;
  Vec3 vector3(std::string_view key) const;
  Mat3 matrix3(std::string_view key) const;
  // An array of points or directions, at least one.
  std::vector<Vec3> vectors3(std::string_view key) const;
  std::vector<double> numbers(std::string_view key, Range range = {}) const;
  std::vector<std::string> texts(std::string_view key) const;

  // A sub-table; throws InputError if absent.
  Settings table(std::string_view key) const;
  // A sub-table; without keys if absent.
  Settings table_or_empty(std::string_view key) const;
  // The tables of an array of tables, `[[key]]`; empty when absent. A single table counts as one.
  std::vector<Settings> tables(std::string_view key) const;
  // The keys of this table as the user wrote them.
  std::vector<std::string> keys() const;
  // The value as written, marked as read with everything below it.
  const SettingsNode& raw(std::string_view key) const;

  InputLocation where() const;
  const std::string& name() const { return name_; }
  // Creates an error about a value of this table, for checks by the caller.
  InputError error(std::string_view key, const std::string& found,
                   const std::string& expected) const;

  // Throws InputError for the first key, here or below, that was not read.
  void finish() const;

 private:
  struct Log;
  Settings(const SettingsNode* node, std::shared_ptr<const SettingsNode> root,
           std::shared_ptr<Log> log, std::string name);
  // A value and the SI factor of the unit that its key names; null if there is no such key.
  struct Found {
    const SettingsNode* node = nullptr;
    double factor = 1.0;
  };
  const SettingsNode::Table& written() const;
  Found find(std::string_view key) const;
  Found require(std::string_view key, const std::string& expected) const;
  template <class Value>
  const Value& as(const SettingsNode& node, std::string_view key,
                  const std::string& expected) const;
  double to_number(const SettingsNode& node, std::string_view key, double factor,
                   Range range) const;
  Vec3 to_vector3(const SettingsNode& node, std::string_view key, double factor) const;
  std::string full_name(std::string_view key) const;

  const SettingsNode* node_;
  std::shared_ptr<const SettingsNode> root_;
  std::shared_ptr<Log> log_;
  std::string name_;
};

// The unit suffix of a key and its SI factor: "fwhm_deg" → {stem "fwhm", unit "deg",
// dimension "angle", factor π/180}. A key without a known suffix has factor 1 and no unit.
struct KeyUnit {
  std::string stem;
  std::string unit;
  std::string dimension;
  double to_SI = 1.0;
};
KeyUnit unit_of_key(std::string_view key);

// The candidate nearest to `word` by edit distance, or empty if none is similar.
std::string nearest(std::string_view word, const std::set<std::string>& candidates);

// The names that a message suggests instead of `wanted`: "perhaps \"b\", of \"a\", \"b\" and 7
// more", at most 12, with the nearest by nearest() first. Empty names are left out; "none" if there
// is no other.
std::string listed_names(std::set<std::string> names, std::string_view wanted);

}  // namespace photorque
