// Solids of the platform generator against the closed forms of volume, centre and inertia.
// Closed forms: H. Goldstein, Classical Mechanics, and tables of moments of inertia as in R. C.
// Weast (ed.), CRC Handbook of Chemistry and Physics.
#include "core/constants.h"
#include "platform_closed_mesh.h"
#include "scenes/experiment/toml.h"
#include "scenes/platforms/generator.h"

namespace photorque {
namespace {

constexpr int fine = 512;  // corners of a circle: inertia of curved solids within 1e-4

struct Named {
  std::string name;
  Mesh mesh;
  double volume_m3;
};

std::vector<Named> all_solids(int segments) {
  const double hole_area_m2 = pi * 0.1 * 0.1;
  const auto cap = [](double R, double h) { return pi * h * h * (3 * R - h) / 3; };
  return {
      {"box", box_solid({0.3, 0.2, 0.1}), 0.006},
      {"box_with_hole", box_with_hole_solid({0.5, 0.3, 0.02}, 0.1, segments),
       (0.15 - hole_area_m2) * 0.02},
      {"long_box_with_hole", box_with_hole_solid({0.66, 0.02, 0.01}, 0.004, segments),
       (0.66 * 0.02 - pi * 0.004 * 0.004) * 0.01},
      {"cylinder", cylinder_solid(0.1, 0.1, 0.4, 0, segments), pi * 0.01 * 0.4},
      {"tube", cylinder_solid(0.1, 0.1, 0.4, 0.06, segments), pi * (0.01 - 0.0036) * 0.4},
      {"frustum", cylinder_solid(0.2, 0.1, 0.3, 0, segments), pi * 0.1 * (0.04 + 0.02 + 0.01)},
      {"cone", cylinder_solid(0.2, 0.0, 0.3, 0, segments), pi * 0.04 * 0.1},
      {"ball", ball_solid(0.2, -0.2, 0.2, segments), 4.0 / 3 * pi * 0.008},
      {"cut_ball", ball_solid(0.2, -0.2, 0.05, segments), cap(0.2, 0.25)},
      {"ball_zone", ball_solid(0.2, -0.1, 0.05, segments), cap(0.2, 0.25) - cap(0.2, 0.1)},
      {"shell", shell_solid(0.2, 0.01, 0.1, segments), cap(0.2, 0.3) - cap(0.19, 0.29)},
      {"dish", dish_solid(0.4, 0.3, 0.01, segments), pi * 0.16 * 0.01},
  };
}

// The volume of a polyhedron as the flux of (0, 0, z) through its faces: not the sum of tetrahedra
// that the generator uses.
double volume_by_flux(const Mesh& mesh) {
  double volume = 0.0;
  for (const auto& t : mesh.triangles) {
    const Vec3 &a = mesh.vertices_m[t[0]], &b = mesh.vertices_m[t[1]], &c = mesh.vertices_m[t[2]];
    volume += 0.5 * (b - a).cross(c - a).z() * (a.z() + b.z() + c.z()) / 3;
  }
  return volume;
}

TEST(Solids, AreClosedAndFaceOutwardsAtEveryTessellation) {
  for (const int segments : {12, 13, 48, 101}) {
    for (const Named& solid : all_solids(segments)) {
      EXPECT_EQ(fault_of_closed_mesh(solid.mesh), "") << solid.name << " " << segments;
      EXPECT_GT(volume_by_flux(solid.mesh), 0.0) << solid.name;
    }
  }
}

TEST(Solids, HaveTheVolumeOfTheTrueSolidAtEveryTessellation) {
  for (const int segments : {12, 13, 48, 101}) {
    for (const Named& solid : all_solids(segments)) {
      EXPECT_NEAR(moments_of(solid.mesh).volume_m3 / solid.volume_m3, 1.0, 1e-12) << solid.name;
      EXPECT_NEAR(volume_by_flux(solid.mesh) / solid.volume_m3, 1.0, 1e-12) << solid.name;
    }
  }
}

Eigen::AlignedBox3d outline(const Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vec3& vertex : mesh.vertices_m) box.extend(vertex);
  return box;
}

TEST(Solids, KeepTheirOutline) {
  const Vec3 box_m(0.3, 0.2, 0.1), plate_m(0.5, 0.3, 0.02);
  EXPECT_NEAR((outline(box_solid(box_m)).sizes() - box_m).norm(), 0, 1e-15);
  EXPECT_NEAR((outline(box_with_hole_solid(plate_m, 0.1, 48)).sizes() - plate_m).norm(), 0, 1e-15);
  EXPECT_NEAR(outline(ball_solid(0.2, -0.2, 0.05, 48)).max().z(), 0.05, 1e-15);
  EXPECT_NEAR(outline(shell_solid(0.2, 0.01, 0.1, 48)).max().z(), 0.1, 1e-15);
  EXPECT_NEAR(outline(dish_solid(0.4, 0.3, 0.01, 48)).max().z(), 0.16 / 1.2, 1e-15);
  // Polygons of equal area stick out of their circles by less than half a percent at 48 corners.
  EXPECT_LT(outline(ball_solid(0.2, -0.2, 0.2, 48)).max().x(), 0.2 * 1.005);
}

MassProperties at_rest(const Mesh& mesh, double mass_kg) {
  return mass_properties(moments_of(mesh), mass_kg, {});
}

void expect_inertia(const MassProperties& found, const Vec3& principal, double relative) {
  Mat3 off_diagonal = found.inertia_kg_m2;
  off_diagonal.diagonal().setZero();
  EXPECT_LT(off_diagonal.norm(), 1e-9 * principal.norm());
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(found.inertia_kg_m2(i, i) / principal[i], 1.0, relative) << "axis " << i;
  }
}

