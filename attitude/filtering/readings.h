// A recording as input of a filter: readings in order of time.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "attitude/model/platform.h"
#include "attitude/model/schedule.h"
#include "attitude/recordings/recording.h"
#include "attitude/recordings/sensors.h"

namespace photorque {

// The readings at one time. Missing readings are empty or not finite.
struct Reading {
  double time_s = 0.0;
  std::optional<size_t> row;  // row of the recording that gets the estimate
  std::optional<Quat> lab_from_body;
  Vec3 gyro_rad_s = Vec3::Constant(empty_cell);
  double yaw_rad = empty_cell;
  bool begins_anew = false;  // an impact on the platform before this reading

  bool has_gyro() const { return !gyro_rad_s.array().isNaN().all(); }
};

struct Readings {
  std::string name;
  std::vector<Reading> all;  // sorted by time
  size_t rows = 0;
  Schedule schedule;
  // Lab axes about which the attitude was measured.
  std::array<bool, 3> sees_axis = {false, false, false};
  bool has_gyro = false, has_yaw = false;
  double first_s = 0.0, last_s = 0.0;
  double longest_gap_s = 0.0;       // between attitude readings
  std::vector<std::string> unused;  // columns that the filter does not use
  bool sees_attitude() const { return sees_axis[0] || sees_axis[1] || sees_axis[2]; }
};

// Converts a recording. The times of attitudes are `camera_delay_s` earlier than their rows. The
// channels are those of MotionColumns, and yaw_rad of an encoder. InputError if there is neither an
// attitude nor a rate, or only one row.
Readings readings_of(const Recording& recording, const std::string& name, const Platform& platform,
                     double camera_delay_s);

}  // namespace photorque
