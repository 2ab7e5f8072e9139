// Which columns of a recording say what of the motion, for the machine at hand.
//
//   attitude: q_w, q_x, q_y, q_z; or roll_rad, pitch_rad, yaw_rad in the sequence that the
//     recording states (angle_sequence.h), "zyx" where it states none; of a platform that turns
//     about one axis one of angle_rad, roll_rad, pitch_rad, yaw_rad, heading_rad, which may pass
//     whole turns;
//   rates: gyro_x_rad_s, gyro_y_rad_s, gyro_z_rad_s, any of them; about one axis also rate_rad_s;
//   where there is no attitude: any of tilt_rad, heading_rad, roll_rad, pitch_rad, yaw_rad; where
//     there are not three rates: rate_magnitude_rad_s, or a rate_rad_s that is never negative;
//   of a platform that slides: x_m, y_m, velocity_x_m_s, velocity_y_m_s, any of them;
//   accelerometer and magnetometer: accel_x_m_s2 …, mag_x_T …;
//   what was done: commands, currents, wheel speeds (Recording::schedule());
//   events: thruster, impulse or event, not zero where something hit the platform: what was read in
//     that row is left out, and the motion begins anew after it.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "attitude/model/platform.h"
#include "attitude/recordings/channels.h"
#include "attitude/recordings/recording.h"

namespace photorque {

class MotionColumns {
 public:
  // Both must outlive this. InputError, naming `name`, when there is neither an attitude nor a
  // rate.
  MotionColumns(const Recording& recording, const Platform& platform, const std::string& name);

  // Lab axes about which the attitude is read; none: there is no attitude.
  const std::array<bool, 3>& sees_axis() const { return sees_axis_; }
  bool has_attitude() const { return sees_axis_[0] || sees_axis_[1] || sees_axis_[2]; }
  bool has_gyro() const { return gyro_[0] || gyro_[1] || gyro_[2]; }

  // Whether the attitude is three angles, which depend on their sequence.
  bool has_angles() const { return euler_[0] != nullptr; }
  bool has_scalar(Scalar scalar) const { return scalar_at(scalar) != nullptr; }
  bool has_scalars() const;

  // The first column that says something of the motion.
  std::string first_name() const;

  // Of a row; not finite where it has none.
  Quat attitude(size_t row) const;
  double rate_rad_s(size_t axis, size_t row) const;  // body axes
  Vec3 angles_rad(size_t row) const;                 // roll, pitch, yaw
  double scalar(Scalar scalar, size_t row) const;
  bool has_event(size_t row) const;

  // Columns that nothing is made of.
  std::vector<std::string> unused() const;

 private:
  const Channel* take(const std::string& name);
  void take_scalars();
  void take_places();
  const Channel* scalar_at(Scalar scalar) const { return scalars_[static_cast<size_t>(scalar)]; }

  const Recording& recording_;
  const Platform& platform_;
  std::array<const Channel*, 4> q_{};
  std::array<const Channel*, 3> euler_{};  // roll, pitch, yaw
  std::array<const Channel*, static_cast<size_t>(scalar_count)> scalars_{};
  const Channel* angle_ = nullptr;  // about the platform's axis
  std::array<const Channel*, 3> gyro_{};
  const Channel* event_ = nullptr;
  std::array<bool, 3> sees_axis_{};
  std::vector<const Channel*> used_;
};

}  // namespace photorque
