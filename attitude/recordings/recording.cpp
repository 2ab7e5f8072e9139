#include "attitude/recordings/recording.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <utility>

#include "attitude/recordings/aem.h"
#include "attitude/recordings/cleaning.h"
#include "attitude/recordings/columns.h"
#include "attitude/recordings/text_lines.h"
#include "core/constants.h"
#include "core/files.h"
#include "core/text/parse.h"

namespace photorque {

namespace {

constexpr const char *old_yaw = "heading_rad", *new_yaw = "yaw_rad";
// Known channels besides gyro, commands and scalars: time, power, and the motion about one axis.
constexpr std::array other_channels = {"t_s",
                                       "array_power_W",
                                       "array_voltage_V",
                                       "array_current_A",
                                       "cell_temperature_K",
                                       "battery_voltage_V",
                                       "angle_rad",
                                       "rate_rad_s",
                                       old_yaw};

// One column of the file: its channel and the factor to SI.
struct FileColumn {
  std::string name;
  double to_SI = 1.0;
};

// The known channels and their units. A header may name them in another unit of the same kind.
// Computed once, because a preamble may have a million cells that could be names.
const std::vector<std::pair<std::string, KeyUnit>>& known_channels() {
  static const auto known = [] {
    std::vector<std::string> names(other_channels.begin(), other_channels.end());
    names.insert(names.end(), gyro_names.begin(), gyro_names.end());
    names.insert(names.end(), schedule_channels.begin(), schedule_channels.end());
    for (int s = 0; s < scalar_count; ++s) {
      names.emplace_back(channel_traits(vector_channels + s).column);
    }
    std::vector<std::pair<std::string, KeyUnit>> all;
    for (const std::string& name : names) all.emplace_back(name, unit_of_key(name));
    return all;
  }();
  return known;
}

FileColumn column_named(const std::string& in_file, const RecordingOptions& options) {
  const std::string name(name_of_column(in_file, options.columns));
  const KeyUnit unit = unit_of_key(name);
  for (const auto& [channel, known] : known_channels()) {
    if (known.stem == unit.stem && known.dimension == unit.dimension) return {channel, unit.to_SI};
  }
  return {name, 1.0};
}

class RecordingReader {
 public:
  RecordingReader(const std::filesystem::path& path, const RecordingOptions& options)
      : path_(path), options_(options), lines_(path, options.header) {}

  Recording read() {
    if (is_aem(path_)) {
      take_attitudes();
      finish();
      return std::move(recording_);
    }
    read_header();
    std::string_view line;
    while (lines_.next(line)) {
      if (unquoted(line).empty() || line.front() == '#') {
        ++recording_.report.preamble_lines;
        continue;
      }
      take_row(line);
    }
    finish();
    return std::move(recording_);
  }

 private:
  InputError error(const std::string& key, const std::string& found,
                   const std::string& expected) const {
    return {{path_.string(), static_cast<int>(lines_.number())}, key, found, expected};
  }

  // Reads an AEM: attitudes, and rates if it has any.
  void take_attitudes() {
    const std::vector<AemAttitude> attitudes = read_aem(path_).rows;
    for (const auto& [channel, written] : options_.columns) {
      recording_.report.absent_columns.insert(written);
    }
    for (const char* name : quaternion_names) recording_.channels.push_back({name, {}});
    if (std::ranges::any_of(attitudes,
                            [](const auto& row) { return row.rate_body_rad_s.has_value(); })) {
      for (const char* name : gyro_names) recording_.channels.push_back({name, {}});
    }
    for (const AemAttitude& row : attitudes) {
      ++recording_.report.rows_read;
      if (!take_time(row.time_s, row.line)) continue;
      const Quat& q = row.lab_from_body;
      const Vec3 rate = row.rate_body_rad_s.value_or(Vec3::Constant(empty_cell));
      const double values[] = {q.w(), q.x(), q.y(), q.z(), rate.x(), rate.y(), rate.z()};
      for (size_t k = 0; k < recording_.channels.size(); ++k) {
        recording_.channels[k].values.push_back(values[k]);
      }
    }
  }

  // Whether the time of the last row is wrong: two successive rows lie between those before it and
  // itself. The first of the two is left out by then.
  bool is_after_wrong_time(double time_s) {
    const std::vector<double>& t = recording_.time_s;
    const double before_s = t.size() > 1 ? t[t.size() - 2] : -INFINITY;
    const bool is_between = !t.empty() && time_s > before_s && time_s < t.back();
    const bool is_second = is_between && fallen_s_ && time_s > *fallen_s_;
    fallen_s_ = is_between && !is_second ? std::optional(time_s) : std::nullopt;
    return is_second;
  }

