// Force, torque and power of simple bodies against exact results. Light of irradiance 1·c W/m²,
// i.e. pressure 1 Pa, so that forces read as areas [m²].
//
// Every check is two-sided: the estimate lies within 3 standard errors and 1e-4 of the truth, and
// the law that a plausible mistake would give lies outside.
#include <gtest/gtest.h>

#include <numbers>

#include "tests/raytrace/test_scenes.h"

namespace photorque {
namespace {

using fixtures::add;
using fixtures::ParallelBeam;

struct Outcome {
  std::array<Estimate, 3> force, torque;  // per unit pressure: m², m³
  PowerBalance power_balance;
};

// Uniform parallel light of pressure 1 Pa along `direction`, wide enough for the whole scene.
Outcome illuminate(Scene scene, const Vec3& direction, uint64_t rays = 1 << 20, uint64_t seed = 1) {
  const double radius = scene.radius_m() * 1.01;
  const TraceableScene traceable(std::move(scene));
  const double side = 2 * radius;
  const auto emitter = std::make_shared<ParallelBeam>(speed_of_light_m_s * side * side, side);
  const Beam beam = fixtures::beam(emitter, -10 * radius * direction.normalized(), direction);
  const fixtures::TotalWrench wrench;
  const Receiver* const receivers[] = {&wrench};
  const TraceResult result =
      trace(traceable, {}, std::span(&beam, 1), receivers,
            {.rays = rays, .seed = seed, .max_depth = 2000, .cutoff = 1e-14});
  Outcome outcome{{}, {}, result.power_balance};
  for (size_t k = 0; k < 3; ++k) {
    outcome.force[k] = result.sums[0].estimate(k);
    outcome.torque[k] = result.sums[0].estimate(3 + k);
    // The momentum by another route: the loss of the rays.
    const Estimate& by_rays = result.power_balance.force_N[k];
    EXPECT_NEAR(outcome.force[k].value, by_rays.value,
                4 * std::hypot(by_rays.standard_error, outcome.force[k].standard_error) +
                    1e-6 * side * side);
  }
  return outcome;
}

bool within(const Estimate& estimate, double truth, double scale) {
  // Rounding of rays to single precision is a further 1e-7 of the scale.
  const double error = std::abs(estimate.value - truth);
  return error <= 3 * estimate.standard_error + 2e-7 * scale && error <= 1e-4 * scale;
}

void expect_vector(const std::array<Estimate, 3>& estimate, const Vec3& truth, double scale) {
  for (int k = 0; k < 3; ++k) {
    const Estimate& e = estimate[static_cast<size_t>(k)];
    EXPECT_TRUE(within(e, truth[k], scale)) << "component " << k << ": " << e.value << " ± "
                                            << e.standard_error << ", exact " << truth[k];
  }
}

// A 2 m × 1 m plate whose normal leans by `tilt` from +z towards +x.
Scene tilted_plate(double tilt, const OpticalSurface& surface) {
  return fixtures::scene_of_part(
      fixtures::rectangle(Vec3::Zero(), Vec3(2 * std::cos(tilt), 0, -2 * std::sin(tilt)),
                          Vec3(0, 1, 0)),
      surface, "plate");
}

class FlatPlate : public ::testing::TestWithParam<int> {};

// F = A cosθ [ (1−ρs) d − 2 (ρs cosθ + ρd/3) n ], d along the light, n towards it: the law of flat
// plates (e.g. F. L. Markley and J. L. Crassidis, Fundamentals of Spacecraft Attitude Determination
// and Control, eq. 3.167).
TEST_P(FlatPlate, AbsorbingMirrorAndLambertianForceAtAnyTilt) {
  const double tilt = GetParam() * degree_rad, area = 2.0;
  const Vec3 d(0, 0, -1), n(std::sin(tilt), 0, std::cos(tilt));
  for (const auto& [specular, diffuse] :
       {std::pair{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}, {0.3, 0.5}}) {
    const Outcome got = illuminate(tilted_plate(tilt, grey_surface("s", specular, diffuse)), d);
    const double c = std::cos(tilt);
    const Vec3 exact = area * c * ((1 - specular) * d - 2 * (specular * c + diffuse / 3) * n);
    expect_vector(got.force, exact, area);
    expect_vector(got.torque, Vec3::Zero(), area);
    if (GetParam() > 0) {  // the mistake of physics.md: the cosine twice
      EXPECT_FALSE(within(got.force[2], exact.z() * c, area));
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Tilts, FlatPlate, ::testing::Values(0, 15, 30, 60, 80));

// Sphere of radius R: F = π R² (1 + 4/9 ρd), the specular part adds nothing. The mesh is a
// polyhedron of 400,000 facets; its own specular force, zero for a sphere, is 1e-5 of P π R².
TEST(Sphere, ForceIsDiscTimesOnePlusFourNinthsDiffuse) {
  const int rings = 320;
  // Area of the shadow: a regular polygon of 2·rings corners with the equator's vertices.
  const double shadow = rings * std::sin(pi / rings);
  for (const auto& [specular, diffuse] :
       {std::pair{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}, {0.4, 0.4}}) {
    const Outcome got =
        illuminate(fixtures::scene_of_part(fixtures::sphere(1.0, rings),
                                           grey_surface("s", specular, diffuse), "sphere"),
                   Vec3(0, 0, -1), 1 << 20);
    const double exact = -shadow * (1 + 4.0 / 9.0 * diffuse);
    expect_vector(got.force, Vec3(0, 0, exact), pi);
    if (diffuse > 0.0) {  // as if it were a flat plate
      EXPECT_FALSE(within(got.force[2], -shadow * (1 + 2.0 / 3.0 * diffuse), pi));
    }
  }
}

// A 90 deg dihedral of perfect mirrors a × b each, light along the bisector: every ray goes back,
// so F = 2 √2 a b; a code of one bounce gets half.
TEST(Dihedral, ReturnsAllMomentum) {
  const double a = 1.0, b = 0.7, h = a / std::numbers::sqrt2;
  Scene scene;
  const auto mirror = grey_surface("mirror", 1, 0);
  add(scene, fixtures::rectangle(Vec3(h / 2, 0, h / 2), Vec3(h, 0, h), Vec3(0, b, 0)), mirror,
      "right");
  add(scene, fixtures::rectangle(Vec3(-h / 2, 0, h / 2), Vec3(h, 0, -h), Vec3(0, b, 0)), mirror,
      "left");
  const Outcome got = illuminate(std::move(scene), Vec3(0, 0, -1));
  const double exact = -2 * std::numbers::sqrt2 * a * b;
  expect_vector(got.force, Vec3(0, 0, exact), a * b);
  EXPECT_FALSE(within(got.force[2], exact / 2, a * b));
}

// Corner cube of three unit mirrors: inside the aperture that sees all three, F = 2 P A along the
// light in any direction (here 5 deg off the diagonal).
TEST(CornerCube, ReturnsLightAlongItself) {
  Scene scene;
  const auto mirror = grey_surface("mirror", 1, 0);
  const Vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  add(scene, fixtures::rectangle((x + y) / 2, x, y), mirror, "floor");
  add(scene, fixtures::rectangle((y + z) / 2, y, z), mirror, "wall_x");
  add(scene, fixtures::rectangle((z + x) / 2, z, x), mirror, "wall_y");
  const TraceableScene traceable(std::move(scene));
  const Vec3 d = Eigen::AngleAxisd(5 * degree_rad, Vec3(1, -1, 0).normalized()) *
                 Vec3(-1, -1, -1).normalized();
  // A disc of 0.1 m about the ray that meets the corner's neighbourhood: all of it retro-reflects.
  const double power = 1.0;
  const auto emitter = std::make_shared<ParallelBeam>(power, 0.1, ParallelBeam::Shape::disc);
  const Beam beam = fixtures::beam(emitter, Vec3(0.3, 0.3, 0.3) - 3 * d, d);
  const TraceResult result = trace(traceable, {}, std::span(&beam, 1), {}, {.rays = 1 << 18});
  const Vec3 exact = 2 * power / speed_of_light_m_s * d;
  expect_vector(result.power_balance.force_N, exact, power / speed_of_light_m_s);
  EXPECT_NEAR(result.power_balance.escaped_W.value, power, 1e-9);
}

// L-shape: a wall of unit height beside a unit floor, light (−sin t, 0, −cos t): the lit fraction
// of the floor is 1 − tan t, and the torque uses the centroid of the lit strip, (1 + tan t)/2.
TEST(SelfShadowing, LitFractionAndCentroidOfTheFloor) {
  for (const double t : {pi / 50, pi / 20, pi / 10, pi / 8, pi / 6}) {
    Scene scene;
    const auto black = grey_surface("black", 0, 0);
    const uint32_t floor = add(
        scene, fixtures::rectangle(Vec3(-0.5, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)), black, "floor");
    add(scene, fixtures::rectangle(Vec3(0, 0, 0.5), Vec3(0, 1, 0), Vec3(0, 0, 1)), black, "wall");
    const Vec3 d(-std::sin(t), 0, -std::cos(t));
    const Outcome got = illuminate(std::move(scene), d, 1 << 22);
    const double scale = 1.0, lit = 1 - std::tan(t);
    const Estimate power = got.power_balance.absorbed_by_instance_W[floor];
    const Estimate fraction{power.value / speed_of_light_m_s / std::cos(t),
                            power.standard_error / speed_of_light_m_s / std::cos(t)};
    EXPECT_TRUE(within(fraction, lit, scale))
        << fraction.value << " ± " << fraction.standard_error << " exact " << lit;
    EXPECT_FALSE(within(fraction, 1.0, scale));
    // Torque about y: the floor's lit strip and the whole wall, each pushed at its centroid.
    const Vec3 floor_force = lit * std::cos(t) * d, wall_force = std::sin(t) * d;
    const Vec3 torque =
        Vec3(-(1 + std::tan(t)) / 2, 0, 0).cross(floor_force) + Vec3(0, 0, 0.5).cross(wall_force);
    expect_vector(got.torque, torque, scale);
  }
}

// A spherical cavity with Lambertian walls of reflectance ρ and a small mouth: wall fraction f, the
// light that enters along the axis leaves with ρ_eff = ρ (1−f') / (1 − ρ f'), f' the fraction of
// the sphere that is wall seen from any wall point (exact for a sphere: view factors are area
// ratios).
TEST(LambertianCavity, EffectiveReflectance) {
  const int rings = 96, open_rings = 24;  // the mouth: polar angle below 45 deg
  Mesh wall = fixtures::sphere(1.0, rings);
  const double mouth_z = std::cos(pi * open_rings / rings);
  std::erase_if(wall.triangles, [&](const auto& t) {
    double z = 0;
    for (const uint32_t v : t) z += wall.vertices_m[v].z() / 3;
    return z > mouth_z;
  });
  for (const double reflectance : {0.3, 0.9}) {
    const TraceableScene traceable(
        fixtures::scene_of_part(wall, grey_surface("wall", 0, reflectance), "wall"));
    const auto emitter = std::make_shared<ParallelBeam>(1.0, 0.3, ParallelBeam::Shape::disc);
    const Beam beam = fixtures::beam(emitter, Vec3(0, 0, 5), Vec3(0, 0, -1));
    const TraceResult result = trace(traceable, {}, std::span(&beam, 1), {},
                                     {.rays = 1 << 17, .max_depth = 1000, .cutoff = 1e-12});
    const double f = (1 + mouth_z) / 2;  // wall fraction of the sphere
    const double exact = reflectance * (1 - f) / (1 - reflectance * f);
    const Estimate escaped = result.power_balance.escaped_W;
    // The polyhedron of 96 rings shifts view factors by about (π/96)²/4 = 3e-4 of the mouth's.
    EXPECT_NEAR(escaped.value, exact, 3 * escaped.standard_error + 3e-4 * exact);
    EXPECT_GT(std::abs(escaped.value - reflectance * (1 - f)),
              10 * escaped.standard_error);  // one bounce only
  }
}

// Irradiance of a small source falls with the square of the distance: a square of side s at height
// h above a point source that radiates evenly into a cone catches its solid angle, Ω = 4
// asin(s²/(s² + 4h²)) (e.g. A. Khadjavi, J. Opt. Soc. Am. 58, 1417, 1968).
class EvenCone final : public Emitter {
 public:
  explicit EvenCone(double half_angle_rad) : low_(std::cos(half_angle_rad)) {}
  double power_W() const override { return 1.0; }
  void emit(const SampleBlock& samples, RayBlock& rays) const override {
    for (int i = 0; i < ray_block; ++i) {
      const double z = 1 - (1 - low_) * sobol_fraction(samples.bits[2][i]);
      const double phi = 2 * pi * sobol_fraction(samples.bits[3][i]);
      const double across = std::sqrt(1 - z * z);
      fixtures::set_ray(rays, i, Vec3::Zero(), {across * std::cos(phi), across * std::sin(phi), z});
    }
  }
  double relative_intensity(double a) const override { return std::cos(a) >= low_ ? 1.0 : 0.0; }

 private:
  double low_;
};

TEST(PointSource, SquareCatchesItsSolidAngle) {
  const double side = 0.5;
  for (const double height : {1.0, 2.0, 4.0}) {
    const double half_angle = 1.1 * std::atan(side / std::numbers::sqrt2 / height);
    const TraceableScene traceable(fixtures::scene_of_part(
        fixtures::rectangle(Vec3::Zero(), Vec3(side, 0, 0), Vec3(0, side, 0)),
        grey_surface("black", 0, 0), "square"));
    const Beam beam =
        fixtures::beam(std::make_shared<EvenCone>(half_angle), Vec3(0, 0, height), Vec3(0, 0, -1));
    const TraceResult result = trace(traceable, {}, std::span(&beam, 1), {}, {.rays = 1 << 22});
    const double solid_angle = 4 * std::asin(side * side / (side * side + 4 * height * height));
    const double exact = solid_angle / (2 * pi * (1 - std::cos(half_angle)));
    EXPECT_TRUE(within(result.power_balance.absorbed_W, exact, exact))
        << result.power_balance.absorbed_W.value << " ± "
        << result.power_balance.absorbed_W.standard_error << " exact " << exact;
    EXPECT_FALSE(within(result.power_balance.absorbed_W,
                        side * side / (height * height) / (2 * pi * (1 - std::cos(half_angle))),
                        exact));
  }
}

// Cube 2 × 2 × 2 m, the validation cases of PyRASE, F/P in m².
TEST(Cube, PyraseValidationCases) {
  const auto cube = [](double specular, double diffuse) {
    return fixtures::scene_of_part(fixtures::box(Vec3(-1, -1, -1), Vec3(1, 1, 1)),
                                   grey_surface("s", specular, diffuse), "cube");
  };
  expect_vector(illuminate(cube(0, 0.8), Vec3(-1, 0, 0)).force, Vec3(-6.1333333333, 0, 0), 4);
  expect_vector(illuminate(cube(0.8, 0), Vec3(-1, 0, 0)).force, Vec3(-7.2, 0, 0), 4);
  expect_vector(illuminate(cube(0.4, 0.4), Vec3(-1, -1, 0)).force,
                Vec3(-4.75424723, -4.75424723, 0), 4);
}

// A closed black body in light from all sides feels nothing; here: six directions that balance.
TEST(Cube, OpposingLightBalances) {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < 3; ++k) {
    for (const double sign : {-1.0, 1.0}) {
      const Outcome got =
          illuminate(fixtures::scene_of_part(fixtures::box(Vec3(-1, -0.5, -0.2), Vec3(1, 0.5, 0.2)),
                                             grey_surface("s", 0.2, 0.3), "box"),
                     sign * Vec3::Unit(k), 1 << 20);
      for (int j = 0; j < 3; ++j) sum[j] += got.force[static_cast<size_t>(j)].value;
    }
  }
  EXPECT_LT(sum.norm(), 2e-4);
}

}  // namespace
}  // namespace photorque
