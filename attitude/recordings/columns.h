// The contents of a recording of motion: sequences of angles, channels, and columns.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "attitude/model/platform.h"
#include "attitude/recordings/recording.h"
#include "core/transform.h"

namespace photorque {

// Sequences of roll, pitch and yaw, the rotations about body x, y and z. The letters are the axes
// of the successive rotations, each in the rotated frame. The usual one is "zyx": yaw, then pitch,
// then roll, q = Rz(yaw) Ry(pitch) Rx(roll). It is equivalent to rotations about fixed axes in the
// reverse order.
inline constexpr std::array<std::string_view, 6> angle_sequences = {"zyx", "xyz", "xzy",
                                                                    "yxz", "yzx", "zxy"};

// `roll_pitch_yaw`: the rotations about x, y and z [rad] for each sequence.
Quat attitude_of_angles(std::string_view sequence, const Vec3& roll_pitch_yaw);

// Roll, pitch and yaw [rad] of an attitude. The angle of the middle rotation is in [−π/2, π/2]; at
// ±π/2 that of the last rotation is zero. Formulas: with R = R_i(a) R_j(b) R_k(c) and ε the sign of
// the permutation ijk, R_ik = ε sin b, R_jk = −ε sin a cos b, R_kk = cos a cos b, R_ij = −ε cos b
// sin c, R_ii = cos b cos c.
Vec3 angles_of_attitude(std::string_view sequence, const Quat& lab_from_body);

// The formula of a sequence, "q = Rz(yaw) Ry(pitch) Rx(roll)".
std::string formula_of(std::string_view sequence);

// Channels in which recordings and models are compared.
//
// Channels 0 to 2 are the attitude about lab x, y and z, channels 3 to 5 the gyro about body x, y
// and z. The channels after them are scalars, for recordings with less than an attitude or three
// rates. A scalar is a function of attitude and rate.

inline constexpr int vector_channels = 6;

enum class Scalar {
  rate_magnitude,  // |ω| [rad/s]
  tilt,            // angle between body z and lab z, in [0, π]
  roll,            // roll, pitch and yaw of "zyx" (angle_sequences)
  pitch,
  yaw,              // as yaw_rad()
  accelerometer_x,  // specific force [m/s²] and magnetic field [T], body axes
  accelerometer_y,
  accelerometer_z,
  magnetometer_x,
  magnetometer_y,
  magnetometer_z,
  position_x,  // of a platform that slides [m, m/s], lab axes
  position_y,
  velocity_x,
  velocity_y,
};
inline constexpr int scalar_count = 15;
// Scalars from here on depend on more than attitude and rate (Dynamics::Instants).
inline constexpr int first_field = static_cast<int>(Scalar::accelerometer_x);
// Scalars from here on are position and velocity, the four extra states of a translation.
inline constexpr int first_place = static_cast<int>(Scalar::position_x);
inline constexpr int channel_count = vector_channels + scalar_count;

enum class Measures { angle, rate, force, field, length, speed };

struct ChannelTraits {
  const char* name;   // in diagnosis.json, with unit
  const char* label;  // as printed
  const char* name_in_text;
  const char* unit;
  double per_SI;  // this unit per rad, rad/s, m/s² or T
  Measures measures;
  const char* column = "";  // column of a scalar in a recording, SI
  bool turns = false;       // an angle with a period of a whole turn
};
const ChannelTraits& channel_traits(int channel);

// Reading of a scalar that is an angle or a rate, from the attitude and rates that the instruments
// measure. Also its derivatives with respect to a small rotation about lab axes and to the rates
// (body axes).
struct ScalarReading {
  double value = 0.0;
  Vec3 by_rotation_lab = Vec3::Zero(), by_rate = Vec3::Zero();
};
ScalarReading scalar_reading(Scalar scalar, const Quat& lab_from_body, const Vec3& rate_body_rad_s);

// Difference of two readings of a scalar; for angles with a period, in ±π.
double scalar_difference(Scalar scalar, double measured, double predicted);

// The contents of a recording's columns:
//
//   attitude: q_w, q_x, q_y, q_z; or roll_rad, pitch_rad, yaw_rad in the sequence that the
//     recording states (angle_sequences), by default "zyx"; for a platform with one axis one of
//     angle_rad, roll_rad, pitch_rad, yaw_rad, which may exceed whole turns;
//   rates: any of gyro_x_rad_s, gyro_y_rad_s, gyro_z_rad_s; for one axis also rate_rad_s;
//   without an attitude: any of tilt_rad, roll_rad, pitch_rad, yaw_rad; with less than three
//     rates: rate_magnitude_rad_s, or a rate_rad_s that is never negative;
//   of a platform that slides: any of x_m, y_m, velocity_x_m_s, velocity_y_m_s;
//   accelerometer and magnetometer: accel_x_m_s2 …, mag_x_T …;
//   inputs: commands, currents, wheel speeds (Recording::schedule());
//   events: thruster, impulse or event, not zero at an impact on the platform. The readings of
//     such a row are left out, and the motion restarts after it.

class MotionColumns {
 public:
  // Recording and platform must outlive this object. InputError, with `name`, if there is neither
  // an attitude nor a rate.
  MotionColumns(const Recording& recording, const Platform& platform, const std::string& name);

  // Lab axes about which the attitude was measured; none: there is no attitude.
  const std::array<bool, 3>& sees_axis() const { return sees_axis_; }
  bool has_attitude() const { return sees_axis_[0] || sees_axis_[1] || sees_axis_[2]; }
  bool has_gyro() const { return gyro_[0] || gyro_[1] || gyro_[2]; }

  // Whether the attitude consists of three angles, which depend on their sequence.
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

  // Columns that are not used.
  std::vector<std::string> unused() const;

 private:
  const Channel* take(const std::string& name);
  void take_scalars();
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
