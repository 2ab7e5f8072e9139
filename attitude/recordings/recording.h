// Recordings: readings of a real or a simulated laboratory.
//
// A CSV with a header that names channels and units (also .csv.gz). Real files have a preamble,
// gaps, repeated and jittered times, outliers and quaternions with flipped signs. The reader
// repairs what is possible, leaves out the rest, and counts all of it.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "attitude/model/schedule.h"
#include "core/settings/keys.h"

namespace photorque {

// A cell without a value.
inline constexpr double empty_cell = std::numeric_limits<double>::quiet_NaN();

struct Channel {
  std::string name;            // ends in its SI unit: "gyro_x_rad_s"
  std::vector<double> values;  // one per row; NaN: empty
};

// Findings of the reader. Counts are numbers of rows unless stated otherwise.
struct RecordingReport {
  int64_t rows_read = 0;  // data rows in the file
  int64_t rows_kept = 0;
  int64_t preamble_lines = 0;
  int64_t malformed_rows = 0;     // wrong number of cells (a torn last line): left out
  int64_t rows_without_time = 0;  // left out
  int64_t repeated_times = 0;     // a repeated time: left out
  int64_t backward_times = 0;     // earlier than a row before: left out
  int64_t isolated_rows = 0;      // at an end, beyond a jump of the clock: left out
  int64_t first_backward_line = 0;
  int64_t first_repeated_line = 0;
  int64_t empty_cells = 0;          // cells
  int64_t unreadable_cells = 0;     // cells without a number: emptied
  int64_t held_readings = 0;        // repeated until the next one (remove_held_readings())
  int64_t outlier_cells = 0;        // cells of measured channels: emptied
  int64_t bad_quaternions = 0;      // of a norm that is not 1 to 1 %: emptied
  int64_t flipped_quaternions = 0;  // sign changes undone
  struct Gap {
    double from_s = 0.0, to_s = 0.0;
  };
  std::vector<Gap> gaps;  // between rows more than five median intervals apart
  double median_interval_s = 0.0;
  double jitter_s = 0.0;                    // standard deviation of the intervals, gaps left out
  std::map<std::string, int64_t> outliers;  // cells by channel
  // Rows for which a held reading is repeated, by the first channel of the instrument.
  std::map<std::string, int64_t> rows_per_reading;
  bool has_decimal_commas = false;       // "0,25" between other separators, read as 0.25
  bool has_old_yaw = false;              // a column named heading, read as yaw
  std::set<std::string> absent_columns;  // named by the options, not in the file

  // The report in a few lines, with only the findings that occurred.
  std::string text() const;
};

struct Recording {
  std::vector<double> time_s;  // strictly increasing
  std::vector<Channel> channels;
  RecordingReport report;
  // Sequence of roll, pitch and yaw ("zyx": q = Rz(yaw) Ry(pitch) Rx(roll)); empty: not stated.
  std::string angle_sequence = {};

  // Null if there is no such channel.
  const Channel* find(std::string_view name) const;
  Channel* find(std::string_view name);
  size_t rows() const { return time_s.size(); }

  // The recorded commands, battery current and wheel speeds, each held until the next row
  // (zero-order hold; wheel speeds are piecewise linear).
  Schedule schedule() const;
};

// Channels of an attitude and of a gyro.
inline constexpr std::array quaternion_names = {"q_w", "q_x", "q_y", "q_z"};
inline constexpr std::array gyro_names = {"gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s"};
// Channels that Recording::schedule() uses.
inline constexpr std::array schedule_channels = {
    "command_x_N_m", "command_y_N_m",    "command_z_N_m",     "command_x_N",
    "command_y_N",   "command_body_x_N", "command_body_y_N",  "wheel_x_rad_s",
    "wheel_y_rad_s", "wheel_z_rad_s",    "battery_current_A", "led_current_A"};
// Channels of which one flags sudden changes of the motion.
inline constexpr std::array event_channels = {"thruster", "impulse", "event"};

struct RecordingOptions {
  // Names in the file by channel: {"gyro_x_rad_s", "wx"}. A channel may have another unit of its
  // kind ("gyro_x_deg_s"); it is converted and renamed.
  std::map<std::string, std::string> columns = {};
  std::vector<std::string> header = {};  // names of the columns of a file without a header
  // Rows per second of a file without a time. A row's time is its number, or its value in the
  // column `frame`, divided by this rate.
  std::optional<double> rate_Hz = {};
  bool remove_outliers = true;
  bool omit_isolated_rows = true;   // at the ends, beyond a jump of the clock (cleaning.h)
  std::string angle_sequence = {};  // of the recording
  // A point about which the position x_m, y_m rotates. The positions are then converted to one
  // angle from the vertical through it.
  std::optional<std::array<double, 2>> pivot_m = {};
  // Maximum number of stored cells, times included (8 bytes each).
  int64_t max_cells = 150'000'000;
};
// Reads [recording].
RecordingOptions read_recording_options(const Settings& settings);

// Reads a recording. InputError with file and line if the file cannot be read or decompressed, has
// no header with t_s, no usable row, more cells than allowed, or mostly decreasing times.
Recording read_recording(const std::filesystem::path& path, const RecordingOptions& options = {});

// InputError for a column that [recording] names but no recording has, for example due to a
// spelling error. `absent_columns`: a set of absent names for each recording.
void refuse_absent_columns(const Settings& recording,
                           const std::vector<std::set<std::string>>& absent_columns);
void refuse_absent_columns(const Settings& recording, const std::vector<const Recording*>& of);

// Reads a schedule of commands from a file in the format of a recording. If it has no attitude,
// that is, no clock of an instrument, times that do not increase are an InputError.
Schedule read_command_file(const std::filesystem::path& path);

// Writes a recording as CSV, compressed if the name ends in ".gz". `preamble` lines are written as
// comments. Reading the numbers again gives bitwise equal values.
void write_recording(const std::filesystem::path& path, const Recording& recording,
                     const std::vector<std::string>& preamble = {});

// The keys of [recording].
Key recording_table();

}  // namespace photorque
