#include "scenes/experiment/joints.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>

#include "core/constants.h"
#include "core/settings/settings.h"

namespace photorque {
namespace {

constexpr Range joint_angle{-2.0 * pi, 2.0 * pi};
constexpr int64_t most_positions = 33;

namespace joint_key {
constexpr TextKey node("node", "node of the scene that rotates, with all nodes below it; *or*",
                       {.optional = true});
constexpr TextsKey nodes("nodes", "several nodes that rotate together", {.optional = true});
constexpr Vec3Key axis("axis", "direction of the rotation axis, body axes, any length");
constexpr Vec3Key point("point_m", {0.0, 0.0, 0.0}, "point on the rotation axis, body axes");
constexpr NumberKey angle("angle_deg", 0.0, joint_angle,
                          "rotation from the pose in the model file");
constexpr Vec3Key towards_sun("towards_sun",
                              "in `propagate`: direction in the model file that follows the Sun, "
                              "as closely as the axis allows",
                              {.optional = true});
constexpr NumberKey time("time_s", {}, "time of the angle, rising");
constexpr NumberKey at_angle(
    "angle_deg", joint_angle,
    "angle at that time; linear between instants, constant before the first and after the last");
constexpr TablesKey at("at", "*or* the angle over time, in `propagate`");
constexpr IntegerKey positions("positions", 5, 2, most_positions,
                               "number of angles, over the range of `[[joint.at]]`, at which the "
                               "light is traced; interpolated between them");
}  // namespace joint_key

Vec3 read_direction(const Settings& joint, const Vec3Key& key) {
  return direction_of(joint, key).normalized();
}

std::vector<std::string> read_nodes(const Settings& joint) {
  if (joint.has(joint_key::nodes) == joint.has(joint_key::node)) {
    throw joint.error(joint_key::node, joint.has(joint_key::node) ? "node beside nodes" : "nothing",
                      "one of node and nodes");
  }
  if (joint.has(joint_key::node)) return {joint.get(joint_key::node)};
  const std::vector<std::string> nodes = joint.get(joint_key::nodes);
  if (nodes.empty()) throw joint.error(joint_key::nodes, "an empty array", "names of nodes");
  return nodes;
}

std::vector<Joint::Instant> read_schedule(const Settings& joint) {
  std::vector<Joint::Instant> schedule;
  for (const Settings& at : joint.get(joint_key::at)) {
    schedule.push_back({at.get(joint_key::time), at.get(joint_key::at_angle)});
    const size_t n = schedule.size();
    if (n > 1 && !(schedule[n - 2].time_s < schedule[n - 1].time_s)) {
      throw at.error(joint_key::time, std::to_string(schedule[n - 1].time_s),
                     "instants in rising order");
    }
  }
  return schedule;
}

Joint read_joint(const Settings& table) {
  Joint joint;
  joint.nodes = read_nodes(table);
  joint.axis = read_direction(table, joint_key::axis);
  joint.point_m = table.get(joint_key::point);
  joint.angle_rad = table.get(joint_key::angle);
  joint.schedule = read_schedule(table);
  joint.positions = static_cast<size_t>(table.get(joint_key::positions));
  if (table.has(joint_key::towards_sun)) {
    joint.towards_sun = read_direction(table, joint_key::towards_sun);
    if (!joint.schedule.empty()) {
      throw table.error(joint_key::towards_sun, "both a schedule and towards_sun",
                        "one of towards_sun and [[joint.at]]");
    }
    if (joint.towards_sun->cross(joint.axis).norm() < 1e-6) {
      throw table.error(joint_key::towards_sun, "a direction along the axis",
                        "one that the joint turns");
    }
  }
  table.finish();
  return joint;
}

// Rotates the axis of the slope errors on one side of a part.
void turn_axis(Scene& scene, uint32_t& surface, const Quat& turn) {
  const auto& bsdf = scene.surfaces[surface].bsdf;
  if (!bsdf || bsdf->axis.isZero(0.0)) return;
  OpticalSurface turned = scene.surfaces[surface];
  Bsdf with_axis = *bsdf;
  with_axis.axis = turn * with_axis.axis;
  turned.bsdf = std::make_shared<const Bsdf>(std::move(with_axis));
  scene.surfaces.push_back(std::move(turned));
  surface = static_cast<uint32_t>(scene.surfaces.size() - 1);
}

std::string nodes_of(const Scene& scene, const std::string& wanted) {
  std::set<std::string> names;
  for (const Instance& instance : scene.instances) names.insert(instance.node);
  return listed_names(std::move(names), wanted);
}

}  // namespace

double Joint::angle_at(double time_s) const {
  if (schedule.empty()) return angle_rad;
  const auto after = std::ranges::upper_bound(schedule, time_s, {}, &Instant::time_s);
  if (after == schedule.begin()) return schedule.front().angle_rad;
  if (after == schedule.end()) return schedule.back().angle_rad;
  const Instant &from = *(after - 1), &to = *after;
  return std::lerp(from.angle_rad, to.angle_rad,
                   (time_s - from.time_s) / (to.time_s - from.time_s));
}

double Joint::angle_towards(const Vec3& sun_body) const {
  const auto across = [this](const Vec3& v) -> Vec3 { return v - v.dot(axis) * axis; };
  const Vec3 face = across(*towards_sun), sun = across(sun_body);
  if (!(sun.norm() > 1e-9)) return 0.0;
  return std::atan2(axis.dot(face.cross(sun)), face.dot(sun));
}

JointPositions::JointPositions(const Joint& joint) {
  double low = joint.angle_rad, high = joint.angle_rad;
  if (!joint.schedule.empty()) {
    const auto [least, most] =
        std::ranges::minmax_element(joint.schedule, {}, &Joint::Instant::angle_rad);
    low = least->angle_rad;
    high = most->angle_rad;
  }
  const auto last = static_cast<double>(joint.positions - 1);
  for (size_t i = 0; i < joint.positions; ++i) {
    const double x = -std::cos(pi * static_cast<double>(i) / last);
    angles_rad_.push_back(0.5 * (low + high) + 0.5 * (high - low) * x);
  }
  if (!(high > low)) angles_rad_.resize(1);
}

std::vector<double> JointPositions::weights(double angle_rad) const {
  const size_t n = angles_rad_.size();
  std::vector<double> weights(n, 1.0);
  for (size_t i = 0; i < n; ++i) {
    for (size_t k = 0; k < n; ++k) {
      if (k == i) continue;
      weights[i] *= (angle_rad - angles_rad_[k]) / (angles_rad_[i] - angles_rad_[k]);
    }
  }
  return weights;
}

std::vector<Joint> read_joints(const std::vector<Settings>& tables) {
  std::vector<Joint> joints;
  for (const Settings& table : tables) joints.push_back(read_joint(table));
  return joints;
}

void turn_joints(Scene& scene, const std::vector<Joint>& joints,
                 const std::vector<Settings>& tables) {
  std::set<uint32_t> turned;
  for (size_t j = 0; j < joints.size(); ++j) {
    const Joint& joint = joints[j];
    const Quat rotation(Eigen::AngleAxisd(joint.angle_rad, joint.axis));
    Affine turn = Affine::Identity();
    turn.translate(joint.point_m);
    turn.rotate(Eigen::AngleAxisd(joint.angle_rad, joint.axis));
    turn.translate(-joint.point_m);
    for (const std::string& node : joint.nodes) {
      const auto wrong = [&](const std::string& expected) {
        const char* key = tables[j].has(joint_key::node) ? "node" : "nodes";
        return tables[j].error(key, "\"" + node + "\"", expected);
      };
      const std::vector<uint32_t> parts = scene.instances_of(node);
      if (parts.empty()) {
        throw wrong("a node of the scene that holds a mesh: " + nodes_of(scene, node));
      }
      for (const uint32_t part : parts) {
        if (!turned.insert(part).second) throw wrong("parts that no joint turns yet");
        // Skipped, so that a joint at angle 0 changes no bit of the scene.
        if (joint.angle_rad == 0.0) continue;
        Instance& instance = scene.instances[part];
        instance.body_from_mesh = turn * instance.body_from_mesh;
        turn_axis(scene, instance.front_surface, rotation);
        turn_axis(scene, instance.back_surface, rotation);
      }
    }
  }
}

std::vector<Key> joint_keys() {
  using namespace joint_key;
  return {node, nodes, axis, point, angle, towards_sun, at.of({time, at_angle}), positions};
}

}  // namespace photorque
