// Readings that a log repeats until the sensor gives the next one (sample and hold).
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>

#include "attitude/recordings/cleaning.h"
#include "attitude/recordings/columns.h"

namespace photorque {
namespace {

bool is_same(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

// The channels of each instrument.
std::vector<std::vector<Channel*>> instruments(Recording& recording) {
  std::map<Measures, std::vector<Channel*>> by_quantity;
  const auto append = [&](Measures measures, const char* name) {
    if (Channel* channel = recording.find(name)) by_quantity[measures].push_back(channel);
  };
  for (const char* name : quaternion_names) append(Measures::angle, name);
  append(Measures::angle, "angle_rad");
  for (const char* name : gyro_names) append(Measures::rate, name);
  append(Measures::rate, "rate_rad_s");
  for (int s = 0; s < scalar_count; ++s) {
    const ChannelTraits& traits = channel_traits(vector_channels + s);
    append(traits.measures, traits.column);
  }
  std::vector<std::vector<Channel*>> all;
  for (auto& [measures, channels] : by_quantity) all.push_back(std::move(channels));
  return all;
}

// First rows of the runs of equal readings of an instrument, by position in `rows`.
std::vector<size_t> first_of_runs(const std::vector<Channel*>& channels,
                                  const std::vector<size_t>& rows) {
  std::vector<size_t> first;
  for (size_t i = 0; i < rows.size(); ++i) {
    const bool is_equal = i > 0 && std::ranges::all_of(channels, [&](const Channel* channel) {
                            return is_same(channel->values[rows[i]], channel->values[rows[i - 1]]);
                          });
    if (!is_equal) first.push_back(i);
  }
  return first;
}

// Whether most changes are larger than the smallest one of their channel. A slow motion in coarse
// digits has equal readings, too, but it changes by one digit at a time.
bool skips_digits(const std::vector<Channel*>& channels, const std::vector<size_t>& rows,
                  const std::vector<size_t>& first) {
  constexpr double one_digit = 1.5;
  std::vector<bool> is_large(first.size(), false);
  for (const Channel* channel : channels) {
    std::vector<double> size(first.size(), 0.0);
    double least = std::numeric_limits<double>::infinity();
    for (size_t k = 1; k < first.size(); ++k) {
      size[k] = std::abs(channel->values[rows[first[k]]] - channel->values[rows[first[k] - 1]]);
      if (size[k] > 0.0) least = std::min(least, size[k]);
    }
    for (size_t k = 1; k < first.size(); ++k) {
      if (size[k] > one_digit * least) is_large[k] = true;
    }
  }
  return 2 * std::ranges::count(is_large, true) > std::ssize(first);
}

// Number of rows for which each reading is held; 1: readings are not held. A sensor that is not in
// phase with the log is held for two numbers of rows that differ by one. Equal successive readings
// give multiples.
size_t rows_per_reading(const std::vector<size_t>& first) {
  constexpr size_t fewest_runs = 20;
  constexpr double nearly_all = 0.9;
  if (first.size() < fewest_runs) return 1;
  std::map<size_t, size_t> runs;  // by length, without the first and the last, which may be cut
  for (size_t k = 1; k + 1 < first.size(); ++k) ++runs[first[k + 1] - first[k]];
  const size_t length =
      std::ranges::max_element(runs, {}, [](const auto& run) { return run.second; })->first;
  if (length < 2) return 1;
  const auto count = [&](size_t of) { return runs.contains(of) ? runs.at(of) : size_t{0}; };
  const size_t other =
      length > 2 && count(length - 1) > count(length + 1) ? length - 1 : length + 1;
  size_t regular = count(other);
  for (const auto& [of, number] : runs) {
    if (of % length == 0 && of != other) regular += number;
  }
  const auto all = static_cast<double>(first.size() - 2);
  return static_cast<double>(regular) >= nearly_all * all ? length : 1;
}

// Empties the repetitions of an instrument's readings.
void empty_repetitions(const std::vector<Channel*>& channels, RecordingReport& report) {
  std::vector<size_t> rows;  // with a reading
  for (size_t i = 0; i < channels.front()->values.size(); ++i) {
    const bool is_read = std::ranges::any_of(
        channels, [i](const Channel* channel) { return !std::isnan(channel->values[i]); });
    if (is_read) rows.push_back(i);
  }
  const std::vector<size_t> first = first_of_runs(channels, rows);
  const size_t held = rows_per_reading(first);
  if (held < 2 || !skips_digits(channels, rows, first)) return;
  report.rows_per_reading[channels.front()->name] = static_cast<int64_t>(held);
  for (size_t k = 0; k < first.size(); ++k) {
    const size_t end = k + 1 < first.size() ? first[k + 1] : rows.size();
    const size_t readings = std::max<size_t>(1, (end - first[k]) / held);
    for (size_t i = first[k]; i < end; ++i) {
      const size_t since = i - first[k];
      if (since % held == 0 && since / held < readings) continue;
      for (Channel* channel : channels) channel->values[rows[i]] = empty_cell;
      ++report.held_readings;
    }
  }
}

// Removes the rows in which every instrument is empty and no input changes.
void remove_empty_rows(Recording& recording, const std::vector<std::vector<Channel*>>& measured) {
  std::vector<const Channel*> inputs;
  for (const auto& names : {std::span<const char* const>(schedule_channels),
                            std::span<const char* const>(event_channels)}) {
    for (const char* name : names) {
      if (const Channel* channel = recording.find(name)) inputs.push_back(channel);
    }
  }
  std::vector<size_t> kept;
  for (size_t i = 0; i < recording.rows(); ++i) {
    const auto is_read = [i](const Channel* channel) { return !std::isnan(channel->values[i]); };
    const auto changes = [i](const Channel* channel) {
      return i == 0 || !is_same(channel->values[i], channel->values[i - 1]);
    };
    if (std::ranges::any_of(inputs, changes) ||
        std::ranges::any_of(measured, [&](const std::vector<Channel*>& channels) {
          return std::ranges::any_of(channels, is_read);
        })) {
      kept.push_back(i);
    }
  }
  const auto thin = [&kept](std::vector<double>& values) {
    for (size_t k = 0; k < kept.size(); ++k) values[k] = values[kept[k]];
    values.resize(kept.size());
  };
  thin(recording.time_s);
  for (Channel& channel : recording.channels) thin(channel.values);
}

}  // namespace

void remove_held_readings(Recording& recording) {
  const std::vector<std::vector<Channel*>> measured = instruments(recording);
  for (const std::vector<Channel*>& channels : measured) {
    empty_repetitions(channels, recording.report);
  }
  if (recording.report.held_readings == 0) return;
  remove_empty_rows(recording, measured);
  recording.report.rows_kept = static_cast<int64_t>(recording.rows());
}

std::string held_readings_text(const RecordingReport& report) {
  std::string text;
  for (const auto& [channel, rows] : report.rows_per_reading) {
    text += (text.empty() ? "" : ", ") + std::to_string(rows) + " rows of " + channel;
  }
  return std::to_string(report.held_readings) +
         " held readings left out (the sensor is slower than the log: one reading per " + text +
         ")";
}

}  // namespace photorque
