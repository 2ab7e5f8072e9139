#include "core/constants.h"
#include "sampling.h"
#include "sources/profiles/beam_shape.h"

namespace photorque {
namespace {

using test::changed;
using test::make_beams;
using test::vector_node;

SettingsNode::Table laser(double waist_m) {
  return {{"power_W", {0.005}},
          {"wavelength_nm", {633.0}},
          {"waist_radius_m", {waist_m}},
          {"position_m", vector_node(0, 0, 1)},
          {"direction", vector_node(0, 0, -1)}};
}

// Squared distances from the axis [m²] at z, ascending.
std::vector<double> squared_radii(const Emitter& emitter, double z_m) {
  std::vector<double> all;
  for (const auto& ray : test::rays_of(emitter, 1u << 17)) {
    const Vec3 at_m = ray.origin_m + ray.direction * (z_m / ray.direction.z());
    all.push_back(at_m.head<2>().squaredNorm());
  }
  std::sort(all.begin(), all.end());
  return all;
}

// A TEM00 beam has I ∝ exp(−2 r²/w²) at every z, w² = w0²(1 + (z/z_R)²), z_R = π w0²/λ (Siegman,
// Lasers, section 17.1).
TEST(Laser, IsGaussianWithTheDiffractionLimitedRadiusAtEveryDistance) {
  const double waist_m = 1e-4;
  const double rayleigh_m = pi * waist_m * waist_m / 633e-9;
  const Beam beam = make_beams("laser", laser(waist_m)).at(0);
  for (const double z_m : {0.0, 0.5 * rayleigh_m, rayleigh_m, 20.0 * rayleigh_m}) {
    const double w2 = waist_m * waist_m * (1.0 + std::pow(z_m / rayleigh_m, 2));
    const auto radii2 = squared_radii(*beam.emitter, z_m);
    EXPECT_LT(
        test::largest_deviation(radii2, [&](double r2) { return -std::expm1(-2.0 * r2 / w2); }),
        1e-3)
        << z_m;
    double mean = 0.0;
    for (const double r2 : radii2) mean += r2 / static_cast<double>(radii2.size());
    EXPECT_NEAR(2.0 * mean / w2, 1.0, 1e-3) << z_m;
  }
}

TEST(Laser, DivergenceIsTheFarFieldHalfAngleAtOneOverESquared) {
  const double half_angle_rad = 5.0 * degree_rad;
  const Beam beam =
      make_beams("laser", changed(laser(1e-3), {{"divergence_half_angle_deg", {5.0}}})).at(0);
  const double z_m = 10.0;
  const double w2 = 1e-6 + std::pow(z_m * std::tan(half_angle_rad), 2);
  EXPECT_LT(test::largest_deviation(squared_radii(*beam.emitter, z_m),
                                    [&](double r2) { return -std::expm1(-2.0 * r2 / w2); }),
            1e-3);
  // Within the 1/e² cone lies 1 − e⁻² of the flux.
  EXPECT_NEAR(EncircledFlux(*beam.emitter).within(half_angle_rad), 1.0 - std::exp(-2.0), 1e-9);
}

TEST(Laser, NoticesABeamThatDiffractionForbids) {
  std::vector<std::string> notices;
  const SourceContext context{.notice = [&](const std::string& line) { notices.push_back(line); }};
  make_beams("laser", laser(1e-3), context);
  make_beams("laser", changed(laser(1e-3), {{"divergence_half_angle_mrad", {0.21}}}), context);
  EXPECT_TRUE(notices.empty());  // λ/(π w0) = 0.2015 mrad
  make_beams("laser", changed(laser(1e-3), {{"divergence_half_angle_mrad", {0.19}}}), context);
  EXPECT_EQ(notices.size(), 1u);
}

TEST(Laser, WithoutDivergenceIsCollimated) {
  const Beam beam =
      make_beams("laser", changed(laser(1e-3), {{"divergence_half_angle_deg", {0.0}}})).at(0);
  EXPECT_TRUE(describe(*beam.emitter).collimated);
  for (const auto& ray : test::rays_of(*beam.emitter, 256)) EXPECT_EQ(ray.direction, Vec3::UnitZ());
}

TEST(Laser, ReportsTheMistake) {
  EXPECT_THROW(make_beams("laser", laser(0.0)), InputError);
  EXPECT_THROW(make_beams("laser", laser(1e-7)), InputError);  // spreads by more than 30 deg
  EXPECT_THROW(make_beams("laser", changed(laser(1e-3), {}, {"wavelength_nm"})), InputError);
  EXPECT_THROW(make_beams("laser", changed(laser(1e-3), {{"divergence_half_angle_deg", {31.0}}})),
               InputError);
  EXPECT_THROW(make_beams("laser", changed(laser(1e-3), {{"aim_m", vector_node(0, 0, 0)}})),
               InputError);
}

}  // namespace
}  // namespace photorque
