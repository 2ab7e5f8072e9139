// [sensors] and [recording], which sensors.cpp and recording.cpp read.
#pragma once

#include <vector>

#include "core/settings/typed_keys.h"

namespace photorque {

namespace recording_key {
inline constexpr OtherKey columns(
    "columns", Key::a_table,
    "`{ gyro_x_rad_s = \"wx\", … }`: the file's name of a channel. A unit in the "
    "channel's key converts: `gyro_x_deg_s = \"wx\"`",
    {.usually = "names as they are"});
inline constexpr ChoiceKey angle_sequence(
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
inline constexpr FlagKey remove_outliers(
    "remove_outliers", true,
    "removes readings of attitude and gyro that are far from all neighbours");
inline constexpr TableKey recording("recording", "how files of recordings are read");
}  // namespace recording_key

// The instruments of the attitude; those of light and power are in diagnosis/light/model.
std::vector<Key> sensor_keys();
Key recording_table();

}  // namespace photorque
