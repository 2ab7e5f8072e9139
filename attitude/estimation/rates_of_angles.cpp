#include "attitude/estimation/rates_of_angles.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "attitude/estimation/axis_readings.h"
#include "attitude/recordings/columns.h"
#include "core/constants.h"
#include "core/numerics/median.h"

namespace photorque {

bool is_rate_of_angle(const Observation& rows, const Vec3& axis) {
  constexpr size_t fewest = 20;
  constexpr double exactly = 0.05;
  if (!rows.has_some_attitude() || !rows.has_gyro) return false;
  const AxisReadings angle = angles_about(rows, axis, 0, rows.blocks()),
                     read = rates_about(rows, axis, 0, rows.blocks());
  // The first or the last row often has no quotient.
  if (read.row.size() < fewest || read.row.size() + 4 < angle.row.size()) return false;
  std::vector<double> rate(rows.blocks(), NAN);
  for (size_t i = 0; i < read.row.size(); ++i) rate[read.row[i]] = read.value[i];
  std::vector<double> quotient;
  for (size_t i = 0; i + 1 < angle.row.size(); ++i) {
    quotient.push_back((angle.value[i + 1] - angle.value[i]) /
                       (angle.time_s[i + 1] - angle.time_s[i]));
  }
  // Sums of the scatter of neighbouring quotients and of the differences of the rates from the
  // quotients.
  double scatter = 0.0;
  std::array<double, 3> off = {};
  for (size_t i = 1; i + 1 < quotient.size(); ++i) {
    const double w = rate[angle.row[i]], before = quotient[i - 1], after = quotient[i],
                 before_s = angle.time_s[i] - angle.time_s[i - 1],
                 after_s = angle.time_s[i + 1] - angle.time_s[i], both_s = before_s + after_s;
    const double between = (before * before_s + after * after_s) / both_s,
                 parabola = (before * after_s + after * before_s) / both_s;
    if (!std::isfinite(w)) continue;
    scatter += std::abs(quotient[i + 1] - 2.0 * after + before);
    off[0] += std::abs(w - before);
    off[1] += std::abs(w - after);
    off[2] += std::min(std::abs(w - between), std::abs(w - parabola));
  }
  return scatter > 0.0 && std::ranges::min(off) <= exactly * scatter;
}

void drop_rates(Observation& rows) {
  rows.has_gyro = false;
  std::ranges::fill(rows.gyro_rows, Vec3::Zero().eval());
}

std::optional<Recording> with_rates_of_far_turns(const Recording& recording,
                                                 const Platform& platform) {
  constexpr double readings_per_turn = 9.0, fewest_turns = 10.0;
  if (!platform.turns_about_one_axis() || platform.slides()) return std::nullopt;
  const auto is_angle = [](const Channel& channel) {
    return std::ranges::any_of(std::array{"angle_rad", "roll_rad", "pitch_rad", "yaw_rad"},
                               [&](const char* name) { return channel.name == name; });
  };
  const auto angle = std::ranges::find_if(recording.channels, is_angle);
  if (angle == recording.channels.end()) return std::nullopt;
  const std::vector<std::string> unused = MotionColumns(recording, platform, "").unused();
  for (const Channel& channel : recording.channels) {
    const bool is_used = std::ranges::find(unused, channel.name) == unused.end();
    if (is_used && &channel != &*angle) return std::nullopt;
  }
  Recording result = recording;
  Channel rate{"rate_rad_s", {}};
  result.time_s.clear();
  std::vector<double> turned_rad;
  size_t before = recording.rows();
  for (size_t i = 0; i < recording.rows(); ++i) {
    if (!std::isfinite(angle->values[i])) continue;
    if (before < recording.rows()) {
      const double by_rad = angle->values[i] - angle->values[before],
                   interval_s = recording.time_s[i] - recording.time_s[before];
      if (!turned_rad.empty() && by_rad * turned_rad.front() < 0.0) return std::nullopt;
      turned_rad.push_back(by_rad);
      result.time_s.push_back(recording.time_s[before] + 0.5 * interval_s);
      rate.values.push_back(by_rad / interval_s);
    }
    before = i;
  }
  double turns = 0.0;
  for (double& by_rad : turned_rad) turns += (by_rad = std::abs(by_rad)) / (2.0 * pi);
  if (turns < fewest_turns || upper_median(turned_rad) * readings_per_turn < 2.0 * pi) {
    return std::nullopt;
  }
  result.channels = {std::move(rate)};
  return result;
}

}  // namespace photorque
