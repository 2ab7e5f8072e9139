#include "core/text/columns.h"

#include <algorithm>

#include "core/files.h"
#include "core/text/lines.h"
#include "core/text/numbers.h"

namespace photorque {
namespace {

std::vector<std::string> read_header(DataLines& lines) {
  std::string_view line;
  if (!lines.next(line)) {
    throw InputError(lines.where(), "", "nothing", "a header with the names of the columns");
  }
  const std::vector<std::string_view> cells = cells_of(line);
  return {cells.begin(), cells.end()};
}

}  // namespace

NumberColumns read_number_columns(const std::filesystem::path& path,
                                  const std::vector<std::string>& names) {
  const std::string text = read_file(path);
  DataLines lines(text, path.string());
  NumberColumns result;
  result.header = read_header(lines);
  std::vector<size_t> places;
  for (const std::string& name : names) {
    const auto found = std::find(result.header.begin(), result.header.end(), name);
    if (found == result.header.end()) {
      throw InputError(lines.where(), "", "no column " + name, "a column " + name);
    }
    places.push_back(static_cast<size_t>(found - result.header.begin()));
  }
  result.columns.resize(names.size());
  std::vector<std::string_view> cells;
  for (std::string_view line; lines.next(line);) {
    split_cells(line, ',', cells);
    // Decimal commas, say, which would shift what follows them.
    if (cells.size() > result.header.size()) {
      throw InputError(lines.where(), "", "a row of " + std::to_string(cells.size()) + " cells",
                       std::to_string(result.header.size()) +
                           ", as in the header; numbers have a point, no comma");
    }
    for (size_t i = 0; i < names.size(); ++i) {
      const std::string_view cell = places[i] < cells.size() ? cells[places[i]] : "";
      result.columns[i].push_back(require_number(cell, lines.where(), names[i], "a finite number"));
    }
    result.lines.push_back(lines.where().line);
  }
  return result;
}

std::vector<std::string> read_column_names(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  DataLines lines(text, path.string());
  return read_header(lines);
}

}  // namespace photorque
