// The rotating body, on the bearing or in orbit, and its state.
#pragma once

#include <optional>
#include <vector>

#include "core/constants.h"
#include "core/settings/typed_keys.h"
#include "core/transform.h"

namespace photorque {

enum class Topology {
  dumbbell,  // two instrumented arms, limited tilt
  tabletop,  // one plate over the bearing
  hollow,    // equipment inside the sphere
  free,      // a spacecraft, a thrown body: no bearing
  one_axis,  // a wheel, a pendulum: turns about one axis alone
  planar,    // a puck on an air table: slides in the horizontal plane, turns about the vertical
};

inline constexpr double usual_battery_voltage_V = 14.8;

struct Platform {
  Topology topology = Topology::tabletop;
  double mass_kg = 1.0;                   // > 0, of everything that turns
  Mat3 inertia_kg_m2 = Mat3::Identity();  // body axes, about the centre of rotation, symmetric
  // Angle between body z and lab z at the bearing's stop; none: no stop.
  std::optional<double> tilt_limit_rad;
  // Charge of the full battery [C]; none: it is never empty.
  std::optional<double> battery_capacity_C;
  double battery_voltage_V = usual_battery_voltage_V;  // nominal, > 0
  // Rotation axis of a one_axis platform: x, y or z, equal in body and lab axes.
  Vec3 axis = Vec3::UnitZ();
  // The experiment states an effect that only a bearing has (its drag): the platform then has a
  // bearing, independent of the topology.
  bool has_effects_of_bearing = false;

  bool turns_about_one_axis() const { return topology == Topology::one_axis || slides(); }
  // The centre of mass moves in the lab's xy plane.
  bool slides() const { return topology == Topology::planar; }
  bool has_bearing() const { return topology != Topology::free || has_effects_of_bearing; }
  // The platform floats on air and turns about all three axes.
  bool has_air_bearing() const { return has_bearing() && !turns_about_one_axis(); }
};

// Reads [platform], whose keys are platform_table(). A planar platform turns about z. With the
// default inertia and mass of one, torques are per unit of inertia and forces per unit of mass.
// InputError if the mass is not positive or the inertia not valid (check_inertia()).
Platform read_platform(const Settings& settings);
Key platform_table();

// The sigmas of the entries of [platform] inertia_kg_m2 = { value, sigma }; zero if none is given.
Mat3 inertia_sigma_kg_m2(const Settings& platform);

// Sigma of [platform] mass_kg = { value, sigma }; zero if none is given.
double mass_sigma_kg(const Settings& platform);

// InputError at `where` if the inertia is not symmetric, not positive definite or violates the
// triangle inequality: the largest principal moment exceeds the sum of the others, which is
// impossible for a body. `key` names the value.
void check_inertia(const Mat3& inertia_kg_m2, const InputLocation& where, const std::string& key);

// The state of a platform: attitude, rate, charge, and the extra states of its disturbances.
struct PlatformState {
  double time_s = 0.0;
  Quat lab_from_body = Quat::Identity();  // unit norm, Hamilton, rotates body into lab
  Vec3 rate_body_rad_s = Vec3::Zero();    // of the body with respect to the lab, body axes
  double charge_drawn_C = 0.0;            // from the battery since it was full
  // The extra states of all disturbances, one after the other in their order (ExtraState).
  std::vector<double> extra;
};

// Angle between body z and lab z, in [0, π].
double tilt_rad(const PlatformState& state);
// Azimuths from lab x towards y, in (−π, π]: the direction in which body z is tilted (0 if
// upright), and the yaw of body x in the horizontal plane.
double heading_rad(const PlatformState& state);
double yaw_rad(const PlatformState& state);

}  // namespace photorque
