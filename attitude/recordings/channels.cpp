#include "attitude/recordings/channels.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"

namespace photorque {

namespace {

Eigen::Index axis_at(std::string_view sequence, size_t place) {
  return sequence[place] - 'x';
}

}  // namespace

Quat attitude_of_angles(std::string_view sequence, const Vec3& roll_pitch_yaw) {
  Quat q = Quat::Identity();
  for (size_t place = 0; place < 3; ++place) {
    const Eigen::Index axis = axis_at(sequence, place);
    q = q * Quat(Eigen::AngleAxisd(roll_pitch_yaw[axis], Vec3::Unit(axis)));
  }
  return q;
}

Vec3 angles_of_attitude(std::string_view sequence, const Quat& lab_from_body) {
  const Eigen::Index i = axis_at(sequence, 0), j = axis_at(sequence, 1), k = axis_at(sequence, 2);
  const double sign = (j - i + 3) % 3 == 1 ? 1.0 : -1.0;
  const Mat3 r = lab_from_body.toRotationMatrix();
  const double sine = std::clamp(sign * r(i, k), -1.0, 1.0);
  Vec3 angles;
  angles[j] = std::asin(sine);
  constexpr double upright = 1.0 - 1e-12;
  if (std::abs(sine) < upright) {
    angles[i] = std::atan2(-sign * r(j, k), r(k, k));
    angles[k] = std::atan2(-sign * r(i, j), r(i, i));
  } else {
    angles[i] = std::atan2(sign * r(k, j), r(j, j));
    angles[k] = 0.0;
  }
  return angles;
}

std::string formula_of(std::string_view sequence) {
  constexpr std::string_view names[] = {"roll", "pitch", "yaw"};
  std::string text = "q =";
  for (size_t place = 0; place < 3; ++place) {
    text += std::string(" R") + sequence[place] + "(" +
            std::string(names[static_cast<size_t>(axis_at(sequence, place))]) + ")";
  }
  return text;
}

namespace {

constexpr double per_arcsec = 1.0 / arcsecond_rad;

constexpr std::array<ChannelTraits, channel_count> all_traits = {{
    {"attitude_x_arcsec", "Attitude about lab x", "the camera about lab x", "arcsec", per_arcsec,
     Measures::angle},
    {"attitude_y_arcsec", "Attitude about lab y", "the camera about lab y", "arcsec", per_arcsec,
     Measures::angle},
    {"attitude_z_arcsec", "Attitude about lab z", "the camera about lab z", "arcsec", per_arcsec,
     Measures::angle},
    {"gyro_x_rad_s", "Rate about body x", "the gyro about body x", "rad/s", 1.0, Measures::rate},
    {"gyro_y_rad_s", "Rate about body y", "the gyro about body y", "rad/s", 1.0, Measures::rate},
    {"gyro_z_rad_s", "Rate about body z", "the gyro about body z", "rad/s", 1.0, Measures::rate},
    {"rate_magnitude_rad_s", "Magnitude of the rate", "the rate's magnitude", "rad/s", 1.0,
     Measures::rate, "rate_magnitude_rad_s"},
    {"tilt_arcsec", "Tilt", "the tilt", "arcsec", per_arcsec, Measures::angle, "tilt_rad", false},
    {"heading_arcsec", "Heading", "the heading", "arcsec", per_arcsec, Measures::angle,
     "heading_rad", true},
    {"roll_arcsec", "Roll", "the roll", "arcsec", per_arcsec, Measures::angle, "roll_rad", true},
    {"pitch_arcsec", "Pitch", "the pitch", "arcsec", per_arcsec, Measures::angle, "pitch_rad",
     true},
    {"yaw_arcsec", "Yaw", "the yaw", "arcsec", per_arcsec, Measures::angle, "yaw_rad", true},
    {"accel_x_m_s2", "Accelerometer x", "the accelerometer along body x", "m/s²", 1.0,
     Measures::force, "accel_x_m_s2"},
    {"accel_y_m_s2", "Accelerometer y", "the accelerometer along body y", "m/s²", 1.0,
     Measures::force, "accel_y_m_s2"},
    {"accel_z_m_s2", "Accelerometer z", "the accelerometer along body z", "m/s²", 1.0,
     Measures::force, "accel_z_m_s2"},
    {"mag_x_T", "Magnetometer x", "the magnetometer along body x", "T", 1.0, Measures::field,
     "mag_x_T"},
    {"mag_y_T", "Magnetometer y", "the magnetometer along body y", "T", 1.0, Measures::field,
     "mag_y_T"},
    {"mag_z_T", "Magnetometer z", "the magnetometer along body z", "T", 1.0, Measures::field,
     "mag_z_T"},
    {"position_x_m", "Position along lab x", "the position along lab x", "m", 1.0, Measures::length,
     "x_m"},
    {"position_y_m", "Position along lab y", "the position along lab y", "m", 1.0, Measures::length,
     "y_m"},
    {"velocity_x_m_s", "Velocity along lab x", "the velocity along lab x", "m/s", 1.0,
     Measures::speed, "velocity_x_m_s"},
    {"velocity_y_m_s", "Velocity along lab y", "the velocity along lab y", "m/s", 1.0,
     Measures::speed, "velocity_y_m_s"},
}};

Quat turned(const Vec3& rotation_lab, const Quat& q) {
  const double angle = rotation_lab.norm();
  return angle > 0.0 ? Quat(Eigen::AngleAxisd(angle, rotation_lab / angle)) * q : q;
}

double of_attitude(Scalar scalar, const Quat& q) {
  switch (scalar) {
    case Scalar::tilt:
      // sin(tilt/2)² = x² + y²: exact near zero, where the cosine of the tilt is blind.
      return 2.0 * std::atan2(std::hypot(q.x(), q.y()), std::hypot(q.w(), q.z()));
    case Scalar::heading: {
      const Vec3 body_x_lab = q * Vec3::UnitX();
      return std::atan2(body_x_lab.y(), body_x_lab.x());
    }
    case Scalar::roll:
      return angles_of_attitude("zyx", q)[0];
    case Scalar::pitch:
      return angles_of_attitude("zyx", q)[1];
    case Scalar::yaw:
      return angles_of_attitude("zyx", q)[2];
    default:
      break;
  }
  return 0.0;
}

}  // namespace

const ChannelTraits& channel_traits(int channel) {
  return all_traits[static_cast<size_t>(channel)];
}

double scalar_difference(Scalar scalar, double measured, double predicted) {
  const double apart = measured - predicted;
  const bool turns = channel_traits(vector_channels + static_cast<int>(scalar)).turns;
  return turns ? std::remainder(apart, 2.0 * pi) : apart;
}

ScalarReading scalar_reading(Scalar scalar, const Quat& lab_from_body,
                             const Vec3& rate_body_rad_s) {
  ScalarReading reading;
  if (scalar == Scalar::rate_magnitude) {
    reading.value = rate_body_rad_s.norm();
    if (reading.value > 0.0) reading.by_rate = rate_body_rad_s / reading.value;
    return reading;
  }
  reading.value = of_attitude(scalar, lab_from_body);
  constexpr double step_rad = 1e-5;  // central: good to 1e-10
  for (int k = 0; k < 3; ++k) {
    const double after = of_attitude(scalar, turned(step_rad * Vec3::Unit(k), lab_from_body)),
                 before = of_attitude(scalar, turned(-step_rad * Vec3::Unit(k), lab_from_body));
    reading.by_rotation_lab[k] = scalar_difference(scalar, after, before) / (2.0 * step_rad);
  }
  return reading;
}

}  // namespace photorque
