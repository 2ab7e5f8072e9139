#include "core/text/parse.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <span>

#include "core/files.h"
#include "core/text/format.h"

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

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
  return lower;
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
  if (separator == ' ') {
    for (const std::string_view word : words_of(line)) cells.push_back(unquoted(word));
    return;
  }
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

std::vector<std::string_view> names_between_blanks(std::string_view header) {
  std::vector<std::string_view> names;
  bool joins = false;
  for (const std::string_view word : words_of(header)) {
    const auto brackets = [&](std::string_view kind) {
      return names.empty() ? 0 : std::ranges::count_if(names.back(), [&](char c) {
        return kind.find(c) != std::string_view::npos;
      });
    };
    const bool is_link = word == "/" || word == "in";
    const bool is_unit = word.starts_with('(') || word.starts_with('[');
    if (!names.empty() && (joins || is_link || is_unit || brackets("([") > brackets(")]"))) {
      const char* const begin = names.back().data();
      names.back() = {begin, static_cast<size_t>(word.data() + word.size() - begin)};
    } else {
      names.push_back(word);
    }
    joins = is_link;
  }
  std::ranges::transform(names, names.begin(), unquoted);
  return names;
}

std::string_view name_of_column(std::string_view written,
                                const std::map<std::string, std::string>& names) {
  const auto found = std::ranges::find(
      names, written, [](const auto& item) -> std::string_view { return item.second; });
  return found != names.end() ? std::string_view(found->first) : written;
}

bool is_listed(std::string_view text, std::string_view list) {
  return std::ranges::count(cells_of(list), text) > 0;
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

InputError wrong_row(const InputLocation& where, size_t cells, size_t of_header) {
  return {where, "", "a row of " + std::to_string(cells) + " cells",
          std::to_string(of_header) + ", as in the header; numbers have a point, no comma"};
}

void require_text(std::string_view begin, const InputLocation& where) {
  constexpr size_t enough = 4096;
  begin = begin.substr(0, enough);
  const bool marked = begin.starts_with("\xff\xfe") || begin.starts_with("\xfe\xff");
  // In UTF-16 most letters have one zero byte: always the first, or always the second.
  std::array<size_t, 2> zeros = {0, 0};
  for (size_t i = 0; i < begin.size(); ++i) zeros[i % 2] += begin[i] == '\0' ? 1 : 0;
  const auto [few, many] = std::minmax(zeros[0], zeros[1]);
  if (marked || (begin.size() > 3 && 5 * many >= 2 * begin.size() && 10 * few <= many)) {
    throw InputError(where, "", "UTF-16 text",
                     "text in UTF-8 or ASCII (iconv -f UTF-16 -t UTF-8 FILE > NEW_FILE converts)");
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

char separator_of(std::string_view header) {
  for (const char separator : {'\t', ';', ','}) {
    if (header.find(separator) != std::string_view::npos) return separator;
  }
  return ' ';
}

std::optional<double> number_of_cell(std::string_view cell, char separator) {
  if (cell.empty() || cell == "NaN" || cell == "nan" || cell == "NA") return NAN;
  const std::optional<double> number = number_in(cell);
  const size_t comma = cell.find(',');
  if (number || separator == ',' || comma == std::string_view::npos) return number;
  std::string with_point(cell);
  with_point[comma] = '.';
  return number_in(with_point);
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

namespace {

struct ColumnNames {
  char separator = ',';
  std::vector<std::string> names;
};

ColumnNames read_header(DataLines& lines) {
  std::string_view line;
  if (!lines.next(line)) {
    throw InputError(lines.where(), "", "nothing", "a header with the names of the columns");
  }
  const char separator = separator_of(line);
  const std::vector<std::string_view> cells = cells_of(line, separator);
  return {separator, {cells.begin(), cells.end()}};
}

}  // namespace

NumberColumns read_number_columns(const std::filesystem::path& path,
                                  const std::vector<std::string>& names) {
  const std::string text = read_file(path);
  DataLines lines(text, path.string());
  NumberColumns result;
  auto [separator, header] = read_header(lines);
  result.header = std::move(header);
  std::vector<size_t> places;
  for (const std::string& name : names) {
    const auto found = std::find(result.header.begin(), result.header.end(), name);
    if (found == result.header.end()) {
      constexpr size_t most = 12;
      const std::span<const std::string> shown(result.header.data(),
                                               std::min(most, result.header.size()));
      throw InputError(
          lines.where(), "header",
          "the columns " +
              joined_text(shown, ", ",
                          [](const std::string& column) { return in_quotes(column); }) +
              (result.header.size() > most ? ", …" : ""),
          "also a column " + name);
    }
    places.push_back(static_cast<size_t>(found - result.header.begin()));
  }
  result.columns.resize(names.size());
  std::vector<std::string_view> cells;
  for (std::string_view line; lines.next(line);) {
    split_cells(line, separator, cells);
    if (cells.size() > result.header.size()) {
      throw wrong_row(lines.where(), cells.size(), result.header.size());
    }
    for (size_t i = 0; i < names.size(); ++i) {
      const std::string_view cell = places[i] < cells.size() ? cells[places[i]] : "";
      const std::optional<double> number = number_of_cell(cell, separator);
      result.columns[i].push_back(
          number && std::isfinite(*number)
              ? *number
              : require_number(cell, lines.where(), names[i], "a finite number"));
    }
    result.lines.push_back(lines.where().line);
  }
  return result;
}

std::vector<std::string> read_column_names(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  DataLines lines(text, path.string());
  return read_header(lines).names;
}

JsonExtent extent_of_json(std::string_view text) {
  JsonExtent extent;
  int depth = 0;
  bool in_string = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
      continue;
    }
    if (c == '"') in_string = true;
    if (c == '{' || c == '[' || c == ',' || c == ':') ++extent.values;
    if (c == '{' || c == '[') ++depth;
    if (c == '}' || c == ']') --depth;
    extent.depth = std::max(extent.depth, depth);
  }
  return extent;
}

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
