// Numbers from a comma-separated file with a header.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/errors.h"

namespace photorque {

struct NumberColumns {
  std::vector<std::string> header;           // all columns of the file
  std::vector<std::vector<double>> columns;  // those asked for, in that order
  std::vector<int> lines;                    // of the file, for each row
};

// Reads the columns with these names, in any order among others; empty lines and lines that start
// with # are skipped. InputError with the line for a missing column, or a cell of these columns
// that is not a finite number.
NumberColumns read_number_columns(const std::filesystem::path& path,
                                  const std::vector<std::string>& names);

// The header of such a file alone.
std::vector<std::string> read_column_names(const std::filesystem::path& path);

}  // namespace photorque