  // Appends the time of a row; false if it does not increase.
  bool take_time(double time_s, int64_t line) {
    RecordingReport& report = recording_.report;
    if (is_after_wrong_time(time_s)) {
      ++report.backward_times;
      recording_.time_s.pop_back();
      for (Channel& channel : recording_.channels) channel.values.pop_back();
    } else if (!recording_.time_s.empty() && time_s <= recording_.time_s.back()) {
      if (time_s == recording_.time_s.back()) {
        if (++report.repeated_times == 1) report.first_repeated_line = line;
      } else if (++report.backward_times == 1) {
        report.first_backward_line = line;
      }
      return false;
    }
    kept_cells_ += static_cast<int64_t>(recording_.channels.size()) + 1;
    if (kept_cells_ > options_.max_cells) {
      throw error("", "more than " + std::to_string(options_.max_cells) + " numbers",
                  "a recording that is shorter or has fewer channels");
    }
    recording_.time_s.push_back(time_s);
    return true;
  }

  // The header is the first line that names the time (with a stated rate: the frame, or a channel).
  // The lines before it are preamble.
  void read_header() {
    constexpr int max_preamble_lines = 10000;
    std::string_view line;
    std::string first_line;
    for (int i = 0; i < max_preamble_lines && lines_.next(line); ++i) {
      if (first_line.empty() && !line.starts_with("#")) first_line = trimmed(line);
      for (const char separator : {',', ';', '\t', ' '}) {
        if (take_header(line, separator)) return;
      }
      ++recording_.report.preamble_lines;
    }
    if (first_line.empty()) {
      throw InputError({path_.string()}, "header", "an empty file",
                       "a header with t_s [s] and the channels, and rows of numbers");
    }
    const std::string named = options_.rate_Hz ? "frame or a channel" : "t_s";
    throw InputError(
        {path_.string(), 1}, "header",
        "no line that names " + named + " (the first is " + in_quotes(first_line) + ")",
        "a header with t_s [s] and the channels, or a table [recording.columns] with "
        "the names of the columns; photorque diagnose --guess " +
            path_.filename().string() + " writes one");
  }

  bool take_header(std::string_view line, char separator) {
    split_cells(line, separator, cells_);
    columns_.clear();
    time_column_.reset();
    bool names_channel = false;
    for (size_t i = 0; i < cells_.size(); ++i) {
      columns_.push_back(column_named(std::string(cells_[i]), options_));
      const std::string& name = columns_.back().name;
      names_channel = names_channel ||
                      std::ranges::any_of(known_channels(),
                                          [&](const auto& known) { return known.first == name; });
      if (name == (options_.rate_Hz ? "frame" : "t_s")) time_column_ = i;
    }
    if (!time_column_ && !(options_.rate_Hz && names_channel)) return false;
    if (options_.rate_Hz &&
        std::ranges::find(columns_, "t_s", &FileColumn::name) != columns_.end()) {
      throw error("rate_Hz", "a column with the time beside a stated rate", "only one of them");
    }
    separator_ = separator;
    while (columns_.back().name.empty()) columns_.pop_back();
    take_old_names();
    for (size_t i = 0; i < columns_.size(); ++i) {
      const std::string& name = columns_[i].name;
      if (is_left_out(i)) continue;
      if (name == "t_s" || recording_.find(name) != nullptr) {
        throw error("header", "the column " + name + " twice", "every channel once");
      }
      recording_.channels.push_back({name, {}});
    }
    for (const auto& [channel, written] : options_.columns) {
      const std::string name = successor_of(column_named(written, options_).name);
      const bool has = std::ranges::find(columns_, name, &FileColumn::name) != columns_.end();
      if (!has) recording_.report.absent_columns.insert(written);
    }
    return true;
  }

  // Whether column `i` is no channel: the time, or a column without a name, as of row numbers.
  bool is_left_out(size_t i) const { return i == time_column_ || columns_[i].name.empty(); }

  // The former name of the yaw of body x is "heading". A column of this name is the yaw unless the
  // file has a yaw too. It is then the direction of the tilt.
  void take_old_names() {
    if (std::ranges::find(columns_, new_yaw, &FileColumn::name) != columns_.end()) return;
    const auto column = std::ranges::find(columns_, old_yaw, &FileColumn::name);
    if (column == columns_.end()) return;
    column->name = new_yaw;
    recording_.report.has_old_yaw = true;
  }

