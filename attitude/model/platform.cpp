#include "attitude/model/platform.h"

#include <Eigen/Eigenvalues>
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

Platform read_platform(const Settings& settings) {
  Platform platform;
  platform.topology = static_cast<Topology>(
      settings.choice("topology", {"dumbbell", "tabletop", "hollow", "free"}));
  platform.mass_kg = settings.number("mass_kg", Range::positive());
  platform.inertia_kg_m2 = settings.matrix3("inertia_kg_m2");
  check_inertia(platform.inertia_kg_m2, settings.raw("inertia_kg_m2").where,
                settings.name() + ".inertia_kg_m2");
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

}  // namespace photorque