TEST(SolidInertia, OfABox) {
  const double m = 3, a = 0.3, b = 0.2, c = 0.1;
  expect_inertia(at_rest(box_solid({a, b, c}), m),
                 m / 12 * Vec3(b * b + c * c, a * a + c * c, a * a + b * b), 1e-13);
}

TEST(SolidInertia, OfABoxWithAHole) {
  const double a = 0.5, b = 0.3, h = 0.02, r = 0.1, density = 1000;
  const double box_kg = density * a * b * h, hole_kg = density * pi * r * r * h;
  const Vec3 box = box_kg / 12 * Vec3(b * b + h * h, a * a + h * h, a * a + b * b);
  const double across = 3 * r * r + h * h;
  const Vec3 hole = hole_kg / 12 * Vec3(across, across, 6 * r * r);
  expect_inertia(at_rest(box_with_hole_solid({a, b, h}, r, fine), box_kg - hole_kg), box - hole,
                 1e-6);
}

TEST(SolidInertia, OfATube) {
  const double m = 2, r = 0.1, q = 0.06, h = 0.4;
  const double across = m / 12 * (3 * (r * r + q * q) + h * h), along = m / 2 * (r * r + q * q);
  expect_inertia(at_rest(cylinder_solid(r, r, h, q, fine), m), {across, across, along}, 1e-8);
}

TEST(SolidInertia, OfACone) {
  const double m = 2, r = 0.2, h = 0.3;
  const MassProperties cone = at_rest(cylinder_solid(r, 0, h, 0, fine), m);
  EXPECT_NEAR(cone.centre_m.z(), -h / 4, 1e-12);  // a quarter of the height above the base
  EXPECT_NEAR(cone.inertia_kg_m2(2, 2) / (0.3 * m * r * r), 1.0, 1e-8);
}

TEST(SolidInertia, OfABallAndAShell) {
  const double m = 2, r = 0.2;
  const double ball = 0.4 * m * r * r;
  expect_inertia(at_rest(ball_solid(r, -r, r, fine), m), {ball, ball, ball}, 1e-4);
  // Half a ball: its centre lies 3/8 of the radius from the cut.
  EXPECT_NEAR(at_rest(ball_solid(r, -r, 0, fine), m).centre_m.z() / (-0.375 * r), 1.0, 1e-4);
  // A thin shell cut through the middle: half the radius.
  EXPECT_NEAR(at_rest(shell_solid(r, 1e-4 * r, 0, fine), m).centre_m.z() / (-0.5 * r), 1.0, 2e-4);
}

