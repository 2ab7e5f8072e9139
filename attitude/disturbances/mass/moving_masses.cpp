#include "attitude/disturbances/mass/moving_masses.h"

#include <cmath>

#include "core/constants.h"
#include "core/numerics/linear.h"

namespace photorque {

double MovingMass::pitch_m() const {
  return step_angle_rad / (2.0 * pi) * lead_m / microsteps;
}

Vec3 MovingMass::com_step_m(double platform_mass_kg) const {
  return pitch_m() * mass_kg / platform_mass_kg * direction_body;
}

double com_resolution_m(const MovingMass& mass, double platform_mass_kg) {
  return 0.5 * mass.com_step_m(platform_mass_kg).norm();
}

double horizontal_rounding_torque_N_m(const MovingMass& mass, double tilt_rad,
                                      double gravity_m_s2) {
  return 0.5 * mass.pitch_m() * mass.mass_kg * gravity_m_s2 * std::cos(tilt_rad);
}

std::vector<MovingMass> eight_masses(const MovingMass& pattern) {
  std::vector<MovingMass> masses(8, pattern);
  for (size_t i = 0; i < masses.size(); ++i) {
    masses[i].direction_body = i < 2 ? Vec3::UnitX() : i < 4 ? Vec3::UnitY() : Vec3::UnitZ();
  }
  return masses;
}

BalanceCommand balancing_steps(const Vec3& offset_body_m, const std::vector<MovingMass>& masses,
                               double platform_mass_kg) {
  Eigen::Matrix3Xd shift_m(3, masses.size());
  for (size_t i = 0; i < masses.size(); ++i) {
    shift_m.col(static_cast<Eigen::Index>(i)) = masses[i].com_step_m(platform_mass_kg);
  }
  Eigen::VectorXd steps = least_squares(shift_m, -offset_body_m).solution.array().round().matrix();
  Vec3 left_m = offset_body_m + shift_m * steps;
  // Each pass reduces the remaining offset by a factor of at least 1 − 1e-12, so the loop ends.
  for (bool better = true; better;) {
    better = false;
    for (Eigen::Index i = 0; i < steps.size(); ++i) {
      const Vec3 one_m = shift_m.col(i);
      const double extra = -std::round(one_m.dot(left_m) / one_m.squaredNorm());
      const Vec3 now_m = left_m + extra * one_m;
      if (extra != 0.0 && now_m.norm() < left_m.norm() * (1.0 - 1e-12)) {
        steps[i] += extra;
        left_m = now_m;
        better = true;
      }
    }
  }
  BalanceCommand command;
  command.left_over_m = left_m;
  for (const double s : steps) command.steps.push_back(std::llround(s));
  return command;
}

namespace {

namespace moving_key {
constexpr NumberKey moving_mass("moving_mass_kg", Range::positive(), "mass of each balancing mass");
constexpr NumberKey lead("lead_m", Range::positive(), "travel per turn of the screw");
constexpr NumberKey step_angle("step_angle_deg", 1.8 * degree_rad, {1e-6 * degree_rad, 2.0 * pi},
                               "angle of a full step of the motor");
constexpr IntegerKey microsteps("microsteps", 1, 1, 1024, "microsteps per full step of the motor");
constexpr Vec3sKey directions("directions", "direction of travel of each mass, body axes",
                              {.usually = "eight: 2 x, 2 y, 4 z"});
}  // namespace moving_key

}  // namespace

std::vector<MovingMass> read_moving_masses(const Settings& settings) {
  MovingMass pattern;
  pattern.mass_kg = settings.get(moving_key::moving_mass);
  pattern.lead_m = settings.get(moving_key::lead);
  pattern.step_angle_rad = settings.get(moving_key::step_angle);
  pattern.microsteps = static_cast<int>(settings.get(moving_key::microsteps));
  if (!settings.has(moving_key::directions)) return eight_masses(pattern);
  std::vector<MovingMass> masses;
  for (const Vec3& direction : settings.get(moving_key::directions)) {
    if (!(direction.norm() > 0.0)) {
      throw settings.error(moving_key::directions, "a direction of zero length",
                           "directions of travel");
    }
    masses.push_back(pattern);
    masses.back().direction_body = direction.normalized();
  }
  return masses;
}

std::vector<Key> moving_mass_keys() {
  using namespace moving_key;
  return {moving_mass, lead, step_angle, microsteps, directions};
}

}  // namespace photorque
