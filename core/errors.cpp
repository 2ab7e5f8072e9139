#include "core/errors.h"

namespace photorque {
namespace {

// User text may hold line breaks or control characters; an error message is one printable line.
std::string one_line(const std::string& text, size_t longest = 200) {
  std::string line;
  for (const char c : text) {
    if (line.size() >= longest) return line + "...";
    line += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? ' ' : c;
  }
  return line;
}

std::string message(const InputLocation& where, const std::string& key, const std::string& found,
                    const std::string& expected) {
  std::string text = one_line(where.file);
  if (where.line > 0) text += ":" + std::to_string(where.line);
  if (!key.empty()) text += (text.empty() ? "" : ": ") + one_line(key);
  if (!found.empty()) text += ": found " + one_line(found);
  constexpr size_t longest_remedy = 4000;  // a command with the names of many columns
  if (!expected.empty())
    text += (found.empty() ? ": expected " : ", expected ") + one_line(expected, longest_remedy);
  return text;
}

}  // namespace

InputError::InputError(const InputLocation& where, const std::string& key, const std::string& found,
                       const std::string& expected)
    : std::runtime_error(message(where, key, found, expected)), names_file_(!where.file.empty()) {}

}  // namespace photorque
