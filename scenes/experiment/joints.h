// Rotating parts of a scene, such as solar wings and antennas.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/settings/typed_keys.h"
#include "raytrace/scene.h"

namespace photorque {

// [[joint]]. Directions and points are in body axes; the model is drawn at the angle 0.
struct Joint {
  std::vector<std::string> nodes;  // these nodes and all nodes below them
  Vec3 axis = Vec3::UnitZ();       // unit
  Vec3 point_m = Vec3::Zero();     // a point on the axis
  double angle_rad = 0.0;          // for a single trace
  // For a run of the motion, either `towards_sun` or `schedule`. The joint turns the unit direction
  // `towards_sun` as near to the Sun as possible. Angles of a schedule are interpolated linearly
  // between instants and constant outside.
  std::optional<Vec3> towards_sun;
  struct Instant {
    double time_s = 0.0, angle_rad = 0.0;
  };
  std::vector<Instant> schedule;
  size_t positions = 5;  // number of angles at which light is computed, see JointPositions

  bool moves() const { return towards_sun || !schedule.empty(); }
  double angle_at(double time_s) const;              // of the schedule
  double angle_towards(const Vec3& sun_body) const;  // in [−π, π]; 0 if the Sun is along the axis
};

// Angles of a schedule between which light is interpolated by a polynomial. They are the extremes
// of a Chebyshev polynomial over the range of the angles (L. N. Trefethen, Approximation Theory and
// Approximation Practice (2013), chapter 5).
class JointPositions {
 public:
  explicit JointPositions(const Joint& joint);

  const std::vector<double>& angles_rad() const { return angles_rad_; }
  // Weights of the results at these angles; they sum to one.
  std::vector<double> weights(double angle_rad) const;

 private:
  std::vector<double> angles_rad_;  // rising
};

// Reads the tables [[joint]]. Throws InputError for invalid keys.
std::vector<Joint> read_joints(const std::vector<Settings>& tables);
std::vector<Key> joint_keys();

// Rotates the parts of each joint by its angle. Throws InputError, located in `tables`, for a node
// that is missing or belongs to two joints.
void turn_joints(Scene& scene, const std::vector<Joint>& joints,
                 const std::vector<Settings>& tables);

}  // namespace photorque
