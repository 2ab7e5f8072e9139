#include "core/text/format.h"

#include <charconv>
#include <cstdarg>
#include <cstdint>
#include <cstdio>

namespace photorque {
namespace {

constexpr std::array<std::string_view, 10> superscripts = {"⁰", "¹", "²", "³", "⁴",
                                                           "⁵", "⁶", "⁷", "⁸", "⁹"};

// Bytes of the valid UTF-8 character at the start of `text`, or 0 (RFC 3629, section 4).
size_t valid_character_bytes(std::string_view text) {
  const auto byte = [&](size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
  };
  const auto continues = [&](size_t i) { return (byte(i) & 0xC0u) == 0x80u; };
  const unsigned lead = byte(0);
  if (lead < 0x80) return 1;
  if (lead >= 0xC2 && lead <= 0xDF) return continues(1) ? 2 : 0;
  if (lead >= 0xE0 && lead <= 0xEF) {
    const bool overlong = lead == 0xE0 && byte(1) < 0xA0;
    const bool surrogate = lead == 0xED && byte(1) > 0x9F;
    return continues(1) && continues(2) && !overlong && !surrogate ? 3 : 0;
  }
  if (lead >= 0xF0 && lead <= 0xF4) {
    const bool overlong = lead == 0xF0 && byte(1) < 0x90;
    const bool beyond_unicode = lead == 0xF4 && byte(1) > 0x8F;
    return continues(1) && continues(2) && continues(3) && !overlong && !beyond_unicode ? 4 : 0;
  }
  return 0;
}

// Whether the character is one of U+0080 to U+009F, which some terminals treat as escape sequences.
bool is_high_control(std::string_view character) {
  return character.size() > 1 && character[0] == '\xC2' &&
         static_cast<unsigned char>(character[1]) < 0xA0;
}

}  // namespace

std::string printed(const char* format, ...) {
  std::va_list values, again;
  va_start(values, format);
  va_copy(again, values);
  std::string text(static_cast<size_t>(std::vsnprintf(nullptr, 0, format, values)), '\0');
  std::vsnprintf(text.data(), text.size() + 1, format, again);
  va_end(again);
  va_end(values);
  return text;
}

std::string clean_text(std::string_view text) {
  std::string clean;
  while (!text.empty()) {
    const size_t bytes = valid_character_bytes(text);
    const auto lead = static_cast<unsigned char>(text.front());
    if (bytes == 0) {
      clean += "\uFFFD";
    } else if (lead < 0x20 || lead == 0x7F || is_high_control(text)) {
      clean += ' ';
    } else {
      clean += text.substr(0, bytes);
    }
    text.remove_prefix(std::max<size_t>(bytes, 1));
  }
  return clean;
}

size_t first_character_bytes(std::string_view text) {
  return std::max<size_t>(valid_character_bytes(text), 1);
}

std::string xml_text(std::string_view text) {
  std::string escaped;
  for (const char c : clean_text(text)) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string shell_word(const std::string& word) {
  static constexpr const char* plain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./=:,+-";
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
  const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
  if (std::ranges::any_of(word, is_control)) {
    // ANSI-C quoting of bash and zsh, and of POSIX since 2024: the word stays on one line.
    std::string text = "$'";
    for (const char c : word) {
      if (is_control(static_cast<unsigned char>(c))) {
        text += printed("\\%03o", static_cast<unsigned>(static_cast<unsigned char>(c)));
      } else {
        text += (c == '\'' || c == '\\' ? "\\" : "") + std::string(1, c);
      }
    }
    return text + "'";
  }
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

std::string round_trip_number(double value) {
  if (std::isnan(value)) return "";
  if (value == 0.0) value = 0.0;  // no "-0"
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), end.ptr};
}

std::string readable_number(double value, int significant) {
  if (std::isnan(value)) return "–";
  if (std::isinf(value)) return value > 0 ? "∞" : "−∞";
  if (value == 0.0) return "0";
  // Rounded first, so that the exponent is that of the printed number: 99999.7 prints as 1.000e5.
  const std::string scientific = printed("%.*e", significant - 1, value);
  const size_t e = scientific.find('e');
  const int exponent = std::stoi(scientific.substr(e + 1));
  if (exponent < -3 || exponent >= 5) {
    return with_true_minus(scientific.substr(0, e)) + "×" + power_of_ten(exponent);
  }
  return with_true_minus(printed("%.*f", std::max(0, significant - 1 - exponent), value));
}

std::string with_true_minus(std::string text) {
  constexpr std::string_view minus = "−";
  for (size_t at = 0; (at = text.find('-', at)) != std::string::npos; at += minus.size()) {
    text.replace(at, 1, minus);
  }
  return text;
}

std::string power_of_ten(int exponent) {
  if (exponent == 0) return "";
  std::string text = "10";
  for (const char c : std::to_string(exponent)) {
    text += c == '-' ? std::string_view("⁻") : superscripts[static_cast<size_t>(c - '0')];
  }
  return text;
}

std::string column_name(std::string_view label) {
  std::string name;
  const auto separate = [&] {
    if (!name.empty() && name.back() != '_') name += '_';
  };
  while (!label.empty()) {
    const std::string_view character = label.substr(0, first_character_bytes(label));
    label.remove_prefix(character.size());
    const auto digit = std::ranges::find(superscripts, character);
    if (digit != superscripts.end()) {
      name += static_cast<char>('0' + (digit - superscripts.begin()));
    } else if (character == "%") {
      name += "percent";
    } else if (character == "°") {
      name += "deg";
    } else if (character == "µ" || character == "μ") {  // micro sign, Greek mu
      name += 'u';
    } else if (character.size() == 1 &&
               std::isalnum(static_cast<unsigned char>(character[0])) != 0) {
      name += character;
    } else {
      separate();
    }
  }
  while (name.ends_with('_')) name.pop_back();
  return name;
}

std::string base64(std::span<const std::byte> bytes) {
  static constexpr char letters[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t group = 0;
    for (size_t k = 0; k < 3; ++k) {
      group = group << 8 | (i + k < bytes.size() ? std::to_integer<uint32_t>(bytes[i + k]) : 0u);
    }
    for (size_t k = 0; k < 4; ++k) {
      const bool is_padding = i + k > bytes.size();
      text += is_padding ? '=' : letters[group >> (18 - 6 * k) & 63];
    }
  }
  return text;
}

}  // namespace photorque
