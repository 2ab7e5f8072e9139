#include "attitude/readings/angle_sequence.h"

#include <algorithm>
#include <cmath>

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

}  // namespace photorque
