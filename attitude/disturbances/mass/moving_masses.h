// Balancing masses on screws with stepper motors: the positions of the centre of mass that they can
// reach, and the resolution. Source: eq. 1.
#pragma once

#include <cstdint>
#include <vector>

#include "core/settings/typed_keys.h"
#include "core/transform.h"

namespace photorque {

struct MovingMass {
  Vec3 direction_body = Vec3::UnitX();  // of travel, unit
  double mass_kg = 0.0;                 // m_m > 0
  double lead_m = 0.0;                  // of the screw: travel per turn, > 0
  double step_angle_rad = 0.0;          // Δφ, of one full step
  int microsteps = 1;                   // commanded positions per full step

  // Travel between two commanded positions [m].
  double pitch_m() const;
  // Shift of a platform's centre of mass by one such step [m].
  Vec3 com_step_m(double platform_mass_kg) const;
};

// Resolution of the centre of mass along one axis [m]: half a step, ½ Δφ/2π · lead · m_m/m_tot.
double com_resolution_m(const MovingMass& mass, double platform_mass_kg);

// Eq. 1: torque of half a step [N m] on an axis that is horizontal at zero tilt, for a tilt
// perpendicular to it.
double horizontal_rounding_torque_N_m(const MovingMass& mass, double tilt_rad, double gravity_m_s2);

// Eight equal masses, as on the paper's platform: two along each horizontal axis and four along the
// vertical axis.
std::vector<MovingMass> eight_masses(const MovingMass& pattern);

// Whole steps of each mass, and the remaining offset.
struct BalanceCommand {
  std::vector<int64_t> steps;
  Vec3 left_over_m = Vec3::Zero();  // of the centre of mass, body axes
};

// The steps that compensate an offset of the centre of mass best: the solution with the least
// travel, rounded, then improved step by step while the remaining offset decreases. Directions that
// no mass can reach remain.
BalanceCommand balancing_steps(const Vec3& offset_body_m, const std::vector<MovingMass>& masses,
                               double platform_mass_kg);

// Reads the keys of moving_mass_keys().
std::vector<MovingMass> read_moving_masses(const Settings& settings);
std::vector<Key> moving_mass_keys();

}  // namespace photorque
