// What the columns of somebody's file most likely are: names such as "Gyroscope x (deg/s)" or "wz"
// as channels of recordings.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace photorque {

struct GuessedColumn {
  std::string in_file;  // as the header has it
  std::string channel;  // "gyro_x_deg_s", its unit that of the file; empty: unknown
  bool is_sure = true;  // the file says so itself: the channel's own name, or its unit beside it
  std::string because = {};  // what is assumed of one that is not sure
};

// The header of a CSV file: the last line before the first row of numbers that has as many cells.
// A clock whose name states no unit is told by its steps. InputError,
// naming the cure, for a file without such a header, with decimal commas, or in UTF-16.
std::vector<GuessedColumn> guess_columns(const std::filesystem::path& path);

}  // namespace photorque
