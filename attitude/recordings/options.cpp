#include <algorithm>

#include "attitude/recordings/recording.h"
#include "core/settings/typed_keys.h"
#include "core/text/parse.h"

namespace photorque {
namespace {

namespace recording_key {
constexpr OtherKey columns(
    "columns", Key::a_table,
    "`{ gyro_x_rad_s = \"wx\", … }`: names of the columns in the file. The unit in a "
    "key is that of the column: `gyro_x_deg_s = \"wx\"`",
    {.usually = "the names of the channels"});
constexpr TextsKey header("header",
                          "the names of the columns of a file without a header: "
                          "`[\"t_s\", \"angle_deg\"]`",
                          {.optional = true});
constexpr NumberKey rate("rate_Hz", Range{0.0, 1e9, true},
                         "rows or video frames per second, of a file without a time. The time of a "
                         "row is its number, or its value in the column `frame`, divided by this",
                         {.optional = true});
constexpr ChoiceKey angle_sequence(
    "angle_sequence",
    {{"found",
      "the one with which the rates integrate to the angles; `zyx` where there are no rates"},
     {"zyx", "q = Rz(yaw) Ry(pitch) Rx(roll)"},
     {"xyz", "q = Rx(roll) Ry(pitch) Rz(yaw)"},
     {"xzy", "q = Rx(roll) Rz(yaw) Ry(pitch)"},
     {"yxz", "q = Ry(pitch) Rx(roll) Rz(yaw)"},
     {"yzx", "q = Ry(pitch) Rz(yaw) Rx(roll)"},
     {"zxy", "q = Rz(yaw) Rx(roll) Ry(pitch)"}},
    0, "order of the rotations by roll, pitch and yaw, each about an axis of the rotated frame");
constexpr FlagKey remove_outliers(
    "remove_outliers", true,
    "removes readings of attitude and gyro that are far from all neighbours");
constexpr NumbersKey pivot("pivot_m", {},
                           "[x, y] of a point about which the place `x_m`, `y_m` turns, as the "
                           "bob of a pendulum in a video: they are read as one angle, "
                           "counterclockwise from the vertical through it",
                           {.optional = true, .size = 2});
constexpr TableKey recording("recording", "how files of recordings are read");
}  // namespace recording_key

// Throws InputError for a channel whose column states another unit of its quantity in brackets.
void require_unit(const Settings& columns, const std::string& channel, const std::string& written) {
  const size_t open = written.find_last_of("(["), close = written.find_last_of(")]");
  if (open == written.npos || close == written.npos || close < open) return;
  std::string inside = written.substr(open + 1, close - open - 1);
  std::ranges::replace(inside, '/', '_');
  const KeyUnit wanted = unit_of_key(channel), stated = unit_of_key("x_" + inside);
  if (stated.stem != "x" || stated.dimension != wanted.dimension || stated.to_SI == wanted.to_SI) {
    return;
  }
  throw columns.error(channel, in_quotes(written) + ", a column in " + stated.unit,
                      wanted.stem + "_" + stated.unit + " = " + in_quotes(written));
}

}  // namespace

Key recording_table() {
  using namespace recording_key;
  return recording_key::recording.of(
      {columns, header, rate, angle_sequence, recording_key::remove_outliers, pivot});
}

RecordingOptions read_recording_options(const Settings& settings) {
  RecordingOptions options;
  if (settings.has(recording_key::columns)) {
    const Settings columns = settings.table(recording_key::columns);
    for (const std::string& channel : columns.keys()) {
      options.columns[channel] = columns.text(channel);
      require_unit(columns, channel, options.columns[channel]);
    }
  }
  if (settings.has(recording_key::header)) options.header = settings.get(recording_key::header);
  if (settings.has(recording_key::rate)) options.rate_Hz = settings.get(recording_key::rate);
  options.remove_outliers = settings.get(recording_key::remove_outliers);
  if (settings.has(recording_key::pivot)) {
    const std::vector<double> pivot_m = settings.get(recording_key::pivot);
    options.pivot_m = {pivot_m[0], pivot_m[1]};
  }
  const size_t sequence = settings.get(recording_key::angle_sequence);
  if (sequence > 0) options.angle_sequence = recording_key::angle_sequence.words[sequence].name;
  return options;
}

void refuse_absent_columns(const Settings& settings, const std::vector<const Recording*>& of) {
  std::vector<std::set<std::string>> absent_columns;
  for (const Recording* one : of) absent_columns.push_back(one->report.absent_columns);
  refuse_absent_columns(settings, absent_columns);
}

void refuse_absent_columns(const Settings& recording,
                           const std::vector<std::set<std::string>>& absent_columns) {
  if (!recording.has(recording_key::columns)) return;
  const Settings columns = recording.table(recording_key::columns);
  for (const std::string& channel : columns.keys()) {
    const std::string written = columns.text(channel);
    const bool absent = std::ranges::all_of(
        absent_columns, [&](const std::set<std::string>& one) { return one.contains(written); });
    if (absent) {
      throw columns.error(channel, in_quotes(written) + ", which the recording has not",
                          "one of its columns");
    }
  }
}

}  // namespace photorque
