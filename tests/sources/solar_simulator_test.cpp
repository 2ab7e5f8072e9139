#include "core/constants.h"
#include "sampling.h"

namespace photorque {
namespace {

SettingsNode::Table simulator(double nonuniformity) {
  return {{"irradiance_W_m2", {1000.0}},
          {"footprint_diameter_m", {0.4}},
          {"collimation_half_angle_deg", {3.0}},
          {"nonuniformity", {nonuniformity}},
          {"position_m", test::vector_node(0.1, 0, 0.2)},
          {"direction", test::vector_node(0, 0, -1)}};
}

struct Lit {
  std::vector<double> radii_m;  // at the field's plane, ascending
  double power_W;
};

Lit light(double nonuniformity) {
  const Beam beam = test::make_beams("solar_simulator", simulator(nonuniformity)).at(0);
  Lit lit{{}, beam.emitter->power_W()};
  for (const auto& ray : test::rays_of(*beam.emitter, 1u << 17)) {
    const Vec3 origin = beam.lab_from_emitter.point(ray.origin_m);
    const Vec3 d = beam.lab_from_emitter.direction(ray.direction);
    const Vec3 at = origin + d * ((0.2 - origin.z()) / d.z());
    lit.radii_m.push_back((at - Vec3(0.1, 0, 0.2)).norm());
    EXPECT_LE(std::acos(std::min(1.0, -d.z())), 3.0 * degree_rad * (1 + 1e-9));
    EXPECT_GE(origin.z(), 1.0);  // before the scene, whose radius is 1 m
  }
  std::sort(lit.radii_m.begin(), lit.radii_m.end());
  return lit;
}

TEST(SolarSimulator, LightsItsFieldEvenlyAndNothingBeside) {
  const Lit lit = light(0.0);
  EXPECT_NEAR(lit.power_W, 1000.0 * pi * 0.04, 1e-9);
  EXPECT_LE(lit.radii_m.back(), 0.2 * (1 + 1e-9));
  EXPECT_LT(test::largest_deviation(lit.radii_m, [](double r) { return r * r / 0.04; }), 1e-4);
}

// Irradiance of thin rings, counted: E0 in the middle and E0 (1 − u)/(1 + u) at the rim, whose
// (max − min)/(max + min) is u.
TEST(SolarSimulator, HasTheNonuniformityOfItsKey) {
  const double u = 0.1;
  const Lit lit = light(u);
  const auto irradiance = [&](double low, double high) {
    const auto below = [&](double r) {
      return std::lower_bound(lit.radii_m.begin(), lit.radii_m.end(), r);
    };
    const auto rays = static_cast<double>(below(high) - below(low));
    return rays * lit.power_W / static_cast<double>(lit.radii_m.size()) /
           (pi * (high * high - low * low));
  };
  EXPECT_NEAR(irradiance(0.0, 0.02), 1000.0, 5.0);
  EXPECT_NEAR(irradiance(0.198, 0.2), 1000.0 * (1 - u) / (1 + u), 5.0);
}

}  // namespace
}  // namespace photorque
