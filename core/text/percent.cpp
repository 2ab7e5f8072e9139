#include "core/text/percent.h"

#include <charconv>

namespace photorque {

std::optional<std::string> percent_decoded(std::string_view text) {
  std::string decoded;
  while (!text.empty()) {
    if (text[0] != '%') {
      decoded += text[0];
      text.remove_prefix(1);
      continue;
    }
    if (text.size() < 3) return std::nullopt;
    const std::string_view digits = text.substr(1, 2);
    unsigned byte = 0;
    if (std::from_chars(digits.begin(), digits.end(), byte, 16).ptr != digits.end()) {
      return std::nullopt;
    }
    decoded += static_cast<char>(byte);
    text.remove_prefix(3);
  }
  return decoded;
}

}  // namespace photorque
