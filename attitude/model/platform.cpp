#include "attitude/model/platform.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <sstream>

namespace photorque {

void check_inertia(const Mat3& inertia_kg_m2, const InputLocation& where, const std::string& key) {
  const double size = inertia_kg_m2.cwiseAbs().maxCoeff();
  if ((inertia_kg_m2 - inertia_kg_m2.transpose()).cwiseAbs().maxCoeff() > 1e-9 * size) {
    throw InputError(where, key, "a matrix that is not symmetric", "a symmetric matrix");
  }
  const Vec3 principal = Eigen::SelfAdjointEigenSolver<Mat3>(inertia_kg_m2).eigenvalues();
  std::ostringstream found;
  found << "principal moments " << principal[0] << ", " << principal[1] << ", " << principal[2];
  if (!(principal[0] > 0.0)) {
    throw InputError(where, key, found.str(), "three positive principal moments");
  }
  // Rounded tables of thin plates and rods touch the bound; a part in a thousand is theirs.
  if (principal[2] > (principal[0] + principal[1]) * (1.0 + 1e-3)) {
    throw InputError(where, key, found.str(),
                     "moments that obey the triangle inequality: none above the sum of the others");
  }
}

namespace {

constexpr const char* inertia_key = "inertia_kg_m2";

// The table with value and sigma, or the platform's own.
bool has_sigma(const Settings& platform) {
  return platform.has(inertia_key) && platform.raw(inertia_key).is_table();
}

Mat3 read_inertia(const Settings& settings, const Platform& platform) {
  if (!platform.turns_about_one_axis()) {
    return has_sigma(settings) ? settings.table(inertia_key).matrix3("value")
                               : settings.matrix3(inertia_key);
  }
  if (!settings.has(inertia_key)) return Mat3::Identity();
  if (settings.raw(inertia_key).is_array()) return settings.matrix3(inertia_key);
  return settings.uncertain(inertia_key, Range::positive()).value * Mat3::Identity();
}

// Measured moments may break the triangle inequality by their errors.
bool breaks_within_sigma(const Mat3& inertia_kg_m2, const Mat3& sigma_kg_m2) {
  constexpr double most_sigma = 3.0;
  const Vec3 principal = Eigen::SelfAdjointEigenSolver<Mat3>(inertia_kg_m2).eigenvalues();
  const double excess = principal[2] - principal[0] - principal[1];
  return principal[0] > 0.0 && excess > 0.0 && excess < most_sigma * sigma_kg_m2.norm();
}

}  // namespace

Mat3 inertia_sigma_kg_m2(const Settings& platform) {
  if (!has_sigma(platform)) return Mat3::Zero();
  const Settings both = platform.table(inertia_key);
  // Of three moments where products are known to vanish: numbers of the diagonal alone.
  if (!both.raw("sigma").is_array()) {
    return both.number("sigma", Range::not_negative()) * Mat3::Identity();
  }
  return both.matrix3("sigma");
}

Platform read_platform(const Settings& settings) {
  Platform platform;
  platform.topology = static_cast<Topology>(settings.choice(
      "topology", {"dumbbell", "tabletop", "hollow", "free", "one_axis", "planar"}));
  if (platform.topology == Topology::one_axis) {
    const size_t z = 2;
    platform.axis =
        Vec3::Unit(static_cast<Eigen::Index>(settings.choice_or("axis", {"x", "y", "z"}, z)));
  }
  platform.mass_kg = platform.has_air_bearing()
                         ? settings.number("mass_kg", Range::positive())
                         : settings.number_or("mass_kg", 1.0, Range::positive());
  platform.inertia_kg_m2 = read_inertia(settings, platform);
  if (settings.has(inertia_key) &&
      !breaks_within_sigma(platform.inertia_kg_m2, inertia_sigma_kg_m2(settings))) {
    check_inertia(platform.inertia_kg_m2, settings.raw(inertia_key).where,
                  settings.name() + "." + inertia_key);
  }
  platform.inertia_kg_m2 =
      0.5 * (platform.inertia_kg_m2 + platform.inertia_kg_m2.transpose()).eval();
  if (settings.has("tilt_limit_deg")) {
    platform.tilt_limit_rad = settings.number("tilt_limit_deg", {0.0, pi, true, false});
  }
  if (settings.has("battery_capacity_Ah")) {
    platform.battery_capacity_C = settings.number("battery_capacity_Ah", Range::positive());
  }
  platform.battery_voltage_V =
      settings.number_or("battery_voltage_V", platform.battery_voltage_V, Range::positive());
  return platform;
}

double tilt_rad(const PlatformState& state) {
  // sin(tilt/2)² = x² + y²: exact near zero, where the cosine of the tilt is blind.
  const Quat& q = state.lab_from_body;
  return 2.0 * std::atan2(std::hypot(q.x(), q.y()), std::hypot(q.w(), q.z()));
}

double heading_rad(const PlatformState& state) {
  const Vec3 body_x_lab = state.lab_from_body * Vec3::UnitX();
  return std::atan2(body_x_lab.y(), body_x_lab.x());
}

}  // namespace photorque
