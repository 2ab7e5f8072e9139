// A first experiment for recordings of an unknown machine: from the columns, from the readings
// (noise, ratios of moments of inertia), and from assumptions, each of which is marked.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "attitude/recordings/recording.h"
#include "scenes/experiment/document.h"

namespace photorque {

// The text of an experiment file for `diagnose` in `folder`. Lines with an assumption contain
// CONFIRM. All recordings must be of one machine and have the columns of the first. Of `reading`,
// the header and the rate are used: they are those of files without a header or a time. Throws
// InputError for files that are neither recordings of motion nor curves of current over voltage,
// with the remedy if known.
std::string guess_experiment(const std::vector<std::filesystem::path>& recordings,
                             const std::filesystem::path& folder, RecordingOptions reading = {});

// Adds to the experiment the values that the recordings determine.
void guess_motion(TomlDocument& experiment, const std::vector<std::filesystem::path>& recordings,
                  const RecordingOptions& reading);

// Adds the table [module] for current-voltage curves. `reading.columns` are those of the voltage
// and the current if files are not read without. Throws InputError if a file contains another kind
// of recording.
void guess_module(TomlDocument& experiment, const std::vector<std::filesystem::path>& recordings,
                  const std::filesystem::path& folder, const RecordingOptions& reading);

// Writes header and rate into [recording] if they are stated.
void add_reading(TomlDocument& experiment, const RecordingOptions& reading);

// The remedy for counts of an encoder, in a message.
inline constexpr const char* counts_of_encoder =
    "an angle: divide the counts of an encoder by those of a turn, and name the column angle_rev";

struct GuessedColumn {
  std::string in_file;  // as in the header
  std::string channel;  // "gyro_x_deg_s", with the unit of the file; empty: unknown
  bool is_sure = true;  // stated by the file: the name of the channel, or its unit
  // The assumption, if not sure; "... the next column" follows.
  std::string because = {};
  // The channel that it shares with other columns, by its unit alone; `channel` is then empty.
  std::string shared = {};
  // The unknown unit for which it is left out; empty otherwise.
  std::string unknown_unit = {};
};

// Columns of a CSV file. Its header is `reading.header` or the last line before the first row of
// numbers that has as many cells. A clock without a unit in its name is recognised by its steps;
// without a clock, a column that counts frames has the channel "frame". For a CCSDS AEM: its
// quaternion. Throws InputError with the remedy for a file without such a header, with decimal
// commas, in UTF-16, or with an angle, a rate, a coordinate or a time in an unsuitable unit. Beside
// a time and another motion, a column in an unknown unit is left out, unless it is a component of
// the same vector.
std::vector<GuessedColumn> guess_columns(const std::filesystem::path& path,
                                         const RecordingOptions& reading = {});

// Whether one of them is an angle, a rate, a quaternion or a coordinate.
bool has_motion(const std::vector<GuessedColumn>& columns);

// Whether one of them is a time.
bool has_time(const std::vector<GuessedColumn>& columns);

// The command that names all columns of a file, for messages: by their channels, one voltage and
// one current, the time by its rise, and column_3 for others. Empty if that is neither a motion
// over time nor a curve.
std::string command_for_columns(const std::filesystem::path& path, const RecordingOptions& reading,
                                const std::vector<GuessedColumn>& columns);

// The names of the columns in quotes, for messages.
std::string names_in(const std::filesystem::path& path, const RecordingOptions& reading);

}  // namespace photorque
