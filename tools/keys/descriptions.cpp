#include "tools/keys/registry.h"

#include <cmath>
#include <sstream>

#include "core/text/format.h"
#include "scenes/experiment/document.h"

namespace photorque {
namespace {

std::string quoted(const std::string& word) {
  return "`\"" + word + "\"`";
}

// A count as text; large powers of two as "2^n".
std::string count_in_words(int64_t count) {
  constexpr int64_t short_enough = 1 << 20;
  if (count < short_enough) return std::to_string(count);
  for (int power = 20; power < 63; ++power) {
    if (count == int64_t{1} << power) return "2^" + std::to_string(power);
  }
  const double log = std::log10(static_cast<double>(count));
  if (log == std::floor(log)) return "1e" + std::to_string(static_cast<int>(log));
  return std::to_string(count);
}

std::string interval(const Range& range, double to_SI) {
  const bool has_low = range.low > -1e307, has_high = range.high < 1e307;
  const std::string low = short_number(range.low / to_SI), high = short_number(range.high / to_SI);
  if (has_low && has_high) {
    return (range.low_open ? "(" : "[") + low + ", " + high + (range.high_open ? ")" : "]");
  }
  if (has_low) return (range.low_open ? "> " : "≥ ") + low;
  if (has_high) return (range.high_open ? "< " : "≤ ") + high;
  return "";
}

}  // namespace

std::string short_number(double x) {
  std::ostringstream out;
  out.precision(6);
  out << x;
  return out.str();
}

std::string range_in_words(const Key& key) {
  if (key.type == Key::Type::integer) {
    if (key.high == INT64_MAX) return "≥ " + std::to_string(key.low);
    return count_in_words(key.low) + " … " + count_in_words(key.high);
  }
  if (key.type == Key::Type::choice) {
    return joined_text(key.choices, ", ",
                       [&](const Key::Choice& choice) { return quoted(choice.name); });
  }
  if (key.type != Key::Type::number && key.type != Key::Type::numbers) return "";
  return interval(key.range, unit_of_key(key.name).to_SI);
}

std::string default_in_words(const Key& key) {
  if (!key.usually.empty()) return key.usually;
  if (!key.otherwise) return key.required ? "required" : "";
  if (const auto* real = std::get_if<double>(&key.otherwise->value)) return short_number(*real);
  if (const auto* whole = std::get_if<int64_t>(&key.otherwise->value)) {
    return count_in_words(*whole);
  }
  if (const auto* text = std::get_if<std::string>(&key.otherwise->value)) {
    return text->empty() ? "" : quoted(*text);
  }
  return toml_value(*key.otherwise);
}

std::string choices_in_words(const Key& key) {
  std::string words;
  for (const Key::Choice& choice : key.choices) {
    if (choice.what.empty()) continue;
    words += (words.empty() ? "" : "; ") + quoted(choice.name) + ": " + choice.what;
  }
  return words;
}

std::string description_of(const Key& key) {
  std::string text = key.what;
  const std::string words = choices_in_words(key);
  if (!words.empty()) text += ". " + words;
  const KeyUnit unit = unit_of_key(key.name);
  if (!unit.unit.empty()) text += ". Unit: " + unit.unit + " (" + unit.dimension + ")";
  const std::string range = range_in_words(key);
  if (!range.empty() && key.type != Key::Type::choice) text += ". Range: " + range;
  const std::string otherwise = default_in_words(key);
  if (otherwise == "required") {
    text += ". Required";
  } else if (!otherwise.empty()) {
    text += ". Default: " + otherwise;
  }
  if (key.has_error) text += ". May be { value = …, sigma = … }";
  return text + ".";
}

}  // namespace photorque
