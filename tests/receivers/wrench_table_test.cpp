#include "receivers/wrench/table_product.h"

#include "core/constants.h"
#include "receiver_scenes.h"
#include "receivers/wrench/smoothing.h"

#include <gtest/gtest.h>
#include <random>

namespace photorque {
namespace {

using fixtures::map_named;

WrenchTable numbered(std::vector<double> tilts_deg, std::vector<double> headings_deg) {
  for (double& angle : tilts_deg) angle *= degree_rad;
  for (double& angle : headings_deg) angle *= degree_rad;
  WrenchTable table = make_wrench_table(WrenchTable::Angles::tilt_heading, std::move(tilts_deg),
                                        std::move(headings_deg));
  for (size_t i = 0; i < table.nodes(); ++i) {
    const auto x = static_cast<double>(i);
    table.force_body_N[i] = Vec3(x, 10 * x, 100 * x);
    table.torque_body_N_m[i] = -table.force_body_N[i];
    table.torque_error_N_m[i] = Vec3(0.5, 0.25, 0.125);
  }
  return table;
}

TEST(WrenchTableProduct, RegularGridBecomesMapsCentredOnItsNodes) {
  const Product product = wrench_table_product(numbered({0, 15, 30}, {0, 90, 180, 270}), "stasis");
  EXPECT_EQ(product.maps.size(), 10u);  // four of them discs
  EXPECT_TRUE(product.plots.empty());
  const Map& map = map_named(product, "torque_y_stasis");
  EXPECT_EQ(map.width, 5);  // the first heading closes the round
  EXPECT_EQ(map.height, 3);
  EXPECT_NEAR(map.x_low, -45, 1e-12);
  EXPECT_NEAR(map.x_high, 405, 1e-12);
  EXPECT_NEAR(map.y_low, -7.5, 1e-12);
  EXPECT_NEAR(map.y_high, 37.5, 1e-12);
  // Heading 180 deg is column 2, tilt 15 deg row 1: node 2·3 + 1.
  EXPECT_EQ(map.value[1 * 5 + 2], -70.0);
  EXPECT_EQ(map.standard_error[1 * 5 + 2], 0.25);
  EXPECT_EQ(map.value[1 * 5 + 4], map.value[1 * 5]);
  EXPECT_TRUE(map.signed_values);
  EXPECT_FALSE(map.equal_scale);
  EXPECT_EQ(map.x_label, "heading [deg]");
}

TEST(WrenchTableProduct, DiscsOfTiltAndHeadingPassThroughTheNodes) {
  const Product product = wrench_table_product(numbered({0, 15, 30}, {0, 90, 180, 270}), "stasis");
  const Map& disc = map_named(product, "torque_y_stasis_polar");
  const Map& size = map_named(product, "torque_size_stasis_polar");
  EXPECT_FALSE(size.signed_values);
  for (size_t i = 0; i < size.value.size(); ++i) {
    double squares = 0.0;
    for (const char* axis : {"x", "y", "z"}) {
      const double part =
          map_named(product, std::string("torque_") + axis + "_stasis_polar").value[i];
      squares += part * part;
    }
    if (!std::isfinite(squares)) continue;
    EXPECT_DOUBLE_EQ(size.value[i], std::sqrt(squares)) << i;
  }
  EXPECT_TRUE(disc.smooth);
  const auto at = [&](double x_deg, double y_deg) {
    const double step_deg = (disc.x_high - disc.x_low) / disc.width;
    const auto column = static_cast<size_t>((x_deg - disc.x_low) / step_deg);
    const auto row = static_cast<size_t>((y_deg - disc.y_low) / step_deg);
    return disc.value[row * static_cast<size_t>(disc.width) + column];
  };
  // At a node its own error, (0.5, 0.25, 0.125) of the axes.
  const auto middle_of = [&](double y_deg) {
    const double step_deg = (disc.y_high - disc.y_low) / disc.height;
    return static_cast<size_t>((y_deg - disc.y_low) / step_deg) * static_cast<size_t>(disc.width) +
           static_cast<size_t>(disc.width / 2);
  };
  EXPECT_NEAR(disc.standard_error[middle_of(30)], 0.25, 1e-9);
  // Half way between heading 45 and 135 deg of the four: no more than the nodes', by the weights
  // that add up to one (a tenth less where they share it).
  EXPECT_LT(disc.standard_error[middle_of(22.5)], 0.25);
  EXPECT_GT(disc.standard_error[middle_of(22.5)], 0.1);
  EXPECT_NEAR(at(0, 30), -50.0, 1e-9);    // heading 90 deg, tilt 30 deg: node 1·3 + 2
  EXPECT_NEAR(at(-15, 0), -70.0, 1e-9);   // heading 180 deg, tilt 15 deg
  EXPECT_NEAR(at(0, -30), -110.0, 1e-9);  // heading 270 deg
  EXPECT_TRUE(std::isnan(at(25, 25)));    // 35 deg
}

TEST(WrenchTableProduct, NamesTheLongestForceAndTorque) {
  const Product product = wrench_table_product(numbered({0, 10, 30}, {0, 90}), "stasis");
  ASSERT_EQ(product.quantities.size(), 2u);
  EXPECT_EQ(product.quantities[0].name, "largest_force_stasis_N");
  EXPECT_EQ(product.quantities[1].name, "largest_torque_stasis_N_m");
  const double length = std::sqrt(1 + 100 + 10000.0);
  EXPECT_NEAR(product.quantities[1].estimate.value, 5 * length, 1e-9);
  // Errors along the torque: (0.5, 0.25, 0.125) weighed with its direction.
  EXPECT_NEAR(product.quantities[1].estimate.standard_error,
              std::sqrt(0.25 + 6.25 + 156.25) / length, 1e-12);
}

TEST(WrenchTableProduct, TableHasARowPerNode) {
  const Product product = wrench_table_product(numbered({0, 10, 30}, {0, 90}), "stasis");
  EXPECT_TRUE(product.maps.empty());  // the tilts are not evenly spaced
  const Table& table = product.tables.at(0);
  EXPECT_EQ(table.name, "wrench_table_stasis");
  EXPECT_EQ(table.columns[0].name, "heading_deg");
  EXPECT_EQ(table.columns[1].name, "tilt_deg");
  EXPECT_NEAR(table.columns[0].values[4], 90.0, 1e-12);
  EXPECT_NEAR(table.columns[1].values[4], 10.0, 1e-12);
  EXPECT_EQ(table.columns[3].name, "force_y_N");
  EXPECT_EQ(table.columns[3].values[4], 40.0);
  EXPECT_EQ(table.columns.size(), 14u);
  for (const Table::Column& column : table.columns) EXPECT_EQ(column.values.size(), 6u);
}

TEST(WrenchTableProduct, SingleHeadingIsPlottedOverTilt) {
  const Product product = wrench_table_product(numbered({0, 10, 20, 30}, {45}), "stasis");
  ASSERT_EQ(product.plots.size(), 2u);
  EXPECT_EQ(product.plots[1].name, "torque_stasis");
  EXPECT_EQ(product.plots[1].x_label, "tilt [deg]");
  EXPECT_EQ(product.plots[1].curves[1].label, "y");
  EXPECT_NEAR(product.plots[1].curves[1].x[2], 20.0, 1e-12);
  EXPECT_EQ(product.plots[1].curves[1].y[2], -20.0);
  EXPECT_EQ(product.plots[1].curves[1].y_error[2], 0.25);
}

// A wrench over the sphere, made smooth.

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
