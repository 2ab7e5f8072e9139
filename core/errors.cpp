#include "core/errors.h"

#include "core/text/format.h"

namespace photorque {
namespace {

// User text may hold line breaks, control characters or bytes that are not UTF-8; an error message
// is one printable line.
std::string one_line(std::string_view text) {
  constexpr size_t longest = 200;
  const std::string line = clean_text(text);
  if (line.size() <= longest) return line;
  size_t bytes = 0;
  while (bytes < longest) bytes += first_character_bytes(std::string_view(line).substr(bytes));
  return line.substr(0, bytes) + "...";
}

std::string message(const InputLocation& where, const std::string& key, const std::string& found,
                    const std::string& expected) {
  std::string text = one_line(where.file);
  if (where.line > 0) text += ":" + std::to_string(where.line);
  if (!key.empty()) text += (text.empty() ? "" : ": ") + one_line(key);
  if (!found.empty()) text += ": found " + one_line(found);
  if (!expected.empty())
    text += (found.empty() ? ": expected " : ", expected ") + one_line(expected);
  return text;
}

}  // namespace

InputError::InputError(const InputLocation& where, const std::string& key, const std::string& found,
                       const std::string& expected)
    : std::runtime_error(message(where, key, found, expected)), names_file_(!where.file.empty()) {}

}  // namespace photorque
