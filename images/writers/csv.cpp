// Maps and tables as comma-separated values (RFC 4180) after lines of provenance that start with "#
// ".
//
// A map has one row per bin, x fastest, both rising. The columns are x and y of the bin's centre,
// value and standard error, each named with its unit: "x_m,y_m,value_W_m2,standard_error_W_m2".
// Numbers are read back as the same doubles; NaN is an empty cell, infinities are "inf" and "-inf".
#include "core/files.h"
#include "core/text/format.h"
#include "core/text/parse.h"
#include "images/drawing/map.h"
#include "images/writers/kind.h"

namespace photorque::kinds::csv {
namespace {

// Spreadsheets interpret a cell that begins with one of these characters as a formula, even in
// quotes, unless it is a number. An apostrophe prevents this.
bool begins_formula(char c) {
  return std::string_view("=+-@").find(c) != std::string_view::npos;
}

// A text in a line of comment, which spreadsheets split into cells like any other line.
std::string in_comment(const std::string& text) {
  std::string clean;
  for (const char c : clean_text(text)) {
    const bool begins_cell = !clean.empty() && (clean.back() == ',' || clean.back() == ';');
    if (begins_cell && begins_formula(c)) clean += '\'';
    clean += c;
  }
  return clean;
}

std::string preamble(const std::string& title, const Provenance& provenance) {
  std::string text = "# " + in_comment(provenance.program + " " + provenance.version) +
                     "\n# git_hash: " + in_comment(provenance.git_hash) +
                     "\n# seed: " + std::to_string(provenance.seed) + "\n";
  for (const auto& [file, hash] : provenance.inputs) {
    text += "# input: " + in_comment(file) + " " + in_comment(hash) + "\n";
  }
  if (!title.empty()) text += "# title: " + in_comment(title) + "\n";
  return text;
}

std::string quoted_where_needed(const std::string& cell) {
  std::string clean = clean_text(cell);
  if (!clean.empty() && begins_formula(clean.front()) && clean != "-" && !number_in(clean)) {
    clean.insert(clean.begin(), '\'');
  }
  // A leading '#' would be read as a comment.
  if (clean.find_first_of(",\"") == std::string::npos && !clean.starts_with('#')) return clean;
  std::string quoted = "\"";
  for (const char c : clean) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

std::string with_unit(const std::string& name, const std::string& unit) {
  const std::string suffix = column_name(unit);
  return suffix.empty() ? name : name + "_" + suffix;
}

std::string csv_of(const Map& map, const Provenance& provenance) {
  require_consistent(map);
  std::string text = preamble(map.title, provenance) + column_name(map.x_label) + "," +
                     column_name(map.y_label) + "," + with_unit("value", map.unit) + "," +
                     with_unit("standard_error", map.unit) + "\n";
  const auto centre = [](double low, double high, int index, int count) {
    return round_trip_number(low + (high - low) * (index + 0.5) / count);
  };
  for (int iy = 0; iy < map.height; ++iy) {
    const std::string y = centre(map.y_low, map.y_high, iy, map.height);
    for (int ix = 0; ix < map.width; ++ix) {
      const size_t i = static_cast<size_t>(iy) * map.width + ix;
      const double error = map.standard_error.empty() ? 0.0 : map.standard_error[i];
      text += centre(map.x_low, map.x_high, ix, map.width) + "," + y + "," +
              round_trip_number(map.value[i]) + "," + round_trip_number(error) + "\n";
    }
  }
  return text;
}

std::string csv_of(const Table& table, const Provenance& provenance) {
  require_consistent(table);
  std::string text = preamble(table.title, provenance);
  size_t rows = 0;
  for (const Table::Column& column : table.columns) {
    text += (&column == &table.columns.front() ? "" : ",") + quoted_where_needed(column.name);
    rows = std::max(column.values.size(), column.texts.size());
  }
  text += "\n";
  for (size_t row = 0; row < rows; ++row) {
    for (const Table::Column& column : table.columns) {
      if (&column != &table.columns.front()) text += ",";
      text += column.texts.empty() ? round_trip_number(column.values[row])
                                   : quoted_where_needed(column.texts[row]);
    }
    text += "\n";
  }
  return text;
}

}  // namespace

WriterKind kind() {
  return {"csv", "Maps and tables as comma-separated values behind lines of provenance",
          [](const WriterJob& job) {
            const auto put = [&](const auto& item, const std::filesystem::path& path) {
              write_file_whole(path, csv_of(item, job.provenance));
            };
            return job.each("csv", put, job.product.maps, job.product.tables);
          }};
}

}  // namespace photorque::kinds::csv
