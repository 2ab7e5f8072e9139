#include "diagnosis/guess/file_head.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "attitude/recordings/text_lines.h"
#include "core/constants.h"
#include "core/errors.h"
#include "core/numerics/median.h"
#include "core/settings/settings.h"
#include "core/text/format.h"
#include "core/text/parse.h"
#include "diagnosis/guess/header.h"
#include "diagnosis/guess/meanings.h"

namespace photorque {

std::string command_with_names(const std::filesystem::path& path, const std::string& names) {
  return "name the columns: photorque diagnose --guess " + shell_word(path.string()) +
         " --columns " + names + " (write what they are)";
}

bool rises(const FileHead& head, size_t column) {
  for (size_t i = 1; i < head.rows.size(); ++i) {
    if (!(head.rows[i][column] > head.rows[i - 1][column])) return false;
  }
  return !head.rows.empty();
}

// A clock with large integer steps does not count in seconds but in milliseconds or microseconds.
std::string clock_unit(const FileHead& head, size_t column) {
  std::vector<double> steps;
  for (size_t i = 1; i < head.rows.size(); ++i) {
    const double step = head.rows[i][column] - head.rows[i - 1][column];
    if (std::isfinite(step)) steps.push_back(step);
  }
  if (steps.empty()) return "s";
  const double usual = upper_median(steps);
  const bool whole =
      std::all_of(steps.begin(), steps.end(), [](double s) { return s == std::round(s); });
  return whole && usual >= 200.0 ? "us" : whole && usual >= 2.0 ? "ms" : "s";
}

namespace {

struct NumberedLine {
  int64_t number;
  std::string text;
};

// The cells that a row of numbers must have.
struct RowShape {
  size_t fewest_cells = 1;
  // Other cells may be texts, which count as NaN, if at least two are numbers.
  bool has_texts = false;
};

// The numbers of a row; nothing for another line.
std::optional<std::vector<double>> numbers_in(const NumberedLine& line, char separator,
                                              RowShape shape) {
  std::vector<std::string_view> cells;
  split_cells(line.text, separator, cells);
  std::vector<double> numbers;
  size_t finite = 0;
  for (const std::string_view cell : cells) {
    const std::optional<double> number = number_of_cell(cell, separator);
    if (!number && !shape.has_texts) return std::nullopt;
    numbers.push_back(number.value_or(NAN));
    finite += !std::isnan(numbers.back());
  }
  if (finite < (shape.has_texts ? 2 : 1) || numbers.size() < shape.fewest_cells) {
    return std::nullopt;
  }
  return numbers;
}

bool is_comment(const NumberedLine& line) {
  const std::string_view text = trimmed(line.text);
  return text.starts_with('#') || text.starts_with('%') || text.starts_with("//");
}

// The first lines of a file that are not empty.
std::vector<NumberedLine> first_lines(const std::filesystem::path& path,
                                      const std::vector<std::string>& header) {
  constexpr size_t most = 400;
  TextLines lines(path, header);
  std::vector<NumberedLine> first;
  std::string_view line;
  while (first.size() < most && lines.next(line)) {
    if (first.empty()) require_text(line.substr(0, 16), {path.string(), 1});
    if (unquoted(line).empty()) continue;
    first.push_back({lines.number(), std::string(line)});
  }
  return first;
}

// The cells of a line of units: "s, m, m"; empty for another line.
std::vector<std::string> units_in(const std::vector<std::string>& cells) {
  bool any = false;
  for (const std::string& cell : cells) {
    if (trimmed(cell).empty()) continue;
    if (!unit_written(cell)) return {};
    any = true;
  }
  return any ? cells : std::vector<std::string>();
}

struct Header {
  std::vector<std::string> cells;  // empty if there is another number of them than in a row
  bool is_split_otherwise = false;
};

// A name for a table whose cells are between blanks: "Time(s)" for "Time ( s )".
std::string without_blanks(std::string_view name) {
  std::string joined;
  for (const std::string_view word : words_of(name)) {
    constexpr std::string_view opening = "([/", closing = ")]/";
    const bool is_apart = !joined.empty() && opening.find(joined.back()) == opening.npos &&
                          (closing.find(word.front()) == closing.npos);
    if (is_apart) joined += '_';
    joined += word;
  }
  return joined;
}

bool has_unit(const std::string& cell) {
  return read_header_cell(cell).unit.has_value();
}

// Whether a cell of a header states a unit or is a known name.
bool names_a_quantity(const std::string& cell) {
  const HeaderCell read = read_header_cell(cell);
  return read.unit || !meanings({read.words}, "", read).empty();
}

// The names in a line above rows of `width` cells. The line may be a comment, or its separator may
// differ from that of the rows. Further cells are left out if one of the first states a unit.
Header names_in_line(const NumberedLine& line, char separator, size_t width) {
  std::vector<std::string_view> parts;
  split_cells(line.text, separator, parts);
  if (!is_comment(line) && parts.size() == width) return {{parts.begin(), parts.end()}, false};
  const size_t begin = std::min(line.text.find_first_not_of("#%/ \t"), line.text.size());
  const std::string text(trimmed(std::string_view(line.text).substr(begin)));
  std::vector<std::string> cells, longer;
  for (const char other : {separator, '\t', ';', ','}) {
    split_cells(text, other, parts);
    if (cells.size() != width) cells.assign(parts.begin(), parts.end());
    if (longer.empty() && parts.size() > width) longer.assign(parts.begin(), parts.end());
  }
  if (cells.size() != width) {
    cells.clear();
    for (size_t at = 0; at < text.size();) {  // at several blanks
      const size_t end = std::min(text.find("  ", at), text.size());
      cells.push_back(text.substr(at, end - at));
      at = std::min(text.find_first_not_of(' ', end), text.size());
    }
  }
  if (cells.size() != width) {
    parts = names_between_blanks(text);
    cells.assign(parts.begin(), parts.end());
  }
  if (cells.size() != width && !longer.empty()) {
    longer.resize(width);
    if (std::ranges::any_of(longer, has_unit)) cells = std::move(longer);
  }
  if (cells.size() != width) return {};
  if (separator == ' ') std::ranges::transform(cells, cells.begin(), without_blanks);
  return {cells, true};
}

// The names of columns in numbered lines, one for each: "Label1: Voltage [V]", "Channel 2 = x
// (mm)".
Header names_in_numbered_lines(const std::vector<NumberedLine>& lines, size_t first, size_t width) {
  Header names;
  for (size_t k = 0; k < first && names.cells.size() < width; ++k) {
    const std::string_view text = lines[k].text;
    const size_t end = text.find_first_of(":=");
    if (end == text.npos) continue;
    const std::vector<std::string> words = words_of_header(text.substr(0, end));
    const std::string_view name = trimmed(text.substr(end + 1));
    const bool is_next = words.size() == 2 && words[1] == std::to_string(names.cells.size() + 1) &&
                         is_one_of(words[0], {"label", "column", "col", "channel", "ch"});
    if (is_next && !name.empty()) names.cells.push_back(joined_text(words_of(name), " "));
  }
  if (names.cells.size() != width) return {};
  names.is_split_otherwise = true;
  return names;
}

// The line of names above the rows: of the lines that are neither comments nor rows, the last one
// that names a quantity for each column or, if there is none, the last one. A line that contains
// numbers is the first row of a table with texts if a line of names alone is above it.
std::optional<size_t> line_of_names(const std::vector<NumberedLine>& lines, size_t first,
                                    char separator, size_t width) {
  std::optional<size_t> last, without_numbers;
  for (size_t k = first; k-- > 0;) {
    if (is_comment(lines[k]) || numbers_in(lines[k], separator, {})) continue;
    const Header names = names_in_line(lines[k], separator, width);
    const bool has_number = std::ranges::any_of(
        names.cells, [](const std::string& cell) { return number_in(cell).has_value(); });
    const bool is_header = !names.cells.empty() && !has_number;
    if (is_header && std::ranges::any_of(names.cells, names_a_quantity)) return k;
    if (!without_numbers && (is_header || (!last && !has_number))) without_numbers = k;
    if (!last) last = k;
  }
  return without_numbers ? without_numbers : last;
}

// The comment that names the columns: the one directly above the rows if it names a quantity, or
// else the last one that states a unit, or else the one directly above.
std::optional<size_t> comment_of_names(const std::vector<NumberedLine>& lines, size_t first,
                                       char separator, size_t width) {
  std::optional<size_t> above;
  for (size_t k = first; k-- > 0;) {
    if (!is_comment(lines[k]) || numbers_in(lines[k], separator, {})) continue;
    const Header names = names_in_line(lines[k], separator, width);
    const bool is_above = k + 1 == first;
    if (std::ranges::any_of(names.cells, is_above ? names_a_quantity : has_unit)) return k;
    if (is_above && !names.cells.empty()) above = k;
  }
  return above;
}

// Takes the names of the columns from `lines[k]`, or from the line above it if it contains units.
void take_names(FileHead& head, const std::vector<NumberedLine>& lines, size_t k, char separator,
                size_t width) {
  Header names = names_in_line(lines[k], separator, width), above;
  if (names.cells.empty()) return;
  const std::vector<std::string> units = units_in(names.cells);
  if (!units.empty() && k > 0) above = names_in_line(lines[k - 1], separator, width);
  const bool has_units = !above.cells.empty() && units_in(above.cells).empty();
  if (has_units) {
    --k;
    names = std::move(above);
    head.units = units;
  }
  head.line = static_cast<int>(lines[k].number);
  head.header = std::move(names.cells);
  head.is_split_otherwise = names.is_split_otherwise;
  if (!head.is_split_otherwise) return;
  // A stated header has no line of units below it.
  for (size_t i = 0; i < head.units.size(); ++i) {
    if (!head.units[i].empty()) head.header[i] += "(" + head.units[i] + ")";
  }
  head.units.clear();
}

// Adds the names of the columns to a table whose rows start at `lines[first]`: those of the line of
// names or, if that has another number of cells, of a comment, or of numbered lines.
void add_header(FileHead& head, const std::vector<NumberedLine>& lines, size_t first,
                char separator, size_t width) {
  for (const auto find : {line_of_names, comment_of_names}) {
    const std::optional<size_t> k = find(lines, first, separator, width);
    if (k && head.header.empty()) take_names(head, lines, *k, separator, width);
  }
  if (!head.header.empty()) return;
  Header numbered = names_in_numbered_lines(lines, first, width);
  head.header = std::move(numbered.cells);
  head.is_split_otherwise = numbered.is_split_otherwise;
}

// The first table with this separator. It has no column names if no line above it has the number of
// cells of its rows.
std::optional<FileHead> table_in(const std::vector<NumberedLine>& lines, char separator,
                                 RowShape shape) {
  for (size_t i = 0; i < lines.size(); ++i) {
    const auto first = numbers_in(lines[i], separator, shape);
    if (!first) continue;
    if (shape.has_texts) {  // a line of prose may contain two numbers
      const auto second =
          i + 1 < lines.size() ? numbers_in(lines[i + 1], separator, shape) : std::nullopt;
      if (!second || second->size() != first->size()) continue;
    }
    FileHead head;
    head.first_row_line = static_cast<int>(lines[i].number);
    if (i > 0) {
      std::vector<std::string_view> above;
      split_cells(lines[i - 1].text, separator, above);
      head.line = static_cast<int>(lines[i - 1].number);
      if (!is_comment(lines[i - 1])) head.names_above = above.size();
    }
    add_header(head, lines, i, separator, first->size());
    for (; i < lines.size(); ++i) {
      auto row = numbers_in(lines[i], separator, shape);
      if (row && row->size() == first->size()) head.rows.push_back(*std::move(row));
    }
    return head;
  }
  return std::nullopt;
}

bool changes_sign(const std::vector<double>& values) {
  return !values.empty() && std::ranges::min(values) < 0.0 && std::ranges::max(values) > 0.0;
}

// An angle in degrees if it swings over more than a turn of 2π rad.
const char* angle_name(const std::vector<double>& values) {
  const bool is_large =
      changes_sign(values) && std::ranges::max(values) - std::ranges::min(values) > 2.0 * pi;
  return is_large ? "angle_deg" : "angle_rad";
}

// The finite numbers of a column.
std::vector<double> column_of(const FileHead& table, size_t column) {
  std::vector<double> values;
  for (const auto& row : table.rows) {
    if (std::isfinite(row[column])) values.push_back(row[column]);
  }
  return values;
}

// Proposed names for a table without a header. The increasing column is the time. One other column
// is an angle, two are coordinates; more columns get numbers.
std::string proposed_names(const FileHead& table) {
  const size_t width = table.rows.front().size();
  size_t time = 0;
  for (size_t k = width; k-- > 0;) {
    if (rises(table, k)) time = k;
  }
  const std::string clock = clock_unit(table, time) == "us" ? "t_us" : "t_s";
  std::vector<const char*> others;
  if (width == 2) others = {angle_name(column_of(table, 1 - std::min<size_t>(time, 1)))};
  if (width == 3) others = {"x_m", "y_m"};
  std::string names;
  size_t next = 0;
  for (size_t k = 0; k < width; ++k) {
    if (k > 0) names += ',';
    if (k == time) {
      names += clock;
    } else {
      names += next < others.size() ? others[next++] : "column_" + std::to_string(k + 1);
    }
  }
  return names;
}

InputError without_header(const std::filesystem::path& path, const FileHead& table) {
  const std::string width = std::to_string(table.rows.front().size()),
                    names = proposed_names(table);
  if (table.names_above > 1) {
    return {{path.string(), table.line},
            "header",
            std::to_string(table.names_above) + " cells above rows of " + width + " numbers",
            "a header with as many cells; " + command_with_names(path, names)};
  }
  return {{path.string(), table.first_row_line},
          "header",
          table.first_row_line == 1 ? "numbers in the first line"
                                    : "rows of " + width + " numbers without names",
          "a header; " + command_with_names(path, names)};
}

}  // namespace

FileHead head_of(const std::filesystem::path& path, const RecordingOptions& reading) {
  const std::vector<NumberedLine> lines = first_lines(path, reading.header);
  std::vector<RowShape> shapes;
  if (reading.header.size() != 1) shapes.push_back({.fewest_cells = 2});
  if (reading.header.size() == 1 || reading.rate_Hz) shapes.push_back({.fewest_cells = 1});
  shapes.push_back({.fewest_cells = 2, .has_texts = true});
  for (const RowShape& shape : shapes) {
    std::optional<FileHead> unnamed;
    for (const char separator : {',', ';', '\t', ' '}) {
      auto table = table_in(lines, separator, shape);
      if (!table) continue;
      if (!table->header.empty()) return *std::move(table);
      if (!unnamed || table->rows.size() > unnamed->rows.size()) unnamed = std::move(table);
    }
    if (unnamed && !shape.has_texts) throw without_header(path, *unnamed);
  }
  std::vector<double> numbers;  // of lines with one number
  for (const NumberedLine& line : lines) {
    const double number = number_of_cell(trimmed(line.text), ';').value_or(NAN);
    if (!std::isnan(number)) numbers.push_back(number);
  }
  if (2 * numbers.size() > lines.size()) {
    // A swing is an angle, a speed keeps its sign.
    const std::string name = changes_sign(numbers) ? angle_name(numbers) : "rate_rad_s";
    throw InputError({path.string()}, "header", "one column of numbers",
                     "a time beside them, or the readings per second; " +
                         command_with_names(path, name + " --rate-Hz 10"));
  }
  throw InputError({path.string()}, "header",
                   lines.empty() ? "an empty file"
                                 : "no rows of numbers between commas, semicolons, tabs or blanks",
                   "a table with a header that names its columns");
}

}  // namespace photorque
