// A recording as a filter takes it: readings by instant.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "attitude/model/platform.h"
#include "attitude/model/schedule.h"
#include "attitude/recordings/recording.h"
#include "attitude/recordings/sensors.h"

namespace photorque {

// The readings of one time. What was not read is empty or not finite.
struct Reading {
  double time_s = 0.0;
  std::optional<size_t> row;  // of the recording, whose estimate is wanted
  std::optional<Quat> lab_from_body;
  Vec3 gyro_rad_s = Vec3::Constant(empty_cell);
  double yaw_rad = empty_cell;
  bool begins_anew = false;  // something hit the platform

  bool has_gyro() const { return !gyro_rad_s.array().isNaN().all(); }
};

struct Readings {
  std::string name;
  std::vector<Reading> all;  // by time
  size_t rows = 0;
  Schedule schedule;
  // Lab axes about which the attitude is read.
  std::array<bool, 3> sees_axis = {false, false, false};
  bool has_gyro = false, has_yaw = false;
  double first_s = 0.0, last_s = 0.0;
  double longest_gap_s = 0.0;       // between attitudes
  std::vector<std::string> unused;  // columns
  bool sees_attitude() const { return sees_axis[0] || sees_axis[1] || sees_axis[2]; }
};

// Attitudes are dated back by `camera_delay_s`. Channels as MotionColumns reads them, and
// yaw_rad of an encoder. InputError when there is neither an attitude nor a rate, or only one
// row.
Readings readings_of(const Recording& recording, const std::string& name, const Platform& platform,
                     double camera_delay_s);

}  // namespace photorque