  // The name that replaces a former name of a channel in this file.
  std::string successor_of(const std::string& channel) const {
    return recording_.report.has_old_yaw && channel == old_yaw ? new_yaw : channel;
  }

  void take_row(std::string_view line) {
    RecordingReport& report = recording_.report;
    ++report.rows_read;
    split_cells(line, separator_, cells_);
    while (cells_.size() > columns_.size() && trimmed(cells_.back()).empty()) cells_.pop_back();
    if (cells_.size() != columns_.size()) {
      ++report.malformed_rows;
      // A row that ends behind its time has no reading, as of a frame in which Tracker has no mark.
      if (cells_.size() == 1 && time_column_ == 0U && std::isfinite(time_of_row())) {
        ++rows_of_times_;
      } else if (!first_malformed_) {
        first_malformed_ = wrong_row({path_.string(), static_cast<int>(lines_.number())},
                                     cells_.size(), columns_.size());
      }
      return;
    }
    const double time_s = time_of_row();
    if (!std::isfinite(time_s)) {  // of hours, say, as seconds
      if (++report.rows_without_time == 1) {
        first_without_time_ =
            error(columns_[*time_column_].name, in_quotes(cells_[*time_column_]), "a number");
      }
      return;
    }
    if (!take_time(time_s, lines_.number())) return;
    size_t channel = 0;
    for (size_t i = 0; i < cells_.size(); ++i) {
      if (is_left_out(i)) continue;
      std::optional<double> value = number_of(cells_[i]);
      if (!value) {
        ++report.unreadable_cells;
        value = empty_cell;
      } else if (std::isnan(*value)) {
        ++report.empty_cells;
      } else if (std::isinf(*value * columns_[i].to_SI)) {
        ++report.unreadable_cells;
        value = empty_cell;
      }
      recording_.channels[channel++].values.push_back(*value * columns_[i].to_SI);
    }
  }

  // NaN if the cell of the time is no number.
  double time_of_row() {
    if (!time_column_)
      return static_cast<double>(recording_.report.rows_read - 1) / *options_.rate_Hz;
    const double time = number_of(cells_[*time_column_]).value_or(empty_cell);
    return options_.rate_Hz ? time / *options_.rate_Hz : time * columns_[*time_column_].to_SI;
  }

  std::optional<double> number_of(std::string_view cell) {
    const std::optional<double> number = number_of_cell(cell, separator_);
    if (number && separator_ != ',' && cell.find(',') != std::string_view::npos) {
      recording_.report.has_decimal_commas = true;
    }
    return number;
  }

  // A few damaged rows are left out. If most rows are damaged, the file is not valid.
  void require_mostly_whole() const {
    const RecordingReport& report = recording_.report;
    if (first_malformed_ && report.malformed_rows - rows_of_times_ > report.rows_kept)
      throw *first_malformed_;
    if (first_without_time_ && report.rows_without_time > report.rows_kept) {
      throw *first_without_time_;
    }
  }

  // Converts a position that rotates about a pivot to an angle. Zero is the vertical on the side of
  // the readings, because y often points down in pictures.
  void read_as_angle(const std::array<double, 2>& pivot_m) {
    Channel *x = recording_.find("x_m"), *y_channel = recording_.find("y_m");
    if (x == nullptr || y_channel == nullptr || recording_.find("angle_rad") != nullptr) {
      throw error("pivot_m", "no columns x_m and y_m, or an angle_rad beside them",
                  "the coordinates of a body that turns about the pivot");
    }
    const std::vector<double>& y = y_channel->values;
    double above = 0.0, before = 0.0;
    for (const double value : y) above += std::isfinite(value) ? value - pivot_m[1] : 0.0;
    const double side = above > 0.0 ? 1.0 : -1.0;
    for (size_t i = 0; i < y.size(); ++i) {
      const double angle = std::atan2(x->values[i] - pivot_m[0], side * (y[i] - pivot_m[1]));
      if (!std::isfinite(angle)) {
        x->values[i] = empty_cell;
        continue;
      }
      before += std::remainder(angle - before, 2.0 * pi);
      x->values[i] = before;
    }
    x->name = "angle_rad";
    std::erase_if(recording_.channels, [](const Channel& c) { return c.name == "y_m"; });
  }

