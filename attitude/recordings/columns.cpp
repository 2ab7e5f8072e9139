#include "attitude/recordings/columns.h"

#include <algorithm>
#include <cmath>

#include "attitude/recordings/channels.h"
#include "core/errors.h"

namespace photorque {

namespace {

constexpr const char* quaternion_names[] = {"q_w", "q_x", "q_y", "q_z"};
constexpr const char* gyro_names[] = {"gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s"};
constexpr const char* euler_names[] = {"roll_rad", "pitch_rad", "yaw_rad"};
constexpr const char* angle_names[] = {"angle_rad", "roll_rad", "pitch_rad", "yaw_rad",
                                       "heading_rad"};
constexpr const char* event_names[] = {"thruster", "impulse", "event"};
// What Recording::schedule() makes use of.
constexpr const char* schedule_names[] = {"command_x_N_m",     "command_y_N_m", "command_z_N_m",
                                          "wheel_x_rad_s",     "wheel_y_rad_s", "wheel_z_rad_s",
                                          "battery_current_A", "led_current_A"};

// 0, 1 or 2: x, y or z.
size_t index_of(const Vec3& axis) {
  Eigen::Index k = 0;
  axis.cwiseAbs().maxCoeff(&k);
  return static_cast<size_t>(k);
}

double cell(const Channel* channel, size_t row) {
  return channel == nullptr ? empty_cell : channel->values[row];
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
  for (const char* known : schedule_names) take(known);
  for (const char* known : event_names) {
    if (event_ == nullptr) event_ = take(known);
  }
  const bool one_axis = platform.turns_about_one_axis();
  for (size_t k = 0; k < 3; ++k) {
    // About one axis alone the other two read nothing of the motion.
    if (!one_axis || k == index_of(platform.axis)) gyro_[k] = take(gyro_names[k]);
  }
  const bool any_q = std::any_of(std::begin(quaternion_names), std::end(quaternion_names),
                                 [&](const char* q) { return recording.find(q) != nullptr; });
  const bool all_euler = std::all_of(std::begin(euler_names), std::end(euler_names),
                                     [&](const char* e) { return recording.find(e) != nullptr; });
  if (any_q) {
    for (size_t k = 0; k < 4; ++k) {
      q_[k] = take(quaternion_names[k]);
      if (q_[k] == nullptr) {
        throw InputError({name, 0}, "header", std::string("no channel ") + quaternion_names[k],
                         "the attitude q_w, q_x, q_y, q_z");
      }
    }
    sees_axis_ = {true, true, true};
  } else if (platform.turns_about_one_axis()) {
    const size_t axis = index_of(platform.axis);
    if (gyro_[axis] == nullptr) gyro_[axis] = take("rate_rad_s");
    for (const char* known : angle_names) {
      if (angle_ == nullptr) angle_ = take(known);
    }
    if (angle_ != nullptr) sees_axis_[axis] = true;
  } else if (all_euler) {
    for (size_t k = 0; k < 3; ++k) euler_[k] = take(euler_names[k]);
    sees_axis_ = {true, true, true};
  }
  if (!platform.turns_about_one_axis()) take_scalars();
  if (platform.slides()) {
    take_places();
    if (has_scalars()) return;
    throw InputError({name, 0}, "header", "no channel of a place or a velocity",
                     "x_m, y_m, velocity_x_m_s or velocity_y_m_s, or [recording.columns] that says "
                     "which column is one");
  }
  if (has_attitude() || has_gyro() || has_scalars()) return;
  throw InputError({name, 0}, "header",
                   platform.turns_about_one_axis() ? "no channel of an angle or a rate"
                                                   : "no channel q_w and no gyro",
                   platform.turns_about_one_axis()
                       ? "angle_rad, rate_rad_s, a gyro axis, or [recording.columns] that says "
                         "which column is one"
                       : "the attitude q_w, q_x, q_y, q_z or roll_rad, pitch_rad, yaw_rad; or "
                         "gyro_x_rad_s, gyro_y_rad_s, gyro_z_rad_s; or any of tilt_rad, "
                         "heading_rad, rate_magnitude_rad_s");
}

// What a whole attitude or three rates tell, one number beside them does not tell again.
void MotionColumns::take_scalars() {
  const auto put = [&](Scalar scalar, const char* column) {
    const Channel*& place = scalars_[static_cast<size_t>(scalar)];
    if (place == nullptr) place = take(column);
  };
  if (!(gyro_[0] != nullptr && gyro_[1] != nullptr && gyro_[2] != nullptr)) {
    put(Scalar::rate_magnitude, "rate_magnitude_rad_s");
    const Channel* rate = recording_.find("rate_rad_s");
    const bool is_magnitude =
        rate != nullptr &&
        std::none_of(rate->values.begin(), rate->values.end(), [](double x) { return x < 0.0; });
    if (is_magnitude) put(Scalar::rate_magnitude, "rate_rad_s");
  }
  for (int s = first_field; s < first_place; ++s) {
    put(static_cast<Scalar>(s), channel_traits(vector_channels + s).column);
  }
  if (has_attitude()) return;
  for (const Scalar angle :
       {Scalar::tilt, Scalar::heading, Scalar::roll, Scalar::pitch, Scalar::yaw}) {
    put(angle, channel_traits(vector_channels + static_cast<int>(angle)).column);
  }
}

void MotionColumns::take_places() {
  for (int s = first_place; s < scalar_count; ++s) {
    scalars_[static_cast<size_t>(s)] = take(channel_traits(vector_channels + s).column);
  }
}

bool MotionColumns::has_scalars() const {
  return std::any_of(scalars_.begin(), scalars_.end(),
                     [](const Channel* channel) { return channel != nullptr; });
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
    if (std::find(used_.begin(), used_.end(), &channel) == used_.end()) {
      names.push_back(channel.name);
    }
  }
  return names;
}

}  // namespace photorque
