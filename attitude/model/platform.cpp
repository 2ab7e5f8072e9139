#include "attitude/model/platform.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "core/text/format.h"

namespace photorque {

void check_inertia(const Mat3& inertia_kg_m2, const InputLocation& where, const std::string& key) {
  const double size = inertia_kg_m2.cwiseAbs().maxCoeff();
  if ((inertia_kg_m2 - inertia_kg_m2.transpose()).cwiseAbs().maxCoeff() > 1e-9 * size) {
    throw InputError(where, key, "a matrix that is not symmetric", "a symmetric matrix");
  }
  const Vec3 principal = Eigen::SelfAdjointEigenSolver<Mat3>(inertia_kg_m2).eigenvalues();
  const std::string found =
      printed("principal moments %g, %g, %g", principal[0], principal[1], principal[2]);
  if (!(principal[0] > 0.0)) {
    throw InputError(where, key, found, "three positive principal moments");
  }
  // Rounded tables of thin plates and rods are near the bound: an excess of 0.1 % is accepted.
  if (principal[2] > (principal[0] + principal[1]) * (1.0 + 1e-3)) {
    throw InputError(where, key, found, "moments none of which exceeds the sum of the other two");
  }
}

namespace {

namespace platform_key {
constexpr UncertainNumberKey mass("mass_kg", Range::positive(), "mass of all rotating parts");
constexpr OtherKey inertia("inertia_kg_m2", Key::an_array | Key::a_table,
                           "3 × 3, symmetric, positive, body axes, about the centre of rotation");
// For platforms with one axis of rotation.
constexpr OtherKey inertia_about(inertia.name, Key::a_number | Key::an_array | Key::a_table,
                                 "moment of inertia about the axis of rotation, or a 3 × 3 matrix",
                                 {.usually = "1"});
constexpr ChoiceKey topology(
    "topology",
    {{"dumbbell", "two arms on an air bearing"},
     {"tabletop", "a plate on an air bearing"},
     {"hollow", "a ball around its payload"},
     {"free", "a body without bearing, such as a spacecraft"},
     {"one_axis", "the bearings allow rotation about one axis"},
     {"planar",
      "a body that slides on a table: x and y in the lab, and a rotation about the vertical"}},
    "kind of platform and its bearing");
constexpr ChoiceKey axis("axis", {"x", "y", "z"}, 2, "axis of rotation");
constexpr NumberKey tilt_limit("tilt_limit_deg", {0.0, pi, true, false},
                               "tilt at the mechanical stop of the bearing; a run ends there",
                               {.usually = "none"});
constexpr NumberKey battery_capacity(
    "battery_capacity_Ah", Range::positive(),
    "charge of the full battery. The event `battery_empty` occurs when it is drawn. With "
    "`[array.day]`, the energy of the battery is this times `battery_voltage_V`",
    {.usually = "none: never empty"});
constexpr NumberKey battery_voltage("battery_voltage_V", usual_battery_voltage_V, Range::positive(),
                                    "nominal voltage of the battery");
constexpr TableKey platform("platform", "the rotating body");
}  // namespace platform_key

// Whether the inertia is given as { value, sigma }.
bool has_sigma(const Settings& platform) {
  return platform.has(platform_key::inertia) && platform.raw(platform_key::inertia).is_table();
}

Mat3 read_inertia(const Settings& settings, const Platform& platform) {
  if (!platform.turns_about_one_axis()) {
    return has_sigma(settings) ? settings.table(platform_key::inertia).matrix3("value")
                               : settings.matrix3(platform_key::inertia);
  }
  if (!settings.has(platform_key::inertia)) return Mat3::Identity();
  if (settings.raw(platform_key::inertia).is_array())
    return settings.matrix3(platform_key::inertia);
  return settings.uncertain(platform_key::inertia, Range::positive()).value * Mat3::Identity();
}

// Whether moments violate the triangle inequality by no more than their errors of measurement.
bool breaks_within_sigma(const Mat3& inertia_kg_m2, const Mat3& sigma_kg_m2) {
  constexpr double most_sigma = 3.0;
  const Vec3 principal = Eigen::SelfAdjointEigenSolver<Mat3>(inertia_kg_m2).eigenvalues();
  const double excess = principal[2] - principal[0] - principal[1];
  return principal[0] > 0.0 && excess > 0.0 && excess < most_sigma * sigma_kg_m2.norm();
}

}  // namespace

double mass_sigma_kg(const Settings& platform) {
  return platform.has(platform_key::mass) ? platform.get(platform_key::mass).sigma : 0.0;
}

Mat3 inertia_sigma_kg_m2(const Settings& platform) {
  if (!has_sigma(platform)) return Mat3::Zero();
  const Settings both = platform.table(platform_key::inertia);
  // A single sigma applies to the three moments; the products are exact.
  if (!both.raw("sigma").is_array()) {
    return both.number("sigma", Range::not_negative()) * Mat3::Identity();
  }
  return both.matrix3("sigma");
}

Platform read_platform(const Settings& settings) {
  Platform platform;
  platform.topology = static_cast<Topology>(settings.get(platform_key::topology));
  if (platform.topology == Topology::one_axis) {
    platform.axis = Vec3::Unit(static_cast<Eigen::Index>(settings.get(platform_key::axis)));
  }
  if (platform.has_air_bearing() || settings.has(platform_key::mass)) {
    platform.mass_kg = settings.get(platform_key::mass).value;
  }
  platform.inertia_kg_m2 = read_inertia(settings, platform);
  if (settings.has(platform_key::inertia) &&
      !breaks_within_sigma(platform.inertia_kg_m2, inertia_sigma_kg_m2(settings))) {
    check_inertia(platform.inertia_kg_m2, settings.raw(platform_key::inertia).where,
                  settings.name() + "." + std::string(platform_key::inertia));
  }
  platform.inertia_kg_m2 =
      0.5 * (platform.inertia_kg_m2 + platform.inertia_kg_m2.transpose()).eval();
  if (settings.has(platform_key::tilt_limit)) {
    platform.tilt_limit_rad = settings.get(platform_key::tilt_limit);
  }
  if (settings.has(platform_key::battery_capacity)) {
    platform.battery_capacity_C = settings.get(platform_key::battery_capacity);
  }
  platform.battery_voltage_V = settings.get(platform_key::battery_voltage);
  return platform;
}

double tilt_rad(const PlatformState& state) {
  // sin(tilt/2)² = x² + y²: accurate near zero, where the cosine of the tilt is not.
  const Quat& q = state.lab_from_body;
  return 2.0 * std::atan2(std::hypot(q.x(), q.y()), std::hypot(q.w(), q.z()));
}

double heading_rad(const PlatformState& state) {
  const Vec3 body_z_lab = state.lab_from_body * Vec3::UnitZ();
  return std::atan2(body_z_lab.y(), body_z_lab.x());
}

double yaw_rad(const PlatformState& state) {
  const Vec3 body_x_lab = state.lab_from_body * Vec3::UnitX();
  return std::atan2(body_x_lab.y(), body_x_lab.x());
}

Key platform_table() {
  using namespace platform_key;
  const std::vector<Key> on_bearing = {mass, inertia};
  return platform.of(
      {topology.bringing(
           {on_bearing,
            on_bearing,
            on_bearing,
            {mass.usually("1"), inertia.meaning("3 × 3 matrix, as for `dumbbell`")},
            {axis, mass.usually("1"), inertia_about},
            {mass.usually("1"),
             inertia_about.meaning("moment of inertia about the vertical, or a 3 × 3 matrix")}}),
       tilt_limit, battery_capacity, battery_voltage});
}

}  // namespace photorque
