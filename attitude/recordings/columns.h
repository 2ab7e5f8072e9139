// The contents of a recording of motion: angles in one of six sequences, channels, columns.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "attitude/model/platform.h"
#include "attitude/recordings/recording.h"
#include "core/transform.h"

namespace photorque {

// Roll, pitch and yaw are three turns about body x, y and z.
// The axes in the order of the turns about axes that move with the body: "zyx" is yaw, then pitch,
// then roll, q = Rz(yaw) Ry(pitch) Rx(roll), which is the usual one; the same as turns about fixed
// axes in the reverse order.
inline constexpr std::array<std::string_view, 6> angle_sequences = {"zyx", "xyz", "xzy",
                                                                    "yxz", "yzx", "zxy"};

// `roll_pitch_yaw`: the turns about x, y and z [rad], whatever their sequence (one of the six).
Quat attitude_of_angles(std::string_view sequence, const Vec3& roll_pitch_yaw);

// The reverse, the middle turn in [−π/2, π/2]; where that is a right angle, the last one is zero.
// Source: with R = R_i(a) R_j(b) R_k(c) and ε the sign of the permutation ijk,
// R_ik = ε sin b, R_jk = −ε sin a cos b, R_kk = cos a cos b, R_ij = −ε cos b sin c,
// R_ii = cos b cos c.
Vec3 angles_of_attitude(std::string_view sequence, const Quat& lab_from_body);

// "q = Rz(yaw) Ry(pitch) Rx(roll)".
std::string formula_of(std::string_view sequence);

// The readings of a motion: the channels in which recordings and models are compared.
//
// Channels 0 to 2 are the attitude about lab x, y and z, 3 to 5 the gyro about body x, y and z.
// The channels after them are scalars, for recordings with less than an attitude or three
// rates: each has a function that computes its reading from an attitude and a rate.

inline constexpr int vector_channels = 6;

enum class Scalar {
  rate_magnitude,  // |ω| [rad/s]
  tilt,            // angle between body z and lab z, in [0, π]
  roll,            // the three of "zyx" (angle_sequences)
  pitch,
  yaw,              // that of yaw_rad()
  accelerometer_x,  // specific force [m/s²] and magnetic field [T], body axes
  accelerometer_y,
  accelerometer_z,
  magnetometer_x,
  magnetometer_y,
  magnetometer_z,
  position_x,  // of a platform that slides [m], [m/s], lab axes
  position_y,
  velocity_x,
  velocity_y,
};
inline constexpr int scalar_count = 15;
// From here on what a model reads is not of attitude and rate alone (Dynamics::Instants).
inline constexpr int first_field = static_cast<int>(Scalar::accelerometer_x);
// And from here on it is of place and velocity, the four extra states of a translation.
inline constexpr int first_place = static_cast<int>(Scalar::position_x);
inline constexpr int channel_count = vector_channels + scalar_count;

enum class Measures { angle, rate, force, field, length, speed };

struct ChannelTraits {
  const char* name;   // in diagnosis.json, with its unit
  const char* label;  // as printed
  const char* name_in_text;
  const char* unit;
  double per_SI;  // of that unit in rad, rad/s, m/s², T
  Measures measures;
  const char* column = "";  // of a scalar: in a recording, SI
  bool turns = false;       // an angle that comes again after a whole turn
};
const ChannelTraits& channel_traits(int channel);

// A scalar that is an angle or a rate, of an attitude and of rates as the instruments see them,
// with its slopes by a small rotation about lab axes and by the rates (body axes).
struct ScalarReading {
  double value = 0.0;
  Vec3 by_rotation_lab = Vec3::Zero(), by_rate = Vec3::Zero();
};
ScalarReading scalar_reading(Scalar scalar, const Quat& lab_from_body, const Vec3& rate_body_rad_s);

// A difference of two readings of a scalar; of angles within half a turn.
double scalar_difference(Scalar scalar, double measured, double predicted);

// The meaning of the columns of a recording for a machine.
//
//   attitude: q_w, q_x, q_y, q_z; or roll_rad, pitch_rad, yaw_rad in the sequence that the
//     recording states (angle_sequences), "zyx" where it states none; of a platform that turns
//     about one axis one of angle_rad, roll_rad, pitch_rad, yaw_rad, which may pass whole turns;
//   rates: gyro_x_rad_s, gyro_y_rad_s, gyro_z_rad_s, any of them; about one axis also rate_rad_s;
//   where there is no attitude: any of tilt_rad, roll_rad, pitch_rad, yaw_rad; where there
//     are not three rates: rate_magnitude_rad_s, or a rate_rad_s that is never negative;
//   of a platform that slides: x_m, y_m, velocity_x_m_s, velocity_y_m_s, any of them;
//   accelerometer and magnetometer: accel_x_m_s2 …, mag_x_T …;
//   what was done: commands, currents, wheel speeds (Recording::schedule());
//   events: thruster, impulse or event, not zero where something hit the platform: the readings of
//   that row are left out, and the motion restarts after it.

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

  // The first column with information on the motion.
  std::string first_name() const;

  // Readings of a row; not finite if it has none.
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
