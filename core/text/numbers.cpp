#include "core/text/numbers.h"

#include <charconv>
#include <cmath>

#include "core/text/lines.h"

namespace photorque {

std::optional<double> number_in(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [stop, failure] = std::from_chars(text.data(), end, value);
  if (failure != std::errc() || stop != end || text.empty() || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

double require_number(std::string_view text, const InputLocation& where, const std::string& what,
                      const std::string& expected) {
  if (const auto value = number_in(text)) return *value;
  throw InputError(where, what, in_quotes(text), expected);
}

size_t require_count(double value, const InputLocation& where, const std::string& what, int low,
                     int high) {
  if (value == std::floor(value) && value >= low && value <= high) {
    return static_cast<size_t>(value);
  }
  throw InputError(where, what, shortest(value),
                   "a whole number from " + std::to_string(low) + " to " + std::to_string(high));
}

std::string shortest(double value) {
  char text[32];
  const auto [end, failure] = std::to_chars(text, text + sizeof text, value);
  return {text, end};
}

}  // namespace photorque
