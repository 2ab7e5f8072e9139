// A first experiment for recordings of an unknown machine: from the columns, from the readings
// (noise, ratios of moments of inertia), and from assumptions, each of which is marked.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scenes/experiment/document.h"

namespace photorque {

// The text of an experiment file for `diagnose` in `folder`. Lines with an assumption say CONFIRM.
// All recordings must be of one machine, with columns as those of the first. InputError for files
// that are neither recordings of motion nor curves of current over voltage, with the remedy where
// one is known.
std::string guess_experiment(const std::vector<std::filesystem::path>& recordings,
                             const std::filesystem::path& folder);

// Adds to the experiment the values that the recordings determine, by their channels.
void guess_motion(TomlDocument& experiment, const std::vector<std::filesystem::path>& recordings);
void guess_module(TomlDocument& experiment, const std::vector<std::filesystem::path>& recordings,
                  const std::filesystem::path& folder);

struct GuessedColumn {
  std::string in_file;       // as the header has it
  std::string channel;       // "gyro_x_deg_s", its unit that of the file; empty: unknown
  bool is_sure = true;       // stated by the file: the channel's own name, or its unit beside it
  std::string because = {};  // assumption behind one that is not sure
};

// The header of a CSV file: the last line before the first row of numbers that has as many cells.
// A clock whose name states no unit is recognised by its steps. Of a CCSDS AEM: its quaternion.
// InputError, naming the cure, for a file without such a header, with decimal commas, or in UTF-16.
std::vector<GuessedColumn> guess_columns(const std::filesystem::path& path);

}  // namespace photorque
