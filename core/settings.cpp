#include "core/settings.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

#include "core/constants.h"

namespace photorque {
namespace {

struct Unit {
  const char* suffix;
  const char* dimension;
  double to_SI;
};

// Longest suffix first where one ends in another ("_N_m" before "_m").
constexpr Unit units[] = {
    {"kg_m2", "inertia", 1.0},
    {"m_per_Ah", "shift per charge", 1.0 / 3600.0},
    {"kg_m3", "density", 1.0},
    {"N_m_s", "angular momentum", 1.0},
    {"N_m", "torque", 1.0},
    {"mN_m", "torque", 1e-3},
    {"uN_m", "torque", 1e-6},
    {"W_m2", "irradiance", 1.0},
    {"mW_cm2", "irradiance", 10.0},
    {"W_sr", "radiant intensity", 1.0},
    {"m_s2", "acceleration", 1.0},
    {"m_s", "speed", 1.0},
    {"rad_s", "angular rate", 1.0},
    {"deg_s", "angular rate", degree_rad},
    {"rpm", "angular rate", pi / 30},
    {"A_m2", "magnetic dipole", 1.0},
    {"A_W", "responsivity", 1.0},
    {"A_m2K3", "saturation", 1.0},
    {"V_K", "voltage per temperature", 1.0},
    {"deg", "angle", degree_rad},
    {"rad", "angle", 1.0},
    {"mrad", "angle", 1e-3},
    {"arcmin", "angle", degree_rad / 60},
    {"arcsec", "angle", arcsecond_rad},
    {"km", "length", 1e3},
    {"mm", "length", 1e-3},
    {"um", "length", 1e-6},
    {"nm", "length", 1e-9},
    {"cm", "length", 1e-2},
    {"m", "length", 1.0},
    {"kg", "mass", 1.0},
    {"g", "mass", 1e-3},
    {"kW", "power", 1e3},
    {"mW", "power", 1e-3},
    {"W", "power", 1.0},
    {"Wh", "energy", 3600.0},
    {"J", "energy", 1.0},
    {"Ah", "charge", 3600.0},
    {"mAh", "charge", 3.6},
    {"C", "charge", 1.0},
    {"mA", "current", 1e-3},
    {"A", "current", 1.0},
    {"mV", "voltage", 1e-3},
    {"V", "voltage", 1.0},
    {"ohm", "resistance", 1.0},
    {"mohm", "resistance", 1e-3},
    {"K", "temperature", 1.0},
    {"Hz", "frequency", 1.0},
    {"kHz", "frequency", 1e3},
    {"ms", "time", 1e-3},
    {"us", "time", 1e-6},
    {"min", "time", 60.0},
    {"h", "time", 3600.0},
    {"s", "time", 1.0},
    {"Pa", "pressure", 1.0},
    {"bar", "pressure", 1e5},
    {"T", "magnetic field", 1.0},
    {"uT", "magnetic field", 1e-6},
    {"nT", "magnetic field", 1e-9},
    {"N", "force", 1.0},
};

bool ends_with_unit(std::string_view key, std::string_view suffix) {
  return key.size() > suffix.size() + 1 && key.ends_with(suffix) &&
         key[key.size() - suffix.size() - 1] == '_';
}

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

std::string format(double x) {
  std::ostringstream out;
  out.precision(12);
  out << x;
  return out.str();
}

std::string describe_range(Range range, double factor, const std::string& unit) {
  const std::string suffix = unit.empty() ? "" : " " + unit;
  const bool has_low = range.low > -1e307, has_high = range.high < 1e307;
  const std::string low = format(range.low / factor), high = format(range.high / factor);
  if (has_low && has_high) {
    return "a number in " + std::string(range.low_open ? "(" : "[") + low + ", " + high +
           (range.high_open ? ")" : "]") + suffix;
  }
  if (has_low) return "a number " + std::string(range.low_open ? "> " : ">= ") + low + suffix;
  if (has_high) return "a number " + std::string(range.high_open ? "< " : "<= ") + high + suffix;
  return "a finite number" + suffix;
}

bool inside(double x, Range range) {
  if (!std::isfinite(x)) return false;
  if (range.low_open ? x <= range.low : x < range.low) return false;
  if (range.high_open ? x >= range.high : x > range.high) return false;
  return true;
}

std::string join(const std::vector<std::string>& words) {
  std::string all;
  for (const auto& word : words) all += (all.empty() ? "\"" : ", \"") + word + "\"";
  return all;
}

}  // namespace

std::string describe(const SettingsNode& node) {
  if (const auto* b = std::get_if<bool>(&node.value)) return *b ? "true" : "false";
  if (const auto* i = std::get_if<int64_t>(&node.value)) return std::to_string(*i);
  if (const auto* d = std::get_if<double>(&node.value)) return format(*d);
  if (const auto* s = std::get_if<std::string>(&node.value)) return "\"" + *s + "\"";
  if (const auto* a = std::get_if<SettingsNode::Array>(&node.value)) {
    return "an array of " + std::to_string(a->size());
  }
  return "a table";
}

KeyUnit unit_of_key(std::string_view key) {
  const Unit* best = nullptr;
  for (const Unit& unit : units) {
    const std::string_view suffix = unit.suffix;
    if (ends_with_unit(key, suffix) &&
        (best == nullptr || suffix.size() > std::string_view(best->suffix).size())) {
      best = &unit;
    }
  }
  if (best == nullptr) return {std::string(key), "", "", 1.0};
  const std::string_view suffix = best->suffix;
  return {std::string(key.substr(0, key.size() - suffix.size() - 1)), best->suffix, best->dimension,
          best->to_SI};
}

std::string nearest(std::string_view word, const std::set<std::string>& candidates) {
  std::string best;
  size_t best_distance = std::max<size_t>(2, word.size() / 2) + 1;
  for (const auto& candidate : candidates) {
    const size_t distance = edit_distance(word, candidate);
    if (distance < best_distance) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

// What was read and what was asked for: shared by all views of one root, so that finish() on the
// root sees what every part of the program did.
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

Settings::Settings(std::shared_ptr<const SettingsNode> root, std::string name)
    : node_(root.get()),
      root_(std::move(root)),
      log_(std::make_shared<Log>()),
      name_(std::move(name)) {}

Settings::Settings(const SettingsNode* node, std::shared_ptr<const SettingsNode> root,
                   std::shared_ptr<Log> log, std::string name)
    : node_(node), root_(std::move(root)), log_(std::move(log)), name_(std::move(name)) {}

std::string Settings::full_name(std::string_view key) const {
  if (name_.empty()) return std::string(key);
  return key.empty() ? name_ : name_ + "." + std::string(key);
}

InputLocation Settings::where() const {
  return node_->where;
}

InputError Settings::error(std::string_view key, const std::string& found,
                           const std::string& expected) const {
  const auto& table = std::get<SettingsNode::Table>(node_->value);
  const auto it = table.find(key);
  return {it == table.end() ? node_->where : it->second.where, full_name(key), found, expected};
}

const SettingsNode* Settings::find(std::string_view key, double* factor) const {
  log_->asked[node_].insert(std::string(key));
  const auto& table = std::get<SettingsNode::Table>(node_->value);
  const KeyUnit wanted = unit_of_key(key);
  *factor = wanted.to_SI;
  const auto exact = table.find(key);
  const SettingsNode* found = exact == table.end() ? nullptr : &exact->second;
  if (!wanted.unit.empty()) {
    for (const auto& [other_key, node] : table) {
      if (other_key == key) continue;
      const KeyUnit other = unit_of_key(other_key);
      if (other.stem != wanted.stem || other.dimension != wanted.dimension) continue;
      if (found != nullptr) {
        throw InputError(
            node.where, full_name(other_key),
            "the same quantity as " + std::string(exact == table.end() ? "another key" : key),
            "it once");
      }
      found = &node;
      *factor = other.to_SI;
    }
  }
  if (found != nullptr) log_->read.insert(found);
  return found;
}

const SettingsNode& Settings::require(std::string_view key, double* factor,
                                      const std::string& expected) const {
  if (const SettingsNode* node = find(key, factor)) return *node;
  // A key of the same stem with no or a wrong unit is the likeliest mistake.
  const KeyUnit wanted = unit_of_key(key);
  if (!wanted.unit.empty()) {
    for (const auto& [other_key, node] : std::get<SettingsNode::Table>(node_->value)) {
      if (other_key == wanted.stem || unit_of_key(other_key).stem == wanted.stem) {
        throw InputError(node.where, full_name(other_key),
                         "a key without a unit of " + wanted.dimension,
                         "the key " + std::string(key));
      }
    }
  }
  throw InputError(node_->where, full_name(key), "nothing", expected);
}

bool Settings::has(std::string_view key) const {
  log_->asked[node_].insert(std::string(key));
  const auto& table = std::get<SettingsNode::Table>(node_->value);
  if (table.contains(key)) return true;
  const KeyUnit wanted = unit_of_key(key);
  if (wanted.unit.empty()) return false;
  return std::any_of(table.begin(), table.end(), [&](const auto& item) {
    const KeyUnit other = unit_of_key(item.first);
    return other.stem == wanted.stem && other.dimension == wanted.dimension;
  });
}

double Settings::to_number(const SettingsNode& node, std::string_view key, double factor,
                           Range range) const {
  const std::string expected = describe_range(range, factor, unit_of_key(key).unit);
  log_->read.insert(&node);
  double written = 0.0;
  if (const auto* i = std::get_if<int64_t>(&node.value)) {
    written = static_cast<double>(*i);
  } else if (const auto* d = std::get_if<double>(&node.value)) {
    written = *d;
  } else {
    throw InputError(node.where, full_name(key), describe(node), expected);
  }
  const double x = written * factor;
  if (!inside(x, range)) throw InputError(node.where, full_name(key), describe(node), expected);
  return x;
}

double Settings::number(std::string_view key, Range range) const {
  double factor = 1.0;
  const SettingsNode& node =
      require(key, &factor, describe_range(range, unit_of_key(key).to_SI, unit_of_key(key).unit));
  return to_number(node, key, factor, range);
}

double Settings::number_or(std::string_view key, double otherwise_SI, Range range) const {
  double factor = 1.0;
  const SettingsNode* node = find(key, &factor);
  return node == nullptr ? otherwise_SI : to_number(*node, key, factor, range);
}

Uncertain Settings::uncertain(std::string_view key, Range range) const {
  double factor = 1.0;
  const SettingsNode& node = require(key, &factor, "a number or { value = ..., sigma = ... }");
  if (!node.is_table()) return {to_number(node, key, factor, range), 0.0};
  const Settings inner(&node, root_, log_, full_name(key));
  double unused = 1.0;
  const SettingsNode& value = inner.require("value", &unused, "a number");
  const SettingsNode& sigma = inner.require("sigma", &unused, "a number >= 0");
  return {inner.to_number(value, "value", factor, range),
          inner.to_number(sigma, "sigma", factor, Range::not_negative())};
}

Vec3 Settings::to_vector3(const SettingsNode& node, std::string_view key, double factor) const {
  const auto* array = std::get_if<SettingsNode::Array>(&node.value);
  if (array == nullptr || array->size() != 3) {
    throw InputError(node.where, full_name(key), describe(node), "an array of 3 numbers");
  }
  log_->read.insert(&node);
  Vec3 v;
  for (int i = 0; i < 3; ++i) v[i] = to_number((*array)[static_cast<size_t>(i)], key, factor, {});
  return v;
}

UncertainVec3 Settings::uncertain_vector(std::string_view key) const {
  double factor = 1.0;
  const SettingsNode& node = require(key, &factor, "3 numbers or { value = [...], sigma = [...] }");
  if (!node.is_table()) return {to_vector3(node, key, factor), Vec3::Zero()};
  const Settings inner(&node, root_, log_, full_name(key));
  double unused = 1.0;
  const SettingsNode& value = inner.require("value", &unused, "an array of 3 numbers");
  const SettingsNode& sigma = inner.require("sigma", &unused, "an array of 3 numbers >= 0");
  const UncertainVec3 both{inner.to_vector3(value, "value", factor),
                           inner.to_vector3(sigma, "sigma", factor)};
  if ((both.sigma.array() < 0.0).any()) {
    throw InputError(sigma.where, inner.full_name("sigma"), "a negative number", "numbers >= 0");
  }
  return both;
}

int64_t Settings::integer(std::string_view key, int64_t low, int64_t high) const {
  double factor = 1.0;
  const std::string expected =
      "a whole number from " + std::to_string(low) + " to " + std::to_string(high);
  const SettingsNode& node = require(key, &factor, expected);
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

int64_t Settings::integer_or(std::string_view key, int64_t otherwise, int64_t low,
                             int64_t high) const {
  return has(key) ? integer(key, low, high) : otherwise;
}

bool Settings::flag_or(std::string_view key, bool otherwise) const {
  double factor = 1.0;
  const SettingsNode* node = find(key, &factor);
  if (node == nullptr) return otherwise;
  const auto* b = std::get_if<bool>(&node->value);
  if (b == nullptr) throw InputError(node->where, full_name(key), describe(*node), "true or false");
  return *b;
}

std::string Settings::text(std::string_view key) const {
  double factor = 1.0;
  const SettingsNode& node = require(key, &factor, "a text in quotes");
  const auto* s = std::get_if<std::string>(&node.value);
  if (s == nullptr)
    throw InputError(node.where, full_name(key), describe(node), "a text in quotes");
  return *s;
}

std::string Settings::text_or(std::string_view key, std::string_view otherwise) const {
  return has(key) ? text(key) : std::string(otherwise);
}

size_t Settings::choice(std::string_view key, const std::vector<std::string>& choices) const {
  const std::string expected = "one of " + join(choices);
  double factor = 1.0;
  const SettingsNode& node = require(key, &factor, expected);
  const auto* s = std::get_if<std::string>(&node.value);
  if (s != nullptr) {
    const auto it = std::find(choices.begin(), choices.end(), *s);
    if (it != choices.end()) return static_cast<size_t>(it - choices.begin());
    const std::string hint = nearest(*s, {choices.begin(), choices.end()});
    if (!hint.empty()) {
      // A long list would hide the hint.
      const std::string known =
          choices.size() > 10 ? "one of " + std::to_string(choices.size()) + " names" : expected;
      throw InputError(node.where, full_name(key), describe(node),
                       known + " (did you mean \"" + hint + "\"?)");
    }
  }
  throw InputError(node.where, full_name(key), describe(node), expected);
}

size_t Settings::choice_or(std::string_view key, const std::vector<std::string>& choices,
                           size_t otherwise) const {
  return has(key) ? choice(key, choices) : otherwise;
}

Vec3 Settings::vector3(std::string_view key) const {
  double factor = 1.0;
  const SettingsNode& node = require(key, &factor, "an array of 3 numbers");
  return to_vector3(node, key, factor);
}

Vec3 Settings::vector3_or(std::string_view key, const Vec3& otherwise_SI) const {
  double factor = 1.0;
  const SettingsNode* node = find(key, &factor);
  return node == nullptr ? otherwise_SI : to_vector3(*node, key, factor);
}

Mat3 Settings::matrix3(std::string_view key) const {
  double factor = 1.0;
  const SettingsNode& node = require(key, &factor, "an array of 3 rows of 3 numbers");
  const auto* rows = std::get_if<SettingsNode::Array>(&node.value);
  if (rows == nullptr || rows->size() != 3) {
    throw InputError(node.where, full_name(key), describe(node), "an array of 3 rows of 3 numbers");
  }
  Mat3 m;
  for (int i = 0; i < 3; ++i) {
    m.row(i) = to_vector3((*rows)[static_cast<size_t>(i)], key, factor).transpose();
  }
  return m;
}

std::vector<Vec3> Settings::vectors3(std::string_view key) const {
  double factor = 1.0;
  const std::string expected = "an array of arrays of 3 numbers";
  const SettingsNode& node = require(key, &factor, expected);
  const auto* array = std::get_if<SettingsNode::Array>(&node.value);
  if (array == nullptr || array->empty()) {
    throw InputError(node.where, full_name(key), describe(node), expected);
  }
  std::vector<Vec3> all;
  for (const auto& item : *array) all.push_back(to_vector3(item, key, factor));
  return all;
}

std::vector<double> Settings::numbers(std::string_view key, Range range) const {
  double factor = 1.0;
  const SettingsNode& node = require(key, &factor, "an array of numbers");
  const auto* array = std::get_if<SettingsNode::Array>(&node.value);
  if (array == nullptr) {
    throw InputError(node.where, full_name(key), describe(node), "an array of numbers");
  }
  std::vector<double> all;
  for (const auto& item : *array) all.push_back(to_number(item, key, factor, range));
  return all;
}

std::vector<std::string> Settings::texts(std::string_view key) const {
  double factor = 1.0;
  const SettingsNode& node = require(key, &factor, "an array of texts");
  const auto* array = std::get_if<SettingsNode::Array>(&node.value);
  if (array == nullptr) {
    throw InputError(node.where, full_name(key), describe(node), "an array of texts");
  }
  std::vector<std::string> all;
  for (const auto& item : *array) {
    const auto* s = std::get_if<std::string>(&item.value);
    if (s == nullptr) throw InputError(item.where, full_name(key), describe(item), "a text");
    log_->read.insert(&item);
    all.push_back(*s);
  }
  return all;
}

Settings Settings::table(std::string_view key) const {
  double factor = 1.0;
  const SettingsNode& node = require(key, &factor, "a table [" + full_name(key) + "]");
  if (!node.is_table()) throw InputError(node.where, full_name(key), describe(node), "a table");
  return {&node, root_, log_, full_name(key)};
}

std::vector<Settings> Settings::tables(std::string_view key) const {
  double factor = 1.0;
  const SettingsNode* node = find(key, &factor);
  std::vector<Settings> all;
  if (node == nullptr) return all;
  if (node->is_table()) {
    all.push_back({node, root_, log_, full_name(key)});
    return all;
  }
  const auto* array = std::get_if<SettingsNode::Array>(&node->value);
  if (array == nullptr)
    throw InputError(node->where, full_name(key), describe(*node),
                     "tables [[" + full_name(key) + "]]");
  for (size_t i = 0; i < array->size(); ++i) {
    const SettingsNode& item = (*array)[i];
    const std::string item_name = full_name(key) + "[" + std::to_string(i) + "]";
    if (!item.is_table()) throw InputError(item.where, item_name, describe(item), "a table");
    log_->read.insert(&item);
    all.push_back({&item, root_, log_, item_name});
  }
  return all;
}

std::vector<std::string> Settings::keys() const {
  std::vector<std::string> all;
  for (const auto& [key, node] : std::get<SettingsNode::Table>(node_->value)) all.push_back(key);
  return all;
}

const SettingsNode& Settings::raw(std::string_view key) const {
  double factor = 1.0;
  const SettingsNode& node = require(key, &factor, "a value");
  log_->mark_all(node);
  return node;
}

void Settings::finish() const {
  for (const auto& [key, node] : std::get<SettingsNode::Table>(node_->value)) {
    if (!log_->read.contains(&node)) {
      const auto asked = log_->asked.find(node_);
      const std::string hint = asked == log_->asked.end() ? "" : nearest(key, asked->second);
      throw InputError(
          node.where, full_name(key), "an unknown key",
          hint.empty() ? "only known keys here" : "a known key, perhaps \"" + hint + "\"");
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
