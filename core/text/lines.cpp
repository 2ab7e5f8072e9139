#include "core/text/lines.h"

#include <algorithm>
#include <array>

namespace photorque {
namespace {

bool is_blank(char c) {
  return c == ' ' || (c >= '\t' && c <= '\r') || c == '\x1a';
}

template <class Predicate>
std::string_view without_ends(std::string_view text, const Predicate& removes) {
  while (!text.empty() && removes(text.front())) text.remove_prefix(1);
  while (!text.empty() && removes(text.back())) text.remove_suffix(1);
  return text;
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  return without_ends(text, is_blank);
}

std::string_view unquoted(std::string_view text) {
  return without_ends(text, [](char c) { return is_blank(c) || c == '"'; });
}

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const size_t end = text.find_first_of("\r\n");
    lines.push_back(text.substr(0, end));
    if (end == std::string_view::npos) break;
    text.remove_prefix(text.substr(end).starts_with("\r\n") ? end + 2 : end + 1);
  }
  return lines;
}

void split_cells(std::string_view line, char separator, std::vector<std::string_view>& cells) {
  cells.clear();
  for (;;) {
    const size_t end = line.find(separator);
    cells.push_back(unquoted(line.substr(0, end)));
    if (end == std::string_view::npos) return;
    line.remove_prefix(end + 1);
  }
}

std::vector<std::string_view> cells_of(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  split_cells(line, separator, cells);
  return cells;
}

std::vector<std::string_view> words_of(std::string_view line, std::string_view separators) {
  std::vector<std::string_view> words;
  for (size_t begin = 0;
       (begin = line.find_first_not_of(separators, begin)) != std::string_view::npos;) {
    const size_t end = std::min(line.find_first_of(separators, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = end;
  }
  return words;
}

std::string in_quotes(std::string_view text) {
  constexpr size_t max_bytes = 40;
  return "\"" + std::string(text.substr(0, max_bytes)) + (text.size() > max_bytes ? "…\"" : "\"");
}

void require_text(std::string_view begin, const InputLocation& where) {
  constexpr size_t enough = 4096;
  begin = begin.substr(0, enough);
  const bool marked = begin.starts_with("\xff\xfe") || begin.starts_with("\xfe\xff");
  // Most letters of it have one byte that is zero: always the first, or always the second.
  std::array<size_t, 2> zeros = {0, 0};
  for (size_t i = 0; i < begin.size(); ++i) zeros[i % 2] += begin[i] == '\0' ? 1 : 0;
  const auto [few, many] = std::minmax(zeros[0], zeros[1]);
  if (marked || (begin.size() > 3 && 5 * many >= 2 * begin.size() && 10 * few <= many)) {
    throw InputError(where, "", "UTF-16 text", "text in UTF-8 or ASCII");
  }
  if (many > 0) throw InputError(where, "", "bytes that are no text", "a text file");
}

namespace {

// Some programs begin UTF-8 with a byte-order mark.
std::string_view without_mark(std::string_view text) {
  constexpr std::string_view mark = "\xef\xbb\xbf";
  if (text.starts_with(mark)) text.remove_prefix(mark.size());
  return text;
}

}  // namespace

DataLines::DataLines(std::string_view text, const std::string& file)
    : lines_(lines_of(without_mark(text))), where_{file, 0} {
  require_text(text, {file, 1});
}

bool DataLines::next(std::string_view& line) {
  while (static_cast<size_t>(where_.line) < lines_.size()) {
    line = trimmed(lines_[static_cast<size_t>(where_.line++)]);
    if (!line.empty() && line.front() != '#') return true;
  }
  return false;
}

}  // namespace photorque
