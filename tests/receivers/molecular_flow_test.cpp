// The force of a free-molecular gas on surfaces and bodies.
#include <gtest/gtest.h>

#include <cmath>

#include "core/constants.h"
#include "raytrace/scene.h"
#include "receivers/gather/bodies/body_in_flow.h"
#include "tests/receivers/gather_lamps.h"
#include "tests/receivers/receiver_scenes.h"
#include "tests/receivers/sunlight.h"

namespace photorque {
namespace {

using fixtures::add;
using fixtures::rectangle;

const Vec3 down = -Vec3::UnitZ();

WrenchSum in_flow(const Scene& scene, double speed_ratio, const GasWall& wall, const Vec3& travel,
                  const Vec3& about_m = Vec3::Zero()) {
  const TraceableScene traceable(scene);
  return BodyInFlow(traceable, speed_ratio, std::vector(scene.instances.size(), wall), about_m)
      .wrench(travel)
      .per_pressure;
}

// A black body of one closed part.
Scene closed(Mesh mesh) {
  Scene scene;
  mesh.encloses = true;
  add(scene, std::move(mesh), grey_surface("b", 0.0, 0.0), "body");
  return scene;
}

// A sphere from which molecules leave at the temperature of the wall, by its cross-section.
// Source: G. A. Bird, Molecular Gas Dynamics and the Direct Simulation of Gas Flows (1994), eq.
// 7.71.
double sphere_drag(double s, double wall_ratio) {
  const double s2 = s * s, s4 = s2 * s2;
  return (2.0 * s2 + 1.0) / (std::sqrt(pi) * s2 * s) * std::exp(-s2) +
         (4.0 * s4 + 4.0 * s2 - 1.0) / (2.0 * s4) * std::erf(s) +
         2.0 * std::sqrt(pi * wall_ratio) / (3.0 * s);
}

// A long cylinder across the flow, by diameter times length.
// Source: S. A. Schaaf, P. L. Chambré, Flow of Rarefied Gases (1961), sec. H.8.
double cylinder_drag(double s, double wall_ratio) {
  const double h = 0.5 * s * s;
  return std::sqrt(pi) / s * std::exp(-h) *
             ((s * s + 1.5) * std::cyl_bessel_i(0.0, h) +
              (s * s + 0.5) * std::cyl_bessel_i(1.0, h)) +
         std::pow(pi, 1.5) * std::sqrt(wall_ratio) / (4.0 * s);
}

TEST(MolecularFlow, ASphereHasItsPublishedDrag) {
  const Scene scene = closed(fixtures::sphere(1.0, 36));
  const Vec3 travel(0.6, 0.0, -0.8);
  // The facets lie inside the sphere, by up to 1 − cos(π/72) of its radius.
  constexpr double inside = 3e-3;
  for (const auto& [s, wall_ratio] :
       {std::pair{0.5, 1.0}, {1.0, 0.1}, {3.0, 1.0}, {8.0, 0.1}, {8.0, 1.0}}) {
    const WrenchSum found = in_flow(scene, s, {1.0, wall_ratio}, travel);
    const Vec3 force = found.head<3>().matrix() / pi;
    EXPECT_LT((force - sphere_drag(s, wall_ratio) * travel).norm(), inside * force.norm()) << s;
    EXPECT_LT(found.tail<3>().matrix().norm(), inside);
  }
  // Another temperature of the wall is noticed.
  const double other = in_flow(scene, 8.0, {1.0, 0.3}, travel).head<3>().matrix().norm() / pi;
  EXPECT_GT(std::abs(other - sphere_drag(8.0, 0.1)), 3.0 * inside * other);
}

TEST(MolecularFlow, ACylinderHasItsPublishedDrag) {
  Scene scene;
  Mesh tube;
  constexpr uint32_t corners = 360;
  for (uint32_t i = 0; i < corners; ++i) {
    const double angle = 2.0 * pi * i / corners;
    for (const double z : {-0.5, 0.5})
      tube.vertices_m.emplace_back(std::cos(angle), std::sin(angle), z);
    const uint32_t a = 2 * i, b = 2 * ((i + 1) % corners);
    tube.triangles.push_back({a, b, b + 1});
    tube.triangles.push_back({a, b + 1, a + 1});
  }
  // Caps that are edge-on to the flow: shear on both, P/√π each, and pressure that cancels.
  for (const double z : {-0.5, 0.5}) {
    const auto first = static_cast<uint32_t>(tube.vertices_m.size());
    tube.vertices_m.emplace_back(0.0, 0.0, z);
    for (uint32_t i = 0; i < corners; ++i) {
      const uint32_t a = 2 * i + (z > 0.0 ? 1 : 0), b = 2 * ((i + 1) % corners) + (z > 0.0 ? 1 : 0);
      if (z > 0.0) {
        tube.triangles.push_back({first, a, b});
      } else {
        tube.triangles.push_back({first, b, a});
      }
    }
  }
  const Scene body = closed(std::move(tube));
  for (const double s : {0.7, 2.0, 6.0}) {
    const WrenchSum found = in_flow(body, s, {1.0, 0.4}, -Vec3::UnitX());
    const double caps = 2.0 * pi / (s * std::sqrt(pi));
    EXPECT_NEAR(-found[0], 2.0 * cylinder_drag(s, 0.4) + caps, 1e-3 * -found[0]) << s;
    EXPECT_NEAR(found[2], 0.0, 1e-9);
  }
}

// Fast molecules that stay on a plate leave it their momentum: twice ½ρv². Molecules that come off
// a wall like a gas from an opening, with the energy ½v² on the mean, have the temperature v²/(4R)
// and the momentum √(πRT/2) = v √(π/8) along the normal: they add √(π/2).
// Source: G. A. Bird, 1994, eq. 4.24 and 4.25 at rest.
TEST(MolecularFlow, FastMoleculesLeaveTheirMomentumOnAPlate) {
  constexpr double fast = 1e6;
  const Vec3 cold = MolecularFlux(fast, down, Vec3::UnitZ()).force({1.0, 1e-9});
  EXPECT_LT((cold - 2.0 * down).norm(), 1e-5);
  const Vec3 hot = MolecularFlux(fast, down, Vec3::UnitZ()).force({0.0, 1e-9});
  EXPECT_LT((hot - (2.0 + std::sqrt(0.5 * pi)) * down).norm(), 1e-5);
  // At an angle, the area and the momentum along the flow: 2 cos.
  const Vec3 tilted = MolecularFlux(fast, down, Vec3(0.6, 0.0, 0.8)).force({1.0, 1e-9});
  EXPECT_LT((tilted - 1.6 * down).norm(), 1e-5);
  EXPECT_TRUE(MolecularFlux(8.0, down, down).is_none());
}

// A gas that hardly moves presses with its pressure ρRT = ½ρv²/S² from both sides.
TEST(MolecularFlow, AGasAtRestHasItsPressure) {
  constexpr double slow = 1e-4;
  const Vec3 force = slow * slow * MolecularFlux(slow, down, Vec3::UnitX()).force({1.0, 1.0});
  EXPECT_LT((force + Vec3::UnitX()).norm(), 1e-3);
}

// A small plate upstream of another: the shadow is cut out along its edges.
TEST(MolecularFlow, AShadowTakesItsRectangleOutOfThePlateBehind) {
  Scene scene;
  add(scene, rectangle(Vec3::Zero(), Vec3(2, 0, 0), Vec3(0, 2, 0)), grey_surface("b", 0.0, 0.0),
      "behind");
  add(scene, rectangle(Vec3(0.1, 0.2, 0.5), Vec3(0.6, 0, 0), Vec3(0, 0.4, 0)),
      grey_surface("b", 0.0, 0.0), "before");
  constexpr double s = 20.0;
  const GasWall wall{0.9, 0.3};
  for (const Vec3& way : {Vec3(0.1, 0.0, -1.0), Vec3(-0.4, 0.3, -1.0)}) {
    const Vec3 travel = way.normalized();
    const Vec3 force = MolecularFlux(s, travel, Vec3::UnitZ()).force(wall);
    const Vec3 shadow_m = Vec3(0.1, 0.2, 0.5) - 0.5 / travel.z() * travel;
    const WrenchSum found = in_flow(scene, s, wall, travel, Vec3(0.0, 0.0, 1.0));
    EXPECT_LT((found.head<3>().matrix() - 4.0 * force).norm(), 1e-9);
    const Vec3 torque = -Vec3::UnitZ().cross(4.0 * force) - 0.24 * shadow_m.cross(force) +
                        0.24 * Vec3(0.1, 0.2, 0.5).cross(force);
    EXPECT_LT((found.tail<3>().matrix() - torque).norm(), 1e-9);
  }
}

// A side along the flow takes up shear from molecules that come at an angle; one that another part
// covers takes up nothing.
TEST(MolecularFlow, ACoveredSideAlongTheFlowIsInShadow) {
  Scene scene;
  add(scene, rectangle(Vec3::Zero(), Vec3(1, 0, 0), Vec3(0, 1, 0)), grey_surface("b", 0.0, 0.0),
      "plate");
  constexpr double s = 5.0;
  const Vec3 travel = Vec3::UnitX();
  const double shear = 1.0 / (s * std::sqrt(pi));
  const WrenchSum alone = in_flow(scene, s, {1.0, 0.3}, travel);
  EXPECT_NEAR(alone[0], 2.0 * shear, 1e-12);
  EXPECT_NEAR(alone[2], 0.0, 1e-12);
  Mesh lid = fixtures::box({-2.0, -2.0, -0.05}, {2.0, 2.0, 0.05});
  for (Vec3& vertex : lid.vertices_m) vertex.z() += 0.06;
  lid.encloses = true;
  const double lid_alone = in_flow(closed(lid), s, {1.0, 0.3}, travel)[0];
  add(scene, std::move(lid), grey_surface("b", 0.0, 0.0), "lid");
  EXPECT_NEAR(in_flow(scene, s, {1.0, 0.3}, travel)[0] - lid_alone, shear, 1e-9);
}

}  // namespace
}  // namespace photorque
