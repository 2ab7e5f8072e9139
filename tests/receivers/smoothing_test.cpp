// A wrench over the sphere, made smooth.
#include "receivers/wrench/smoothing.h"

#include <gtest/gtest.h>

#include <random>

#include "core/constants.h"

namespace photorque {
namespace {

constexpr int around = 73, rings = 37;  // the first azimuth repeated after a whole turn

WrenchTable sphere_table() {
  std::vector<double> azimuth_rad, elevation_rad;
  for (int a = 0; a < around; ++a) azimuth_rad.push_back(-pi + 2.0 * pi * a / (around - 1));
  for (int e = 0; e < rings; ++e) elevation_rad.push_back(-0.5 * pi + pi * e / (rings - 1));
  return make_wrench_table(WrenchTable::Angles::azimuth_elevation, elevation_rad, azimuth_rad);
}

// Smooth but for a kink along x = 0, as where a face turns into the light.
double truth(size_t component, const Vec3& d) {
  if (component == 3) return std::max(0.0, d.x()) * (1.0 + d.y());
  if (component == 4) return d.x() * d.y() * d.z();
  return component == 5 ? 0.1 * std::exp(d.z()) : d[static_cast<Eigen::Index>(component)];
}

// The error that is stated is the error that there is, and far below the noise.
TEST(SmoothOverSphere, StatesItsError) {
  constexpr double noise = 0.05;
  const WrenchTable table = sphere_table();
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0.0, noise * std::sqrt(2.0));  // of either half
  std::vector<WrenchPair> wrenches(table.nodes());
  for (size_t a = 0; a + 1 < table.around_rad.size(); ++a) {
    for (size_t e = 0; e < table.polar_rad.size(); ++e) {
      const Vec3 d = towards_light({table.polar_rad[e], table.around_rad[a]});
      for (size_t k = 0; k < 6; ++k) {
        wrenches[table.node(a, e)].first[k] = truth(k, d) + normal(random);
        wrenches[table.node(a, e)].second[k] = truth(k, d) + normal(random);
      }
    }
  }
  const SmoothWrench smooth = smooth_over_sphere(table, wrenches);
  double stated = 0.0, found = 0.0, weights = 0.0;
  for (size_t a = 0; a < table.around_rad.size(); ++a) {
    for (size_t e = 0; e < table.polar_rad.size(); ++e) {
      const Vec3 d = towards_light({table.polar_rad[e], table.around_rad[a]});
      const double weight = std::cos(table.polar_rad[e]);
      for (size_t k = 3; k < 6; ++k) {
        const double own = smooth.at_node[6 * table.node(a, e) + k];
        found += weight * std::pow(own - truth(k, d), 2);
        stated += weight * std::pow(smooth.error[k], 2);
      }
      weights += 3.0 * weight;
    }
  }
  found = std::sqrt(found / weights);
  stated = std::sqrt(stated / weights);
  EXPECT_NEAR(found / stated, 1.0, 0.3);
  EXPECT_LT(found, 0.25 * noise);
  // The last azimuth is the first.
  EXPECT_NEAR(smooth.at_node[6 * table.node(0, 9) + 3],
              smooth.at_node[6 * table.node(around - 1, 9) + 3], 1e-12);
}

}  // namespace
}  // namespace photorque
