// Values of keys: numbers with units and ranges, texts, choices, vectors.
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/settings/read_log.h"

namespace photorque {
std::string describe_range(Range range, double factor, const std::string& unit) {
  const std::string suffix = unit.empty() ? "" : " " + unit;
  const bool has_low = range.low > -1e307, has_high = range.high < 1e307;
  const std::string low = format_setting(range.low / factor),
                    high = format_setting(range.high / factor);
  if (has_low && has_high) {
    return "a number in " + std::string(range.low_open ? "(" : "[") + low + ", " + high +
           (range.high_open ? ")" : "]") + suffix;
  }
  if (has_low) return "a number " + std::string(range.low_open ? "> " : ">= ") + low + suffix;
  if (has_high) return "a number " + std::string(range.high_open ? "< " : "<= ") + high + suffix;
  return "a finite number" + suffix;
}

bool is_inside(double x, Range range) {
  if (!std::isfinite(x)) return false;
  if (range.low_open ? x <= range.low : x < range.low) return false;
  if (range.high_open ? x >= range.high : x > range.high) return false;
  return true;
}

std::string one_of(const std::vector<std::string>& choices) {
  std::string all;
  for (const auto& word : choices) all += (all.empty() ? "\"" : ", \"") + word + "\"";
  return "one of " + all;
}

std::string one_of(const std::vector<std::string>& choices, const std::string& instead_of) {
  const std::string likest = nearest(instead_of, {choices.begin(), choices.end()});
  if (likest.empty()) return one_of(choices);
  // A long list would hide the suggestion.
  const std::string known =
      choices.size() > 10 ? "one of " + std::to_string(choices.size()) + " names" : one_of(choices);
  return known + " (did you mean \"" + likest + "\"?)";
}

double Settings::to_number(const SettingsNode& node, std::string_view key, double factor,
                           Range range) const {
  log_->read.insert(&node);
  // Messages use the user's unit.
  const auto wrong = [&](const std::string& expected) {
    return InputError(node.where, full_name(key), describe(node), expected);
  };
  const auto in_range = [&] {
    return describe_range(range, factor, unit_of_key(as_written(*node_, key)).unit);
  };
  double written = 0.0;
  if (const auto* i = std::get_if<int64_t>(&node.value)) {
    written = static_cast<double>(*i);
  } else if (const auto* d = std::get_if<double>(&node.value)) {
    written = *d;
  } else {
    throw wrong(in_range());
  }
  const double x = written * factor;
  if (!is_inside(x, range)) {
    // A temperature in °C below the coldest admitted one, in a key whose unit is K.
    constexpr double zero_celsius_K = 273.15;
    const bool is_celsius = unit_of_key(key).unit == "K" && range.low >= 1.0 && x < range.low &&
                            is_inside(x + zero_celsius_K, range);
    throw wrong(in_range() + (is_celsius ? "; " + format_setting(written) + " °C are " +
                                               format_setting(x + zero_celsius_K) + " K"
                                         : ""));
  }
  // These limits keep squares and products finite and different from zero, angles accurate within a
  // turn, and positions within the range of single precision. Distances in au (the Sun, planets)
  // may be larger.
  constexpr double smallest = 1e-100;
  if (x != 0.0 && std::abs(x) < smallest) throw wrong("0 or a size of at least 1e-100 in SI units");
  const KeyUnit unit = unit_of_key(key);
  if (unit.unit.empty()) return x;
  const auto [largest, text] = unit.unit == "au"            ? std::pair{1e16, "at most 66000 au"}
                               : unit.dimension == "length" ? std::pair{1e12, "at most 1e12 m"}
                               : unit.dimension == "angle"
                                   ? std::pair{1e9, "at most 1e9 rad"}
                                   : std::pair{1e30, "at most 1e30 in SI units"};
  if (std::abs(x) > largest) throw wrong(text);
  return x;
}

double Settings::number(std::string_view key, Range range) const {
  const KeyUnit unit = unit_of_key(key);
  const Found found = require(key, describe_range(range, unit.to_SI, unit.unit));
  return to_number(*found.node, key, found.factor, range);
}

double Settings::number_or(std::string_view key, double otherwise_SI, Range range) const {
  const Found found = find(key);
  if (found.node == nullptr) return otherwise_SI;
  return to_number(*found.node, key, found.factor, range);
}

Uncertain Settings::uncertain(std::string_view key, Range range) const {
  const auto [node, factor] = require(key, "a number or { value = ..., sigma = ... }");
  if (!node->is_table()) return {to_number(*node, key, factor, range), 0.0};
  const Settings inner(node, root_, log_, full_name(key));
  const SettingsNode& value = *inner.require("value", "a number").node;
  const SettingsNode& sigma = *inner.require("sigma", "a number >= 0").node;
  return {inner.to_number(value, "value", factor, range),
          inner.to_number(sigma, "sigma", factor, Range::not_negative())};
}

Vec3 Settings::to_vector3(const SettingsNode& node, std::string_view key, double factor) const {
  constexpr const char* expected = "an array of 3 numbers";
  const auto& array = as<SettingsNode::Array>(node, key, expected);
  if (array.size() != 3) throw InputError(node.where, full_name(key), describe(node), expected);
  log_->read.insert(&node);
  Vec3 v;
  for (int i = 0; i < 3; ++i) v[i] = to_number(array[static_cast<size_t>(i)], key, factor, {});
  return v;
}

UncertainVec3 Settings::uncertain_vector(std::string_view key) const {
  const auto [node, factor] = require(key, "3 numbers or { value = [...], sigma = [...] }");
  if (!node->is_table()) return {to_vector3(*node, key, factor), Vec3::Zero()};
  const Settings inner(node, root_, log_, full_name(key));
  const SettingsNode& value = *inner.require("value", "an array of 3 numbers").node;
  const SettingsNode& sigma = *inner.require("sigma", "an array of 3 numbers >= 0").node;
  UncertainVec3 both{inner.to_vector3(value, "value", factor),
                     inner.to_vector3(sigma, "sigma", factor)};
  if ((both.sigma.array() < 0.0).any()) {
    throw InputError(sigma.where, inner.full_name("sigma"), "a negative number", "numbers >= 0");
  }
  return both;
}

int64_t Settings::integer(std::string_view key, int64_t low, int64_t high) const {
  const std::string expected =
      "a whole number from " + std::to_string(low) + " to " + std::to_string(high);
  const SettingsNode& node = *require(key, expected).node;
  std::optional<int64_t> whole;
  if (const auto* i = std::get_if<int64_t>(&node.value)) whole = *i;
  // 1e8 is a real number in TOML, and the natural way to write a count.
  const auto* d = std::get_if<double>(&node.value);
  if (d != nullptr && std::abs(*d) < 0x1p53 && *d == std::floor(*d))
    whole = static_cast<int64_t>(*d);
  if (!whole || *whole < low || *whole > high) {
    throw InputError(node.where, full_name(key), describe(node), expected);
  }
  return *whole;
}

bool Settings::flag_or(std::string_view key, bool otherwise) const {
  const SettingsNode* node = find(key).node;
  return node == nullptr ? otherwise : as<bool>(*node, key, "true or false");
}

std::string Settings::text(std::string_view key) const {
  constexpr const char* expected = "a text in quotes";
  return as<std::string>(*require(key, expected).node, key, expected);
}

std::string Settings::text_or(std::string_view key, std::string_view otherwise) const {
  return has(key) ? text(key) : std::string(otherwise);
}

size_t Settings::choice(std::string_view key, const std::vector<std::string>& choices) const {
  const SettingsNode& node = *require(key, one_of(choices)).node;
  const auto& word = as<std::string>(node, key, one_of(choices));
  const auto it = std::find(choices.begin(), choices.end(), word);
  if (it != choices.end()) return static_cast<size_t>(it - choices.begin());
  throw InputError(node.where, full_name(key), describe(node), one_of(choices, word));
}

size_t Settings::choice_or(std::string_view key, const std::vector<std::string>& choices,
                           size_t otherwise) const {
  return has(key) ? choice(key, choices) : otherwise;
}

Vec3 Settings::vector3(std::string_view key) const {
  const auto [node, factor] = require(key, "an array of 3 numbers");
  return to_vector3(*node, key, factor);
}

Mat3 Settings::matrix3(std::string_view key) const {
  constexpr const char* expected = "an array of 3 rows of 3 numbers";
  const auto [node, factor] = require(key, expected);
  const auto& rows = as<SettingsNode::Array>(*node, key, expected);
  if (rows.size() != 3 || !std::ranges::all_of(rows, &SettingsNode::is_array)) {
    throw InputError(node->where, full_name(key), describe(*node), expected);
  }
  Mat3 m;
  for (int i = 0; i < 3; ++i) {
    m.row(i) = to_vector3(rows[static_cast<size_t>(i)], key, factor).transpose();
  }
  return m;
}

std::vector<Vec3> Settings::vectors3(std::string_view key) const {
  constexpr const char* expected = "an array of arrays of 3 numbers";
  const auto [node, factor] = require(key, expected);
  const auto& array = as<SettingsNode::Array>(*node, key, expected);
  if (array.empty()) throw InputError(node->where, full_name(key), describe(*node), expected);
  std::vector<Vec3> all;
  for (const auto& item : array) all.push_back(to_vector3(item, key, factor));
  return all;
}

std::vector<double> Settings::numbers(std::string_view key, Range range) const {
  constexpr const char* expected = "an array of numbers";
  const auto [node, factor] = require(key, expected);
  std::vector<double> all;
  for (const auto& item : as<SettingsNode::Array>(*node, key, expected)) {
    all.push_back(to_number(item, key, factor, range));
  }
  return all;
}

std::vector<std::string> Settings::texts(std::string_view key) const {
  constexpr const char* expected = "an array of texts";
  std::vector<std::string> all;
  for (const auto& item : as<SettingsNode::Array>(*require(key, expected).node, key, expected)) {
    all.push_back(as<std::string>(item, key, "a text"));
    log_->read.insert(&item);
  }
  return all;
}

}  // namespace photorque