  void finish() {
    if (options_.pivot_m) read_as_angle(*options_.pivot_m);
    recording_.angle_sequence = options_.angle_sequence;
    RecordingReport& report = recording_.report;
    report.rows_kept = static_cast<int64_t>(recording_.rows());
    require_mostly_whole();
    if (report.backward_times > report.rows_kept) {
      throw InputError({path_.string(), static_cast<int>(report.first_backward_line)}, "t_s",
                       "times that fall in " + std::to_string(report.backward_times) + " rows",
                       "times that rise");
    }
    if (report.rows_kept < 2) {
      throw error(
          "",
          std::to_string(report.rows_kept) + " usable rows of " + std::to_string(report.rows_read),
          "at least two");
    }
    constexpr double longest_s = 1e10;  // 300 years: such a column has another unit
    const double first_s = recording_.time_s.front(), last_s = recording_.time_s.back();
    if (!(last_s - first_s <= longest_s)) {
      throw error("t_s", "times from " + shortest(first_s) + " to " + shortest(last_s) + " s",
                  "a recording of at most " + shortest(longest_s) + " s, times in seconds");
    }
    const bool any = std::ranges::any_of(recording_.channels, [](const Channel& channel) {
      return !std::ranges::all_of(channel.values, [](double x) { return std::isnan(x); });
    });
    if (!any) throw error("", "no number in any channel", "at least one channel with values");
    if (options_.omit_isolated_rows) omit_isolated_rows(recording_);
    repair_quaternions(recording_);
    remove_held_readings(recording_);
    if (options_.remove_outliers) remove_outliers(recording_);
    measure_times(recording_);
  }

  std::filesystem::path path_;
  const RecordingOptions& options_;
  TextLines lines_;
  Recording recording_;
  std::vector<FileColumn> columns_;
  std::vector<std::string_view> cells_;
  std::optional<size_t> time_column_;  // none: rows are counted
  char separator_ = ',';
  int64_t kept_cells_ = 0;
  std::optional<double> fallen_s_;  // the time of a row left out below the last row's time
  std::optional<InputError> first_malformed_, first_without_time_;
  int64_t rows_of_times_ = 0;
};

std::string cell_text(double value) {
  return std::isnan(value) ? "" : shortest(value);
}

}  // namespace

const Channel* Recording::find(std::string_view name) const {
  const auto it = std::ranges::find(channels, name, &Channel::name);
  return it == channels.end() ? nullptr : &*it;
}

Channel* Recording::find(std::string_view name) {
  return const_cast<Channel*>(std::as_const(*this).find(name));
}

Recording read_recording(const std::filesystem::path& path, const RecordingOptions& options) {
  return RecordingReader(path, options).read();
}

void write_recording(const std::filesystem::path& path, const Recording& recording,
                     const std::vector<std::string>& preamble) {
  std::string text;
  for (const std::string& line : preamble) text += "# " + line + "\n";
  text += "t_s";
  for (const Channel& channel : recording.channels) text += "," + channel.name;
  text += "\n";
  for (size_t i = 0; i < recording.rows(); ++i) {
    text += cell_text(recording.time_s[i]);
    for (const Channel& channel : recording.channels) {
      text += ',' + cell_text(channel.values[i]);
    }
    text += '\n';
  }
  write_file_whole(path, path.extension() == ".gz" ? gzip(text) : text);
}

std::string RecordingReport::text() const {
  std::ostringstream out;
  out << rows_read << " rows read, " << rows_kept << " kept, every " << median_interval_s << " s";
  const auto note = [&](int64_t count, const char* what) {
    if (count > 0) out << "\n" << count << " " << what;
  };
  if (jitter_s > 1e-3 * median_interval_s) out << " with a jitter of " << jitter_s << " s";
  note(malformed_rows, "rows with a wrong number of cells left out");
  note(rows_without_time, "rows without a time left out");
  note(repeated_times, "rows that repeat a time left out");
  note(backward_times, "rows out of order left out");
  note(isolated_rows, "rows at an end beyond a jump of the clock left out");
  note(static_cast<int64_t>(gaps.size()), "gaps");
  note(empty_cells, "empty cells");
  note(unreadable_cells, "cells that hold no number");
  note(bad_quaternions, "quaternions that are not of unit norm left out");
  note(flipped_quaternions, "sign flips of the quaternion undone");
  if (held_readings > 0) out << "\n" << held_readings_text(*this);
  for (const auto& [channel, count] : outliers) {
    out << "\n" << count << " outliers in " << channel << " left out";
  }
  if (has_old_yaw) {
    out << "\nthe column heading is read as yaw, the azimuth of body x: name it " << new_yaw;
  }
  for (const std::string& column : absent_columns) {
    out << "\nthe column " << column << ", which [recording] names, is not in it";
  }
  return out.str();
}

}  // namespace photorque
