// Parts that turn about an axis.
#include "scenes/experiment/joints.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scenes/experiment/experiment.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

const std::filesystem::path spacecraft =
    std::filesystem::path(PHOTORQUE_SOURCE_DIR) / "scenes/spacecraft/spacecraft.toml";

ExperimentFile with_joint(const std::string& joint) {
  const std::string overrides[] = {"joint=[" + joint + "]"};
  return read_experiment_file(spacecraft, overrides);
}

std::string error_of(const std::string& joint) {
  return refusal_of([&] { resolve_experiment(with_joint(joint)); });
}

// A quarter turn about y takes (x, y, z) to (z, y, −x): the wings' cells then look along +x.
TEST(Joints, TurnTheirPartsAndNothingElse) {
  const Experiment rest = resolve_experiment(read_experiment_file(spacecraft));
  const Experiment turned = resolve_experiment(with_joint(
      "{nodes=[\"wing_1\", \"wing_2\", \"solar_array\"], axis=[0, 2, 0], angle_deg=90}"));
  size_t moved = 0;
  for (size_t i = 0; i < rest.scene.instances.size(); ++i) {
    const Instance &before = rest.scene.instances[i], &after = turned.scene.instances[i];
    const bool of_wing = before.path.find("wing") != std::string::npos ||
                         before.path.find("solar_array") != std::string::npos;
    moved += of_wing ? 1 : 0;
    for (const Vec3& vertex : rest.scene.meshes[before.mesh].vertices_m) {
      const Vec3 at = before.body_from_mesh * vertex;
      const Vec3 expected = of_wing ? Vec3(at.z(), at.y(), -at.x()) : at;
      EXPECT_NEAR((after.body_from_mesh * vertex - expected).norm(), 0.0, 1e-12);
    }
  }
  EXPECT_EQ(moved, 4u);
}

// A quarter turn about z takes x to y.
TEST(Joints, TurnTheAxesOfSlopeErrors) {
  const std::string overrides[] = {
      "material=[{name=\"solar_cell\", specular=1, slope_error_mrad=[5, 1], slope_error_axis=[1, "
      "0, 0]}]",
      "joint=[{node=\"panel_1\", axis=[0, 0, 1], angle_deg=90}]"};
  const Experiment turned = resolve_experiment(read_experiment_file(spacecraft, overrides));
  size_t with_axis = 0;
  for (const Instance& part : turned.scene.instances) {
    const auto& bsdf = turned.scene.surface(part, true).bsdf;
    if (!bsdf || bsdf->axis.isZero(0.0)) continue;
    ++with_axis;
    const bool of_wing = part.path.find("panel_1") != std::string::npos;
    EXPECT_LT((bsdf->axis - (of_wing ? Vec3::UnitY() : Vec3::UnitX())).norm(), 1e-12) << part.path;
  }
  EXPECT_GE(with_axis, 2u);
}

// The angle about y that lets +z look at a Sun in the plane of x and z is the Sun's own.
TEST(Joints, FollowTheSunAsNearAsTheirAxisLetsThem) {
  Joint joint;
  joint.axis = Vec3::UnitY();
  joint.towards_sun = Vec3::UnitZ();
  for (const double angle : {-2.5, -0.3, 0.0, 1.2, 3.0}) {
    EXPECT_NEAR(joint.angle_towards({std::sin(angle), 0.7, std::cos(angle)}), angle, 1e-12);
  }
  EXPECT_EQ(joint.angle_towards(Vec3::UnitY()), 0.0);  // no angle is better than another
}

TEST(Joints, SchedulesAreStraightLinesThatHoldAtBothEnds) {
  Joint joint;
  joint.schedule = {{10.0, 0.2}, {20.0, 0.6}, {40.0, 0.0}};
  EXPECT_DOUBLE_EQ(joint.angle_at(0.0), 0.2);
  EXPECT_DOUBLE_EQ(joint.angle_at(15.0), 0.4);
  EXPECT_DOUBLE_EQ(joint.angle_at(30.0), 0.3);
  EXPECT_DOUBLE_EQ(joint.angle_at(99.0), 0.0);
}

// A polynomial of degree positions − 1 comes out exactly, at every angle of the schedule.
TEST(Joints, PositionsInterpolatePolynomials) {
  Joint joint;
  joint.schedule = {{0.0, -0.4}, {1.0, 1.1}};
  joint.positions = 5;
  const JointPositions positions(joint);
  ASSERT_EQ(positions.angles_rad().size(), 5u);
  EXPECT_DOUBLE_EQ(positions.angles_rad().front(), -0.4);
  EXPECT_DOUBLE_EQ(positions.angles_rad().back(), 1.1);
  const auto quartic = [](double x) {
    return 1.0 - 2.0 * x + 0.5 * x * x * x + 3.0 * x * x * x * x;
  };
  for (const double angle : {-0.4, -0.1, 0.33, 0.9, 1.1}) {
    const std::vector<double> weights = positions.weights(angle);
    double value = 0.0, sum = 0.0;
    for (size_t i = 0; i < weights.size(); ++i) {
      value += weights[i] * quartic(positions.angles_rad()[i]);
      sum += weights[i];
    }
    EXPECT_NEAR(value, quartic(angle), 1e-13);
    EXPECT_NEAR(sum, 1.0, 1e-14);
  }
}

TEST(Joints, WrongOnesNameTheirKey) {
  using testing::HasSubstr;
  EXPECT_THAT(error_of("{node=\"sail\", axis=[0,1,0]}"), HasSubstr("\"wing_1\", \"wing_2\""));
  EXPECT_THAT(error_of("{node=\"wing_1\", axis=[0,0,0]}"), HasSubstr("a zero vector"));
  EXPECT_THAT(error_of("{axis=[0,1,0]}"), HasSubstr("one of node and nodes"));
  EXPECT_THAT(error_of("{node=\"wing_1\", axis=[0,1,0], towards_sun=[0,3,0]}"),
              HasSubstr("one that the joint turns"));
  EXPECT_THAT(error_of("{node=\"wing_1\", axis=[0,1,0]}, {node=\"wing_1\", axis=[0,1,0]}"),
              HasSubstr("parts that no joint turns yet"));
  EXPECT_THAT(error_of("{node=\"wing_1\", axis=[0,1,0], angle=3}"), HasSubstr("angle"));
}

}  // namespace
}  // namespace photorque
