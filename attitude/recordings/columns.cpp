#include "attitude/recordings/columns.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/errors.h"

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

double of_attitude(Scalar scalar, const Quat& q) {
  if (scalar < Scalar::tilt || scalar > Scalar::yaw) return 0.0;
  // sin(tilt/2)² = x² + y²: accurate near zero, where the cosine of the tilt is not.
  if (scalar == Scalar::tilt) {
    return 2.0 * std::atan2(std::hypot(q.x(), q.y()), std::hypot(q.w(), q.z()));
  }
  return angles_of_attitude("zyx", q)[static_cast<int>(scalar) - static_cast<int>(Scalar::roll)];
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
  constexpr double step_rad = 1e-5;  // central differences, accurate to 1e-10
  for (int k = 0; k < 3; ++k) {
    const double after = of_attitude(scalar, turn_by(step_rad * Vec3::Unit(k)) * lab_from_body),
                 before = of_attitude(scalar, turn_by(-step_rad * Vec3::Unit(k)) * lab_from_body);
    reading.by_rotation_lab[k] = scalar_difference(scalar, after, before) / (2.0 * step_rad);
  }
  return reading;
}

namespace {

constexpr const char* euler_names[] = {"roll_rad", "pitch_rad", "yaw_rad"};
constexpr const char* angle_names[] = {"angle_rad", "roll_rad", "pitch_rad", "yaw_rad"};
// Index of the axis: 0, 1 or 2 for x, y or z.
size_t index_of(const Vec3& axis) {
  Eigen::Index k = 0;
  axis.cwiseAbs().maxCoeff(&k);
  return static_cast<size_t>(k);
}

double cell(const Channel* channel, size_t row) {
  return channel == nullptr ? empty_cell : channel->values[row];
}

// The names of the columns as text, with a hint if one of them lacks only its unit.
std::string columns_in_words(const Recording& recording) {
  constexpr size_t most = 6;
  std::string names, bare;
  for (size_t i = 0; i < std::min(most, recording.channels.size()); ++i) {
    const std::string& name = recording.channels[i].name;
    names += (i > 0 ? ", " : "") + name;
    const auto lacks_unit = [&name](const char* known) { return unit_of_key(known).stem == name; };
    if (bare.empty() && (std::ranges::any_of(angle_names, lacks_unit) ||
                         std::ranges::any_of(gyro_names, lacks_unit) || lacks_unit("rate_rad_s") ||
                         lacks_unit("tilt_rad") || lacks_unit("rate_magnitude_rad_s"))) {
      bare = name;
    }
  }
  if (recording.channels.size() > most) names += ", …";
  if (names.empty()) return "no column except t_s";
  const bool is_rate = bare.starts_with("gyro") || bare.starts_with("rate");
  const std::string unit = is_rate ? "_deg_s or " : "_deg or ", SI = is_rate ? "_rad_s" : "_rad";
  return "the columns " + names +
         (bare.empty() ? "" : "; " + bare + " has no unit: " + bare + unit + bare + SI);
}

}  // namespace

const Channel* MotionColumns::take(const std::string& name) {
  const Channel* channel = recording_.find(name);
  if (channel != nullptr) used_.push_back(channel);
  return channel;
}

