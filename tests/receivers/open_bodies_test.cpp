// Bodies with an inside, with none, and with one turned inside out: the force of sunlight on black
// surfaces is its pressure times what they stand in its way, whichever side is lit.
#include <gtest/gtest.h>

#include "receivers/gather/bodies/facets.h"
#include "receivers/gather/bodies/sunlit_body.h"
#include "tests/raytrace/test_scenes.h"
#include "tests/receivers/gather_lamps.h"
#include "tests/receivers/receiver_scenes.h"
#include "tests/receivers/sunlight.h"

namespace photorque {
namespace {

using fixtures::add;
using fixtures::append;
using fixtures::pressure_Pa;
using fixtures::rectangle;
using fixtures::sun;

Mesh turned_inside_out(Mesh mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
  return mesh;
}

// Sectors and rings; of 32 by 16 the rim has fewer edges than the root of all of them.
Mesh disc(double radius_m, uint32_t sectors, uint32_t rings) {
  Mesh mesh;
  mesh.vertices_m.push_back(Vec3::Zero());
  for (uint32_t r = 1; r <= rings; ++r) {
    for (uint32_t s = 0; s < sectors; ++s) {
      const double angle = 2.0 * pi * s / sectors, at_m = radius_m * r / rings;
      mesh.vertices_m.emplace_back(at_m * std::cos(angle), at_m * std::sin(angle), 0.0);
    }
  }
  const auto at = [&](uint32_t r, uint32_t s) { return 1 + (r - 1) * sectors + s % sectors; };
  for (uint32_t s = 0; s < sectors; ++s) {
    mesh.triangles.push_back({0, at(1, s), at(1, s + 1)});
    for (uint32_t r = 1; r < rings; ++r) {
      mesh.triangles.push_back({at(r, s), at(r + 1, s), at(r + 1, s + 1)});
      mesh.triangles.push_back({at(r, s), at(r + 1, s + 1), at(r, s + 1)});
    }
  }
  return mesh;
}

std::optional<bool> inwards(const Mesh& mesh) {
  Scene scene;
  add(scene, mesh, grey_surface("black", 0.0, 0.0), "body");
  const uint32_t body = 0;
  return fronts_look_inwards(faces_of(scene, std::span(&body, 1)));
}

// Force over pressure, along the light.
double shadow_m2(Mesh mesh, double tilt_rad) {
  mesh.encloses = true;  // as a reader that takes it to be almost closed says
  Scene scene;
  add(scene, std::move(mesh), grey_surface("black", 0.0, 0.0), "body");
  const TraceableScene traceable(scene);
  const Beam beam = sun(0.0);
  const auto body = SunlitBody::make(traceable, std::span(&beam, 1), Vec3::Zero(), {});
  const RigidTransform attitude = lab_from_body_at(tilt_rad, 0.3);
  const SunlitWrench found = body->wrench(attitude, 1e-6 * pressure_Pa);
  const Vec3 travel = attitude.inverse().direction(-Vec3::UnitZ());
  return found.direct.head<3>().matrix().dot(travel) / pressure_Pa;
}

// A box is convex: its shadow is half the sum of the projected areas of its six faces.
double shadow_of_box_m2(const Vec3& size_m, double tilt_rad) {
  const Vec3 travel = lab_from_body_at(tilt_rad, 0.3).inverse().direction(-Vec3::UnitZ());
  return std::abs(travel.x()) * size_m.y() * size_m.z() +
         std::abs(travel.y()) * size_m.x() * size_m.z() +
         std::abs(travel.z()) * size_m.x() * size_m.y();
}

const Mesh cube_of_1_m = fixtures::box(Vec3::Zero(), Vec3::Ones());

TEST(OpenBodies, SheetsInOneMeshWithABoxAreLitFromBothSides) {
  Mesh mesh = cube_of_1_m;
  append(mesh, rectangle(Vec3(4, 0.5, 0.5), Vec3(1, 0, 0), Vec3(0, 2, 0)));
  EXPECT_EQ(inwards(mesh), std::nullopt);
  for (const double tilt_rad : {0.2, pi - 0.2}) {
    EXPECT_NEAR(shadow_m2(mesh, tilt_rad),
                shadow_of_box_m2(Vec3::Ones(), tilt_rad) + 2.0 * std::cos(0.2), 1e-6)
        << tilt_rad;
  }
}

TEST(OpenBodies, ADiscOfManyRingsIsLitFromBothSides) {
  const Mesh mesh = disc(1.0, 32, 16);
  EXPECT_EQ(inwards(mesh), std::nullopt);
  const double area_m2 = 16.0 * std::sin(2.0 * pi / 32.0);
  for (const double tilt_rad : {0.2, pi - 0.2}) {
    EXPECT_NEAR(shadow_m2(mesh, tilt_rad), area_m2 * std::cos(0.2), 1e-6) << tilt_rad;
  }
}

TEST(OpenBodies, LightThroughAHoleStaysInside) {
  Mesh mesh = cube_of_1_m;
  std::erase_if(mesh.triangles, [&](const std::array<uint32_t, 3>& t) {
    return std::ranges::all_of(t, [&](uint32_t v) { return mesh.vertices_m[v].z() == 1.0; });
  });
  EXPECT_EQ(inwards(mesh), std::nullopt);
  EXPECT_NEAR(shadow_m2(mesh, 0.2), shadow_of_box_m2(Vec3::Ones(), 0.2), 1e-6);
}

TEST(OpenBodies, OneBodyOfAMeshMayBeInsideOut) {
  Mesh mesh = cube_of_1_m;
  append(mesh, turned_inside_out(fixtures::box(Vec3(4, 0, 0), Vec3(4.5, 0.5, 0.5))));
  EXPECT_EQ(inwards(mesh), std::nullopt);
  EXPECT_NEAR(shadow_m2(mesh, 0.2),
              shadow_of_box_m2(Vec3::Ones(), 0.2) + shadow_of_box_m2(Vec3::Constant(0.5), 0.2),
              1e-6);
}

TEST(OpenBodies, ClosedOnesHaveAnInside) {
  EXPECT_EQ(inwards(cube_of_1_m), false);
  EXPECT_EQ(inwards(turned_inside_out(cube_of_1_m)), true);
  Mesh two = cube_of_1_m;
  append(two, fixtures::box(Vec3(4, 0, 0), Vec3(4.5, 0.5, 0.5)));
  EXPECT_EQ(inwards(two), false);
  Mesh mixed = cube_of_1_m;  // one triangle of twelve the other way round
  std::swap(mixed.triangles[3][0], mixed.triangles[3][1]);
  EXPECT_EQ(inwards(mixed), std::nullopt);
  // With a triangle that is a line, between two of its corners that are one.
  Mesh needle = cube_of_1_m;
  needle.triangles.push_back({0, 1, 1});
  EXPECT_EQ(inwards(needle), false);
}

}  // namespace
}  // namespace photorque
