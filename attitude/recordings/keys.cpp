#include "attitude/recordings/keys.h"

#include "attitude/camera/keys.h"
#include "attitude/recordings/sensors.h"

namespace photorque {
namespace {

// The errors that stand with an instrument as well as in [[disturbance]].
std::vector<Key> errors_of(const std::string& instrument) {
  std::vector<Key> keys;
  for (const DisturbanceKind& kind : disturbance_kinds()) {
    if (kind.instrument != instrument) continue;
    for (const Key& key : kind.keys) keys.push_back(Key(key).usually_is("0"));
  }
  return keys;
}

Key rate_key() {
  return Key::number_or("rate_Hz", 0.0, Range::not_negative(), "of readings; 0: every row");
}

}  // namespace

std::vector<Key> sensor_keys() {
  const Sensors::Camera camera;
  const auto not_negative = [](const char* name, const char* what) {
    return Key::number_or(name, 0.0, Range::not_negative(), what);
  };
  return {
      Key::table("camera",
                 joined({{Key::vector3_or("noise_arcsec", camera.noise_rad,
                                          "standard deviation about lab x, y, z"),
                          rate_key()},
                         errors_of("camera"),
                         tracking_camera_keys()}),
                 "sees the attitude")
          .usually_is("without any `[sensors]` an ideal one"),
      Key::table("angle", {Key::number("noise_arcsec", Range::positive(), "standard deviation")},
                 "the angle of a one-axis platform, instead of a camera"),
      Key::table(
          "gyro",
          joined({{not_negative("noise_rad_s", "per reading and axis"),
                   not_negative("bias_drift", "random walk of the bias, rad/s per √s"), rate_key()},
                  errors_of("gyro")}),
          "feels the rate")
          .usually_is("without any `[sensors]` an ideal one"),
      Key::table(
          "accelerometer",
          {not_negative("noise_m_s2", "per reading and axis; 0: found in the readings"),
           Key::vector3_or("position_m", Vec3::Zero(),
                           "from the centre of rotation (of mass, where nothing carries it)"),
           Key::vector3_or("bias_m_s2", Vec3::Zero(), "what it reads too much")},
          "feels the specific force; for `diagnose`"),
      Key::table("magnetometer",
                 {not_negative("noise_T", "per reading and axis; 0: found in the readings"),
                  Key::vector3_or("bias_T", Vec3::Zero(), "the platform's own field, body axes")},
                 "feels the environment's magnetic field; for `diagnose`"),
      Key::table("position",
                 {not_negative("noise_m", "per reading and axis; 0: found in the readings"),
                  not_negative("noise_m_s", "the same of a velocity; 0: none is recorded")},
                 "sees where a planar platform is"),
      Key::table("encoder",
                 {Key::number("resolution_arcsec", Range::positive(), "step of the heading")},
                 "reads the heading"),
      Key::table("power",
                 {not_negative("current_noise_A", "on the battery's current"),
                  not_negative("power_noise_W", "on the array's power")},
                 "reads battery and array"),
      Key::choice_or("noise_is",
                     {{"found",
                       "`diagnose` looks for level and correlation of the noise in the "
                       "recordings"},
                      {"stated", "it takes them as stated here"}},
                     0, "where the noise is known from")};
}

Key recording_table() {
  const RecordingOptions usual;
  return Key::table(
      "recording",
      {Key::other("columns", Key::a_table,
                  "`{ gyro_x_rad_s = \"wx\", … }`: the file's name of a channel. A unit in the "
                  "channel's key converts: `gyro_x_deg_s = \"wx\"`")
           .usually_is("names as they are"),
       Key::choice_or("angle_sequence",
                      {{"found",
                        "the one with which the rates integrate to the angles; `zyx` "
                        "where there are no rates"},
                       {"zyx", "q = Rz(yaw) Ry(pitch) Rx(roll)"},
                       {"xyz", "q = Rx(roll) Ry(pitch) Rz(yaw)"},
                       {"xzy", "q = Rx(roll) Rz(yaw) Ry(pitch)"},
                       {"yxz", "q = Ry(pitch) Rx(roll) Rz(yaw)"},
                       {"yzx", "q = Ry(pitch) Rz(yaw) Rx(roll)"},
                       {"zxy", "q = Rz(yaw) Rx(roll) Ry(pitch)"}},
                      0, "in which roll, pitch and yaw are turned, about axes that turn along"),
       Key::flag_or("remove_outliers", usual.remove_outliers,
                    "empties cells of attitude and gyro far from all neighbours")},
      "how files of recordings are read");
}

}  // namespace photorque
