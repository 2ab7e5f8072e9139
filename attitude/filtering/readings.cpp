#include "attitude/filtering/readings.h"

#include <algorithm>
#include <cmath>

#include "attitude/recordings/columns.h"
#include "core/errors.h"
#include "core/numerics/order.h"

namespace photorque {
namespace {

// The readings in order of time. Images from before `first_s` are assigned to `first_s`.
std::vector<Reading> in_time(const std::vector<Reading>& all, double first_s) {
  std::vector<Reading> sorted;
  for (const size_t i : sorted_indices(
           all.size(), [&](size_t a, size_t b) { return all[a].time_s < all[b].time_s; })) {
    sorted.push_back(all[i]);
    sorted.back().time_s = std::max(sorted.back().time_s, first_s);
  }
  return sorted;
}

}  // namespace

Readings readings_of(const Recording& recording, const std::string& name, const Platform& platform,
                     double camera_delay_s) {
  if (recording.rows() < 2) {
    throw InputError({name, 0}, "rows", std::to_string(recording.rows()), "at least 2");
  }
  const MotionColumns columns(recording, platform, name);
  if (!columns.has_attitude() && !columns.has_gyro()) {
    throw InputError({name, 0}, "header", "neither an attitude nor a rate about an axis",
                     "the attitude q_w, q_x, q_y, q_z, or gyro_x_rad_s, gyro_y_rad_s, "
                     "gyro_z_rad_s");
  }
  Readings readings;
  readings.name = name;
  readings.rows = recording.rows();
  readings.schedule = recording.schedule();
  readings.sees_axis = columns.sees_axis();
  readings.unused = columns.unused();
  readings.first_s = recording.time_s.front();
  readings.last_s = recording.time_s.back();
  // For one axis of rotation, the yaw is the attitude. With roll and pitch, it is part of the
  // attitude.
  const Channel* yaw =
      platform.turns_about_one_axis() || columns.has_angles() ? nullptr : recording.find("yaw_rad");
  double before_s = readings.first_s;
  bool any_attitude = false;
  for (size_t row = 0; row < recording.rows(); ++row) {
    Reading reading;
    reading.time_s = recording.time_s[row];
    reading.row = row;
    for (size_t k = 0; k < 3; ++k) {
      reading.gyro_rad_s[static_cast<Eigen::Index>(k)] = columns.rate_rad_s(k, row);
    }
    readings.has_gyro = readings.has_gyro || reading.has_gyro();
    if (yaw != nullptr) reading.yaw_rad = yaw->values[row];
    readings.has_yaw = readings.has_yaw || std::isfinite(reading.yaw_rad);
    reading.begins_anew = columns.has_event(row);
    const Quat attitude =
        columns.has_attitude() ? columns.attitude(row) : Quat(empty_cell, 0, 0, 0);
    if (std::isfinite(attitude.coeffs().sum())) {
      any_attitude = true;
      readings.longest_gap_s = std::max(readings.longest_gap_s, reading.time_s - before_s);
      before_s = reading.time_s;
      if (camera_delay_s == 0.0) {
        reading.lab_from_body = attitude;
      } else {
        Reading late;
        late.time_s = reading.time_s - camera_delay_s;
        late.lab_from_body = attitude;
        readings.all.push_back(late);
      }
    }
    readings.all.push_back(reading);
  }
  if (!any_attitude) readings.sees_axis = {};
  if (!any_attitude && !readings.has_gyro && !readings.has_yaw) {
    throw InputError({name, 0}, columns.first_name(), "no number in any row",
                     "attitudes of unit norm, or rates");
  }
  readings.all = in_time(readings.all, readings.first_s);
  return readings;
}

}  // namespace photorque