TEST(SolidInertia, OfADish) {
  // A sheet of constant thickness along z over the disc: ∫ r² dm = m R²/2, height of the centre
  // R²/(8 f) for its middle surface.
  const double m = 2.5, R = 0.4, f = 0.32, t = 0.01;
  const MassProperties dish = at_rest(dish_solid(R, f, t, fine), m);
  EXPECT_NEAR(dish.inertia_kg_m2(2, 2) / (m * R * R / 2), 1.0, 1e-4);
  EXPECT_NEAR(dish.centre_m.z() / (R * R / (8 * f) - t / 2), 1.0, 1e-4);
}

TEST(MassProperties, OfAPlacedPartFollowSteinersTheorem) {
  const double m = 3, a = 0.3, b = 0.2, c = 0.1;
  const Vec3 at_m(0.4, -0.7, 0.2);
  // A quarter turn about z swaps x and y.
  const RigidTransform placed{Quat(Eigen::AngleAxisd(pi / 2, Vec3::UnitZ())), at_m};
  const MassProperties found = mass_properties(moments_of(box_solid({a, b, c})), m, placed);
  const Vec3 principal = m / 12 * Vec3(a * a + c * c, b * b + c * c, a * a + b * b);
  const Mat3 steiner = m * (at_m.squaredNorm() * Mat3::Identity() - at_m * at_m.transpose());
  EXPECT_NEAR((found.centre_m - at_m).norm(), 0, 1e-14);
  EXPECT_LT((found.inertia_kg_m2 - Mat3(principal.asDiagonal()) - steiner).norm(), 1e-13);
}

PlatformModel platform_of(const std::string& text) {
  return generate_platform(Settings(std::make_shared<const SettingsNode>(parse_toml(text, "p"))));
}

const std::string head =
    "title = \"t\"\ntopology = \"tabletop\"\nsegments = 512\n"
    "[[material]]\nname = \"m\"\nbase_colour = [1, 1, 1]\ndensity_kg_m3 = 2700\n";

// A plate with four posts at its corners and a rod through the side, by the closed forms of boxes
// and cylinders and Steiner's theorem.
TEST(Generator, AssemblyAgreesWithClosedForms) {
  const PlatformModel platform = platform_of(
      head +
      "[[part]]\nnode = \"p/plate\"\nshape = \"box\"\nsize_m = [0.4, 0.2, 0.01]\n"
      "position_m = [0, 0, 0.05]\nmaterial = \"m\"\n"
      "[[part]]\nnode = \"p/post\"\nshape = \"cylinder\"\nradius_m = 0.01\nheight_m = 0.1\n"
      "position_m = [0.1, 0, -0.02]\ncopies_deg = [45, 135, 225, 315]\nmass_kg = 0.5\n"
      "material = \"m\"\n"
      "[[part]]\nnode = \"p/rod\"\nshape = \"cylinder\"\nradius_m = 0.02\nheight_m = 0.3\n"
      "axis = [1, 0, 0]\nposition_m = [0.2, 0, 0]\nmass_kg = 1\nmaterial = \"m\"\n");
  const double plate = 2700 * 0.4 * 0.2 * 0.01, post = 0.5, rod = 1.0;
  const double post_across = post / 12 * (3 * 1e-4 + 0.01), post_along = post / 2 * 1e-4;
  const double rod_across = rod / 12 * (3 * 4e-4 + 0.09), rod_along = rod / 2 * 4e-4;
  const double mass = plate + 4 * post + rod;
  EXPECT_NEAR(platform.mass.mass_kg, mass, 1e-12);
  EXPECT_NEAR(platform.mass.centre_m.x(), rod * 0.2 / mass, 1e-12);
  EXPECT_NEAR(platform.mass.centre_m.y(), 0, 1e-12);
  EXPECT_NEAR(platform.mass.centre_m.z(), (plate * 0.05 - 4 * post * 0.02) / mass, 1e-12);
  // A post stands at (±0.0707, ±0.0707): 0.005 m² from either axis, 0.01 m² from z.
  const double x = plate / 12 * (0.04 + 1e-4) + plate * 0.0025 +
                   4 * (post_across + post * (0.005 + 4e-4)) + rod_along;
  const double y = plate / 12 * (0.16 + 1e-4) + plate * 0.0025 +
                   4 * (post_across + post * (0.005 + 4e-4)) + rod_across + rod * 0.04;
  const double z =
      plate / 12 * (0.16 + 0.04) + 4 * (post_along + post * 0.01) + rod_across + rod * 0.04;
  expect_inertia(platform.mass, {x, y, z}, 1e-8);
}

