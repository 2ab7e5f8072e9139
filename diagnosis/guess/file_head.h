// The beginning of a file of numbers: the line that names its columns, and rows below it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "attitude/recordings/recording.h"

namespace photorque {

// The cells of the header and of some rows of numbers below it.
struct FileHead {
  std::vector<std::string> header;
  std::vector<std::string> units;  // of a line of units below the header; empty without one
  std::vector<std::vector<double>> rows;
  int line = 0, first_row_line = 0;  // line numbers in the file
  size_t names_above = 0;            // cells of the line above the first row
  // The header is a comment, or its cells are not separated as those of the rows.
  bool is_split_otherwise = false;
};

// The header and first rows of a CSV file, also with other separators. `reading.header` is for a
// file without one; with `reading.rate_Hz`, one column is a table. Throws InputError with the
// remedy for a file without a header that has as many cells as the rows, with decimal commas, or in
// UTF-16.
FileHead head_of(const std::filesystem::path& path, const RecordingOptions& reading);

// The command that names the columns of a file: "t_s,x_m,column_3".
std::string command_with_names(const std::filesystem::path& path, const std::string& names);

// Whether each number of a column is larger than that before it.
bool rises(const FileHead& head, size_t column);

// The unit of a clock by its steps: "s", "ms" or "us".
std::string clock_unit(const FileHead& head, size_t column);

}  // namespace photorque
