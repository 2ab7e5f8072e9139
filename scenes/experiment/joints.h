// Parts of a scene that turn about an axis: wings, antennas.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/settings/typed_keys.h"
#include "raytrace/scene.h"

namespace photorque {

// [[joint]]. Directions and points are in body axes, at the angle 0 that the model is drawn at.
struct Joint {
  std::vector<std::string> nodes;  // these parts of the scene and all below them
  Vec3 axis = Vec3::UnitZ();       // unit
  Vec3 point_m = Vec3::Zero();     // on the axis
  double angle_rad = 0.0;          // of a single trace
  // In a run of the motion: the unit direction that the joint turns towards the Sun, as near as can
  // be; or the angle at instants, on straight lines between them and held at both ends.
  std::optional<Vec3> towards_sun;
  struct Instant {
    double time_s = 0.0, angle_rad = 0.0;
  };
  std::vector<Instant> schedule;
  size_t positions = 5;  // at which a schedule's light is known, see JointPositions

  bool moves() const { return towards_sun || !schedule.empty(); }
  double angle_at(double time_s) const;              // of a schedule
  double angle_towards(const Vec3& sun_body) const;  // in [−π, π]; 0 for a Sun along the axis
};

// The angles of a schedule between which light is interpolated: a polynomial through its values at
// the extremes of Chebyshev's polynomial over the range of the angles (L. N. Trefethen,
// Approximation Theory and Approximation Practice (2013), chapter 5).
class JointPositions {
 public:
  explicit JointPositions(const Joint& joint);

  const std::vector<double>& angles_rad() const { return angles_rad_; }
  // The weights of the results at these angles, which sum to one.
  std::vector<double> weights(double angle_rad) const;

 private:
  std::vector<double> angles_rad_;  // rising
};

std::vector<Joint> read_joints(const std::vector<Settings>& tables);
std::vector<Key> joint_keys();

// Turns the parts of each joint by its angle. InputError, under `tables`, for a node that the scene
// has not, or that two joints turn.
void turn_joints(Scene& scene, const std::vector<Joint>& joints,
                 const std::vector<Settings>& tables);

}  // namespace photorque
