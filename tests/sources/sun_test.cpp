#include "core/constants.h"
#include "sampling.h"
#include "sources/profiles/beam_shape.h"

namespace photorque {
namespace {

using test::changed;
using test::make_beams;
using test::vector_node;

constexpr double scene_radius_m = 0.5;

Beam sun(double angular_radius_deg, double irradiance_W_m2 = 1000.0) {
  return make_beams("sun",
                    {{"direction", vector_node(0.3, 0.1, -1.0)},
                     {"irradiance_W_m2", {irradiance_W_m2}},
                     {"angular_radius_deg", {angular_radius_deg}}},
                    {.scene_radius_m = scene_radius_m})
      .at(0);
}

// Power [W] through a disc in the lab from its front (rays against `normal`).
double power_through(const Beam& beam, const Vec3& centre_m, const Vec3& normal, double radius_m) {
  constexpr uint32_t count = 1u << 18;
  double hits = 0.0;
  for (const auto& ray : test::rays_of(*beam.emitter, count)) {
    const Vec3 origin_m = beam.lab_from_emitter.point(ray.origin_m);
    const Vec3 direction = beam.lab_from_emitter.direction(ray.direction);
    const double against = -direction.dot(normal);
    if (against <= 0.0) continue;
    const double distance_m = (origin_m - centre_m).dot(normal) / against;
    if (distance_m <= 0.0) continue;
    if ((origin_m + distance_m * direction - centre_m).norm() <= radius_m) hits += 1.0;
  }
  return beam.emitter->power_W() * hits / count;
}

// A fraction p of n points has the standard error √(p(1 − p)/n) if they were random; Sobol points
// do better.
TEST(Sun, IrradianceOnAPlaneNormalToTheAxisIsAsStated) {
  const double disc_m = 0.2;
  for (const double radius_deg : {0.0, 0.2665, 10.0, 40.0}) {
    const Beam beam = sun(radius_deg);
    const Vec3 normal = -beam.lab_from_emitter.direction(Vec3::UnitZ());
    const double power_W = power_through(beam, Vec3::Zero(), normal, disc_m);
    EXPECT_NEAR(power_W / (1000.0 * pi * disc_m * disc_m), 1.0, 2e-3) << radius_deg;
  }
}

TEST(Sun, IrradianceFollowsTheCosineOfAnObliquePlane) {
  const double disc_m = 0.2;
  const Beam beam = sun(20.0);
  const Vec3 axis = beam.lab_from_emitter.direction(Vec3::UnitZ());
  const Vec3 side = axis.unitOrthogonal();
  for (const double tilt_deg : {20.0, 45.0, 65.0}) {
    const double tilt = tilt_deg * degree_rad;
    const Vec3 normal = -axis * std::cos(tilt) + side * std::sin(tilt);
    EXPECT_NEAR(power_through(beam, Vec3::Zero(), normal, disc_m) / (1000.0 * pi * disc_m * disc_m),
                std::cos(tilt), 3e-3)
        << tilt_deg;
  }
}

TEST(Sun, LightsTheWholeSphereOfTheSceneEvenly) {
  const double disc_m = 0.05;
  for (const double radius_deg : {0.2665, 30.0}) {
    const Beam beam = sun(radius_deg);
    const Vec3 axis = beam.lab_from_emitter.direction(Vec3::UnitZ());
    const Vec3 side = axis.unitOrthogonal();
    const double reach_m = 0.99 * scene_radius_m - disc_m;
    for (const Vec3& towards : {axis, Vec3(-axis), side, Vec3(-side), Vec3(axis.cross(side))}) {
      const double power_W = power_through(beam, reach_m * towards, -axis, disc_m);
      EXPECT_NEAR(power_W / (1000.0 * pi * disc_m * disc_m), 1.0, 0.02) << radius_deg;
    }
  }
}

TEST(Sun, RaysStartOutsideTheScene) {
  for (const double radius_deg : {0.0, 0.2665, 45.0}) {
    const Beam beam = sun(radius_deg);
    for (const auto& ray : test::rays_of(*beam.emitter, 4096)) {
      EXPECT_GE(beam.lab_from_emitter.point(ray.origin_m).norm(), scene_radius_m);
    }
  }
}

// Radiance is conserved: L = E/(π sin²α) from every direction of the disc, so that the power of all
// rays over the sphere's cross-section is L times the solid angle 2π(1 − cos α).
TEST(Sun, EtendueIsCrossSectionTimesSolidAngle) {
  const double alpha = 25.0 * degree_rad;
  const Beam beam = sun(25.0);
  const double solid_angle_sr = EncircledFlux(*beam.emitter).solid_angle_sr();
  EXPECT_NEAR(solid_angle_sr, 2.0 * pi * (1.0 - std::cos(alpha)), 1e-9);
  const double radiance = 1000.0 / (pi * std::pow(std::sin(alpha), 2));
  const double lit_radius_m = 1.001 * scene_radius_m;  // the margin that sun.cpp states
  EXPECT_NEAR(
      beam.emitter->power_W() / (radiance * solid_angle_sr * pi * lit_radius_m * lit_radius_m), 1.0,
      1e-9);
}

TEST(Sun, DefaultsAreTheSunAtOneAstronomicalUnit) {
  const Beam beam = make_beams("sun", {{"direction", vector_node(0, 0, -1)}}).at(0);
  const double alpha = solar_angular_radius_rad;
  EXPECT_NEAR(beam.emitter->power_W(),
              1361.0 * pi * 1.001 * 1.001 / std::pow(std::cos(0.5 * alpha), 2), 1e-9);
  EXPECT_NEAR(describe(*beam.emitter).fwhm_rad, 0.533 * degree_rad, 1e-3 * degree_rad);
  EXPECT_EQ(beam.spectrum.shape, Spectrum::Shape::blackbody);
  EXPECT_DOUBLE_EQ(beam.spectrum.temperature_K, 5772.0);
}

TEST(Sun, ShinesWithTheStandardThatIsNamed) {
  const SettingsNode down = vector_node(0, 0, -1);
  const auto irradiance_W_m2 = [](const Beam& beam) {
    return beam.aperture->exitance_W_m2 * std::pow(std::cos(0.5 * solar_angular_radius_rad), 2);
  };
  const Beam space = make_beams("sun", {{"direction", down}, {"spectrum", {"AM0"}}}).at(0);
  EXPECT_EQ(space.spectrum.shape, Spectrum::Shape::am0);
  EXPECT_NEAR(irradiance_W_m2(space), 1361.0, 1e-9);
  const Beam ground = make_beams("sun", {{"direction", down}, {"spectrum", {"AM1.5G"}}}).at(0);
  EXPECT_EQ(ground.spectrum.shape, Spectrum::Shape::am15g);
  EXPECT_NEAR(irradiance_W_m2(ground), 1000.0, 1e-9);
  // A named spectrum has no temperature: the key is not read.
  EXPECT_THROW(
      make_beams("sun", {{"direction", down}, {"spectrum", {"AM0"}}, {"temperature_K", {5800.0}}}),
      InputError);
}

TEST(Sun, CollimatedRaysAreParallel) {
  for (const auto& ray : test::rays_of(*sun(0.0).emitter, 1024)) {
    EXPECT_EQ(ray.direction, Vec3::UnitZ());
  }
}

Beam darkened_sun(double angular_radius_deg, double u1, double u2) {
  return make_beams("sun",
                    {{"direction", vector_node(0, 0, -1)},
                     {"irradiance_W_m2", {1000.0}},
                     {"angular_radius_deg", {angular_radius_deg}},
                     {"limb_darkening", {SettingsNode::Array{{u1}, {u2}}}}},
                    {.scene_radius_m = scene_radius_m})
      .at(0);
}

TEST(LimbDarkening, KeepsTheIrradianceAndDimsTheEdge) {
  const double disc_m = 0.2;
  for (const double radius_deg : {0.2665, 20.0}) {
    const Beam beam = darkened_sun(radius_deg, 0.47, 0.23);
    const double power_W = power_through(beam, Vec3::Zero(), Vec3::UnitZ(), disc_m);
    EXPECT_NEAR(power_W / (1000.0 * pi * disc_m * disc_m), 1.0, 2e-3) << radius_deg;
    EXPECT_NEAR(beam.emitter->relative_intensity(radius_deg * degree_rad * (1 - 1e-12)), 0.3, 1e-4);
    EXPECT_EQ(beam.emitter->relative_intensity(0.0), 1.0);
    EXPECT_EQ(beam.emitter->relative_intensity(1.001 * radius_deg * degree_rad), 0.0);
  }
}

// Behind a straight edge a point sees the part of the disc beyond a chord at x radii from the
// middle. With L = c₀ + c₁ μ + c₂ μ² and s² = 1 − x² a chord sends 2 c₀ s + ½π c₁ s² + 4/3 c₂ s³
// and the whole disc π (c₀ + ⅔ c₁ + ½ c₂) (small angles).
TEST(LimbDarkening, PenumbraOfAStraightEdge) {
  const double u1 = 0.47, u2 = 0.23, c0 = 1 - u1 - u2, c1 = u1 + 2 * u2, c2 = -u2;
  const Beam beam = darkened_sun(0.2665, u1, u2);
  constexpr uint32_t count = 1u << 18;
  const auto rays = test::rays_of(*beam.emitter, count);
  const double radius = std::sin(0.2665 * degree_rad);
  const auto seen = [](double x, const auto& chord) {  // substitution x = sin φ, midpoints
    double sum = 0.0;
    const double from = -0.5 * pi, to = std::asin(x);
    for (int i = 0; i < 2000; ++i) {
      const double cosine = std::cos(from + (to - from) * (i + 0.5) / 2000);
      sum += chord(cosine) * cosine * (to - from) / 2000;
    }
    return sum;
  };
  double largest = 0.0;
  for (const double x : {-0.95, -0.8, -0.4, 0.0, 0.3, 0.7, 0.9}) {
    const double lit = static_cast<double>(std::count_if(
                           rays.begin(), rays.end(),
                           [&](const auto& ray) { return ray.direction.x() < x * radius; })) /
                       count;
    const double exact =
        seen(x,
             [&](double s) {
               return 2 * c0 * s + 0.5 * pi * c1 * s * s + 4.0 / 3 * c2 * s * s * s;
             }) /
        (pi * (c0 + 2.0 / 3 * c1 + 0.5 * c2));
    const double even = seen(x, [](double s) { return 2 * s; }) / pi;
    EXPECT_NEAR(lit, exact, 1e-3) << x;
    largest = std::max(largest, std::abs(exact - even));
  }
  EXPECT_GT(largest, 0.01);  // a disc of even radiance would have been found out
}

TEST(LimbDarkening, NoneIsTheEvenDiscAndNonsenseIsRefused) {
  const Beam even = sun(10.0);
  const Beam none = darkened_sun(10.0, 0.0, 0.0);
  EXPECT_NEAR(none.emitter->power_W() / even.emitter->power_W(), 1.0, 1e-6);
  EXPECT_NEAR(describe(*none.emitter).fwhm_rad, describe(*even.emitter).fwhm_rad, 1e-9);
  EXPECT_THROW(darkened_sun(0.2665, 0.8, 0.3), InputError);
  EXPECT_THROW(darkened_sun(0.2665, -0.1, 0.3), InputError);
  EXPECT_THROW(darkened_sun(0.0, 0.4, 0.3), InputError);
}

TEST(Sun, ReportsTheMistake) {
  const SettingsNode::Table table = {{"direction", vector_node(0, 0, -1)}};
  EXPECT_THROW(make_beams("sun", {}), InputError);
  EXPECT_THROW(make_beams("sun", changed(table, {{"irradiance_W_m2", {-1.0}}})), InputError);
  EXPECT_THROW(make_beams("sun", changed(table, {{"angular_radius_deg", {60.0}}})), InputError);
  EXPECT_THROW(make_beams("sun", changed(table, {{"temperature_K", {0.0}}})), InputError);
  EXPECT_THROW(make_beams("sun", table, {.scene_radius_m = 0.0}), InputError);
}

}  // namespace
}  // namespace photorque