MotionColumns::MotionColumns(const Recording& recording, const Platform& platform,
                             const std::string& name)
    : recording_(recording), platform_(platform) {
  for (const char* known : schedule_channels) take(known);
  for (const char* known : event_channels) {
    if (event_ == nullptr) event_ = take(known);
  }
  const bool one_axis = platform.turns_about_one_axis();
  for (size_t k = 0; k < 3; ++k) {
    // For a platform with one axis, the other two axes do not measure the motion.
    if (!one_axis || k == index_of(platform.axis)) gyro_[k] = take(gyro_names[k]);
  }
  const auto has = [&](const char* channel) { return recording.find(channel) != nullptr; };
  if (std::ranges::any_of(quaternion_names, has)) {
    for (size_t k = 0; k < 4; ++k) {
      q_[k] = take(quaternion_names[k]);
      if (q_[k] == nullptr) {
        throw InputError({name, 0}, "header", std::string("no channel ") + quaternion_names[k],
                         "the attitude q_w, q_x, q_y, q_z");
      }
    }
    sees_axis_ = {true, true, true};
  } else if (one_axis) {
    const size_t axis = index_of(platform.axis);
    if (gyro_[axis] == nullptr) gyro_[axis] = take("rate_rad_s");
    for (const char* known : angle_names) {
      if (angle_ == nullptr) angle_ = take(known);
    }
    if (angle_ != nullptr) sees_axis_[axis] = true;
  } else if (std::ranges::all_of(euler_names, has)) {
    for (size_t k = 0; k < 3; ++k) euler_[k] = take(euler_names[k]);
    sees_axis_ = {true, true, true};
  }
  if (!one_axis) take_scalars();
  if (platform.slides()) {
    for (int s = first_place; s < scalar_count; ++s) {
      scalars_[static_cast<size_t>(s)] = take(channel_traits(vector_channels + s).column);
    }
    if (has_scalars()) return;
    throw InputError({name, 0}, "header", "no channel of a position or a velocity",
                     "x_m, y_m, velocity_x_m_s or velocity_y_m_s, or a table [recording.columns] "
                     "that names one");
  }
  if (has_attitude() || has_gyro() || has_scalars()) return;
  throw InputError(
      {name, 0}, "header", "neither an angle nor a rate (" + columns_in_words(recording) + ")",
      one_axis ? "angle_rad, rate_rad_s, a gyro axis, or a table [recording.columns] that "
                 "names one (photorque diagnose --guess writes it)"
               : "q_w, q_x, q_y, q_z or roll_rad, pitch_rad, yaw_rad; gyro_x_rad_s …; "
                 "tilt_rad, rate_magnitude_rad_s; or [recording.columns], which photorque "
                 "diagnose --guess writes");
}

// Takes scalars. Those that a complete attitude or three rates already contain are left out.
void MotionColumns::take_scalars() {
  const auto put = [&](Scalar scalar, const char* column) {
    const Channel*& place = scalars_[static_cast<size_t>(scalar)];
    if (place == nullptr) place = take(column);
  };
  if (!(gyro_[0] != nullptr && gyro_[1] != nullptr && gyro_[2] != nullptr)) {
    put(Scalar::rate_magnitude, "rate_magnitude_rad_s");
    const Channel* rate = recording_.find("rate_rad_s");
    const bool is_magnitude =
        rate != nullptr && std::ranges::none_of(rate->values, [](double x) { return x < 0.0; });
    if (is_magnitude) put(Scalar::rate_magnitude, "rate_rad_s");
  }
  for (int s = first_field; s < first_place; ++s) {
    put(static_cast<Scalar>(s), channel_traits(vector_channels + s).column);
  }
  if (has_attitude()) return;
  for (const Scalar angle : {Scalar::tilt, Scalar::roll, Scalar::pitch, Scalar::yaw}) {
    put(angle, channel_traits(vector_channels + static_cast<int>(angle)).column);
  }
}

bool MotionColumns::has_scalars() const {
  return std::ranges::any_of(scalars_, [](const Channel* channel) { return channel != nullptr; });
}

std::string MotionColumns::first_name() const {
  for (const Channel* channel : {q_[0], angle_, euler_[0], gyro_[0], gyro_[1], gyro_[2]}) {
    if (channel != nullptr) return channel->name;
  }
  for (const Channel* channel : scalars_) {
    if (channel != nullptr) return channel->name;
  }
  return "";
}

Quat MotionColumns::attitude(size_t row) const {
  if (angle_ != nullptr) {
    return Quat(Eigen::AngleAxisd(cell(angle_, row), platform_.axis));
  }
  if (euler_[0] != nullptr) {
    return attitude_of_angles(
        recording_.angle_sequence.empty() ? angle_sequences[0] : recording_.angle_sequence,
        angles_rad(row));
  }
  return Quat(cell(q_[0], row), cell(q_[1], row), cell(q_[2], row), cell(q_[3], row)).normalized();
}

double MotionColumns::rate_rad_s(size_t axis, size_t row) const {
  return cell(gyro_[axis], row);
}

Vec3 MotionColumns::angles_rad(size_t row) const {
  return {cell(euler_[0], row), cell(euler_[1], row), cell(euler_[2], row)};
}

double MotionColumns::scalar(Scalar scalar, size_t row) const {
  return cell(scalar_at(scalar), row);
}

bool MotionColumns::has_event(size_t row) const {
  const double value = cell(event_, row);
  return std::isfinite(value) && value != 0.0;
}

std::vector<std::string> MotionColumns::unused() const {
  std::vector<std::string> names;
  for (const Channel& channel : recording_.channels) {
    if (std::ranges::find(used_, &channel) == used_.end()) names.push_back(channel.name);
  }
  return names;
}

}  // namespace photorque
