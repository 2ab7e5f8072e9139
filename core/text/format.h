// Formatting of text and numbers for files and figures.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace photorque {

// Formats values like std::printf().
[[gnu::format(printf, 1, 2)]] std::string printed(const char* format, ...);

// The items as texts, with `separator` between them.
template <class Items, class Text = std::identity>
std::string joined_text(const Items& items, std::string_view separator, const Text& text = {}) {
  std::string all;
  for (const auto& item : items) {
    if (!all.empty()) all += separator;
    all += std::invoke(text, item);
  }
  return all;
}

// Valid UTF-8 without control characters: others become U+FFFD or a space. Names come from users'
// files, and one invalid byte would make cairo and JSON readers fail.
std::string clean_text(std::string_view text);

// The number of leading bytes of `text` (valid UTF-8, not empty) that make one character.
size_t first_character_bytes(std::string_view text);

// `text` as content or attribute value of an XML element.
std::string xml_text(std::string_view text);

// A text quoted as one word of a shell.
std::string shell_word(const std::string& word);

// The shortest decimal that reads back as the same double: "0.1", "1.127e-09", "inf"; empty for
// NaN.
std::string round_trip_number(double value);

// A number as printed: `significant` digits, a true minus sign, and a power of ten outside [1e-3,
// 1e5): "812.3", "−1.127×10⁻⁹". NaN is "–".
std::string readable_number(double value, int significant = 4);

// The text with true minus signs instead of hyphens.
std::string with_true_minus(std::string text);

// "10⁻⁹" for −9; empty for 0.
std::string power_of_ten(int exponent);

// An axis label or a unit as (part of) the name of a column, in ASCII: "tilt [deg]" → "tilt_deg",
// "W/m²" → "W_m2", "N m" → "N_m".
std::string column_name(std::string_view label);

// Bytes as text that may stand in JSON, URIs and HTML.
// Source: RFC 4648, section 4, with padding.
std::string base64(std::span<const std::byte> bytes);

}  // namespace photorque
