#include "core/text/columns.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

#include "core/files.h"

namespace photorque {
namespace {

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) {
    const size_t first = cell.find_first_not_of(" \t\r"), last = cell.find_last_not_of(" \t\r");
    cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
  }
  return cells;
}

// The next line that holds something; false at the end.
bool next_line(std::istream& in, InputLocation& where, std::string& line) {
  while (std::getline(in, line)) {
    ++where.line;
    const size_t first = line.find_first_not_of(" \t\r");
    if (first != std::string::npos && line[first] != '#') return true;
  }
  return false;
}

std::vector<std::string> read_header(std::istream& in, InputLocation& where) {
  std::string line;
  if (!next_line(in, where, line)) {
    throw InputError(where, "", "nothing", "a header with the names of the columns");
  }
  return cells_of(line);
}

double number_in(const std::string& text, const InputLocation& where, const std::string& name) {
  double x = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), x);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(x)) {
    throw InputError(where, name, "\"" + text + "\"", "a finite number");
  }
  return x;
}

}  // namespace

NumberColumns read_number_columns(const std::filesystem::path& path,
                                  const std::vector<std::string>& names) {
  std::istringstream in(read_file(path));
  InputLocation where{path.string(), 0};
  NumberColumns result;
  result.header = read_header(in, where);
  std::vector<size_t> places;
  for (const std::string& name : names) {
    const auto found = std::find(result.header.begin(), result.header.end(), name);
    if (found == result.header.end()) {
      throw InputError(where, "", "no column " + name, "a column " + name);
    }
    places.push_back(static_cast<size_t>(found - result.header.begin()));
  }
  result.columns.resize(names.size());
  for (std::string line; next_line(in, where, line);) {
    const std::vector<std::string> cells = cells_of(line);
    for (size_t i = 0; i < names.size(); ++i) {
      const std::string cell = places[i] < cells.size() ? cells[places[i]] : "";
      result.columns[i].push_back(number_in(cell, where, names[i]));
    }
    result.lines.push_back(where.line);
  }
  return result;
}

std::vector<std::string> read_column_names(const std::filesystem::path& path) {
  std::istringstream in(read_file(path));
  InputLocation where{path.string(), 0};
  return read_header(in, where);
}

}  // namespace photorque