TEST(Generator, RefusesWhatMakesNoPlatform) {
  const std::string part = "[[part]]\nnode = \"a/b\"\nmaterial = \"m\"\n";
  const auto message = [](const std::string& text) {
    try {
      platform_of(text);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  const std::pair<std::string, std::string> cases[] = {
      {"", "p:1: title: found nothing, expected a text in quotes"},
      {"title = \"t\"\ntopology = \"tabeltop\"\n", "did you mean \"tabletop\"?"},
      {head, "p:1: part: found nothing, expected at least one [[part]]"},
      {head + part + "shape = \"bux\"\n", "did you mean \"box\"?"},
      {head + part + "shape = \"box\"\nsize_m = [1, 0, 1]\n",
       "p:12: part[0].size_m: found a length"},
      {head + part + "shape = \"box\"\nsize_m = [1, 1, 1]\nhole_radius_m = 0.5\n",
       "p:13: part[0].hole_radius_m: found 0.5, expected a number in (0, 0.49]"},
      {head + part + "shape = \"cylinder\"\nradius_m = 1\nheight_m = 1\ninner_radius_m = 1\n",
       "part[0].inner_radius_m: found 1, expected a number in [0, 1)"},
      {head + part + "shape = \"ball\"\nradius_m = 1\nlow_m = 0.5\nhigh_m = 0.5\n",
       "part[0].high_m: found 0.5"},
      {head + part + "shape = \"shell\"\nradius_m = 1\nthickness_m = 0.1\nhigh_m = 0.95\n",
       "part[0].high_m: found 0.95, expected a number in (-0.9, 0.9)"},
      {head + part + "shape = \"ball\"\nradius_m = 1\nmass_kg = 0\n", "part[0].mass_kg: found 0"},
      {head + part + "shape = \"ball\"\nradius_m = 1\naxis = [0, 0, 0]\n", "part[0].axis"},
      {head + part + "shape = \"ball\"\nradius_m = 1\nradios_m = 2\n", "perhaps \"radius_m\""},
      {head + part + "shape = \"ball\"\nradius_m = 1\n" + part + "shape = \"ball\"\nradius_m = 1\n",
       "found a second a/b"},
      {head + part +
           "shape = \"ball\"\nradius_m = 1\n[[part]]\nnode = \"a\"\nmaterial = \"m\"\n"
           "shape = \"ball\"\nradius_m = 1\n",
       "expected parents first"},
      {"title = \"t\"\ntopology = \"free\"\n[[material]]\nname = \"m\"\nbase_colour = [1, 1, 1]\n" +
           part + "shape = \"ball\"\nradius_m = 1\n",
       "found nothing, expected mass_kg, or density_kg_m3 of its material"},
      {"title = \"t\"\ntopology = \"free\"\n[[material]]\nname = \"m\"\nbase_colour = [1, 1, 2]\n",
       "p:5: material[0].base_colour"},
  };
  for (const auto& [text, expected] : cases) {
    EXPECT_NE(message(text).find(expected), std::string::npos) << message(text) << "\n" << expected;
  }
}

}  // namespace
}  // namespace photorque
