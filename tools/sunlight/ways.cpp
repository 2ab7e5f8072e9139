#include "tools/sunlight/ways.h"

#include <cmath>

namespace photorque {

RigidTransform SunLight::lab_from_body(const Vec3& towards_body) const {
  return {Quat::FromTwoVectors(towards_body, towards_lab), Vec3::Zero()};
}

std::vector<RigidTransform> fresh_directions(size_t count, const SunLight& sun) {
  constexpr double golden_rad = 2.39996322972865332;
  std::vector<RigidTransform> attitudes;
  for (size_t i = 0; i < count; ++i) {
    const double height = 1.0 - 2.0 * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const TableAngles angles{std::asin(height), golden_rad * (static_cast<double>(i) + 0.3)};
    attitudes.push_back(sun.lab_from_body(towards_light(angles)));
  }
  return attitudes;
}

double largest_torque_N_m(const WrenchTable& table) {
  double largest_N_m = 0.0;
  for (const Vec3& torque : table.torque_body_N_m)
    largest_N_m = std::max(largest_N_m, torque.norm());
  return largest_N_m;
}

}  // namespace photorque
