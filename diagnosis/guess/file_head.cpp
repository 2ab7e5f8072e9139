#include "diagnosis/guess/file_head.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "attitude/recordings/text_lines.h"
#include "core/errors.h"
#include "core/numerics/median.h"
#include "core/settings/settings.h"
#include "core/text/format.h"
#include "core/text/parse.h"
#include "diagnosis/guess/header.h"

namespace photorque {

std::string command_with_names(const std::filesystem::path& path, const std::string& names) {
  return "name the columns: photorque diagnose --guess " + shell_word(path.string()) +
         " --columns " + names + " (write what they are)";
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

std::optional<std::vector<double>> numbers_of(const std::vector<std::string_view>& cells,
                                              char separator, size_t fewest_cells) {
  std::vector<double> numbers;
  bool any = false;
  for (const std::string_view cell : cells) {
    const std::optional<double> number = number_of_cell(cell, separator);
    if (!number) return std::nullopt;
    any = any || !std::isnan(*number);
    numbers.push_back(*number);
  }
  if (!any || numbers.size() < fewest_cells) return std::nullopt;
  return numbers;
}

struct NumberedLine {
  int64_t number;
  std::string text;
};

// The first lines of a file, without comment lines.
std::vector<NumberedLine> first_lines(const std::filesystem::path& path,
                                      const std::vector<std::string>& header) {
  constexpr size_t most = 400;
  TextLines lines(path, header);
  std::vector<NumberedLine> first;
  std::string_view line;
  while (first.size() < most && lines.next(line)) {
    if (first.empty()) require_text(line.substr(0, 16), {path.string(), 1});
    if (trimmed(line).empty() || line.front() == '#') continue;
    first.push_back({lines.number(), std::string(line)});
  }
  return first;
}

// The cells of a line of units: "s, m, m"; empty for another line.
std::vector<std::string> units_in(const std::vector<std::string_view>& cells) {
  std::vector<std::string> units;
  bool any = false;
  for (const std::string_view cell : cells) {
    units.push_back(header_cell_text(cell));
    if (trimmed(units.back()).empty()) continue;
    if (!unit_written(units.back())) return {};
    any = true;
  }
  return any ? units : std::vector<std::string>();
}

// The first table with this separator. It has no column names if the line above it has a different
// number of cells.
std::optional<FileHead> table_in(const std::vector<NumberedLine>& lines, char separator,
                                 size_t fewest_cells) {
  std::vector<std::string_view> cells, before;
  for (size_t i = 0; i < lines.size(); ++i) {
    split_cells(lines[i].text, separator, cells);
    if (!numbers_of(cells, separator, fewest_cells)) {
      before = cells;
      continue;
    }
    FileHead head;
    head.first_row_line = static_cast<int>(lines[i].number);
    head.line = i > 0 ? static_cast<int>(lines[i - 1].number) : 0;
    head.names_above = i > 0 ? before.size() : 0;
    const size_t width = cells.size();
    if (i > 0 && before.size() == width) head.header.assign(before.begin(), before.end());
    if (i > 1 && !head.header.empty()) {
      const std::vector<std::string> units = units_in(before);
      split_cells(lines[i - 2].text, separator, cells);
      if (!units.empty() && cells.size() == width && units_in(cells).empty()) {
        head.header.assign(cells.begin(), cells.end());
        head.units = units;
        head.line = static_cast<int>(lines[i - 2].number);
      }
    }
    for (; i < lines.size(); ++i) {
      split_cells(lines[i].text, separator, cells);
      const auto row = numbers_of(cells, separator, fewest_cells);
      if (row && row->size() == width) head.rows.push_back(*row);
    }
    return head;
  }
  return std::nullopt;
}

// Proposed names for a table without a header. The increasing column is the time. One other column
// is an angle, two are coordinates; more columns get numbers.
std::string proposed_names(const FileHead& table) {
  const size_t width = table.rows.front().size();
  size_t time = 0;
  for (size_t k = width; k-- > 0;) {
    bool rises = true;
    for (size_t i = 1; i < table.rows.size(); ++i) {
      rises = rises && table.rows[i][k] > table.rows[i - 1][k];
    }
    if (rises) time = k;
  }
  const std::string clock = clock_unit(table, time) == "us" ? "t_us" : "t_s";
  std::vector<const char*> others;
  if (width == 2) others = {"angle_rad"};
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

FileHead head_of(const std::filesystem::path& path, const std::vector<std::string>& header) {
  const std::vector<NumberedLine> lines = first_lines(path, header);
  const size_t fewest_cells = header.size() == 1 ? 1 : 2;
  std::optional<FileHead> unnamed;
  for (const char separator : {',', ';', '\t', ' '}) {
    auto table = table_in(lines, separator, fewest_cells);
    if (!table) continue;
    if (!table->header.empty()) return *std::move(table);
    if (!unnamed || table->rows.size() > unnamed->rows.size()) unnamed = std::move(table);
  }
  if (unnamed) throw without_header(path, *unnamed);
  const auto is_number = [](const NumberedLine& line) {
    return !std::isnan(number_of_cell(trimmed(line.text), ';').value_or(NAN));
  };
  if (2 * std::ranges::count_if(lines, is_number) > static_cast<std::ptrdiff_t>(lines.size())) {
    throw InputError({path.string()}, "header", "one column of numbers",
                     "a time beside them, or the readings per second; " +
                         command_with_names(path, "rate_rad_s --rate-Hz 10"));
  }
  throw InputError({path.string()}, "header",
                   lines.empty() ? "an empty file"
                                 : "no rows of numbers between commas, semicolons, tabs or blanks",
                   "a table with a header that names its columns");
}

}  // namespace photorque
