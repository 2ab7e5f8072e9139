#include <gtest/gtest.h>

#include "core/constants.h"
#include "core/errors.h"
#include "core/wrench.h"

namespace photorque {
namespace {

TEST(Wrench, ForceAtAPointHasNoTorqueAboutIt) {
  // A force F at r: T = r × F about the origin, zero about r, and zero about any point of its line.
  const Vec3 force_N(1, -2, 3), r_m(0.4, 0.5, -0.6);
  const Wrench origin{force_N, r_m.cross(force_N), Vec3::Zero(), Frame::body};
  EXPECT_LT(wrench_about(origin, r_m).torque_N_m.norm(), 1e-15);
  EXPECT_LT(wrench_about(origin, r_m + 7 * force_N).torque_N_m.norm(), 1e-14);
  EXPECT_EQ(wrench_about(origin, r_m).force_N, force_N);
}

TEST(Wrench, MovingThereAndBackChangesNothing) {
  WrenchEstimate wrench{{{1, 2, 3}, {4, 5, 6}, {0.1, 0.2, 0.3}, Frame::body}, {}};
  Eigen::Matrix<double, 6, 6> root;
  for (int i = 0; i < 36; ++i) root(i / 6, i % 6) = std::sin(i + 1.0);
  wrench.covariance = root * root.transpose();
  const WrenchEstimate back = wrench_about(wrench_about(wrench, {-3, 4, 5}), wrench.mean.about_m);
  EXPECT_LT((back.mean.torque_N_m - wrench.mean.torque_N_m).norm(), 1e-13);
  EXPECT_LT((back.covariance - wrench.covariance).norm(), 1e-11);
}

TEST(Wrench, CovarianceOfReplicatesByHand) {
  // Force x: 1, 2, 6; torque z: −1, −2, −6. Both have variance of the mean 7/3, and covariance
  // −7/3.
  const WrenchComponents replicates[] = {
      {1, 0, 0, 0, 0, -1}, {2, 0, 0, 0, 0, -2}, {6, 0, 0, 0, 0, -6}};
  const WrenchEstimate wrench = wrench_from_replicates(replicates, Vec3::UnitX());
  EXPECT_NEAR(wrench.mean.force_N.x(), 3.0, 1e-15);
  EXPECT_NEAR(wrench.mean.torque_N_m.z(), -3.0, 1e-15);
  EXPECT_NEAR(wrench.covariance(0, 0), 7.0 / 3.0, 1e-14);
  EXPECT_NEAR(wrench.covariance(5, 5), 7.0 / 3.0, 1e-14);
  EXPECT_NEAR(wrench.covariance(0, 5), -7.0 / 3.0, 1e-14);
  EXPECT_NEAR(wrench.force_error_N().x(), std::sqrt(7.0 / 3.0), 1e-14);
  EXPECT_EQ(wrench.force_error_N().y(), 0.0);
  EXPECT_EQ(wrench.mean.about_m, Vec3::UnitX());
}

TEST(Wrench, CorrelatedErrorsCancelWhereTheForceActs) {
  // A force of uncertain size but certain line through (0, 1, 0): about that point the torque is
  // certain, though about the origin it is not.
  const WrenchComponents replicates[] = {
      {1, 0, 0, 0, 0, -1}, {2, 0, 0, 0, 0, -2}, {6, 0, 0, 0, 0, -6}};
  const WrenchEstimate origin = wrench_from_replicates(replicates, Vec3::Zero());
  EXPECT_GT(origin.torque_error_N_m().z(), 1.0);
  const WrenchEstimate there = wrench_about(origin, Vec3::UnitY());
  EXPECT_NEAR(there.mean.torque_N_m.z(), 0.0, 1e-15);
  EXPECT_NEAR(there.covariance(5, 5), 0.0, 1e-14);
}

constexpr auto tilt_heading = WrenchTable::Angles::tilt_heading;
constexpr auto azimuth_elevation = WrenchTable::Angles::azimuth_elevation;

std::vector<double> degrees(double low, double high, double step) {
  std::vector<double> angles;
  const auto count = static_cast<int>(std::lround((high - low) / step)) + 1;
  for (int i = 0; i < count; ++i) angles.push_back((low + i * step) * degree_rad);
  return angles;
}

template <typename Function>
WrenchTable filled(WrenchTable table, const Function& force) {
  for (size_t a = 0; a < table.around_rad.size(); ++a) {
    for (size_t p = 0; p < table.polar_rad.size(); ++p) {
      table.force_body_N[table.node(a, p)] = force(table.polar_rad[p], table.around_rad[a]);
      table.torque_body_N_m[table.node(a, p)] = 2 * table.force_body_N[table.node(a, p)];
    }
  }
  return table;
}

// The force on an absorbing sphere of unit cross-section under unit pressure.
Vec3 sphere_force(double elevation_rad, double azimuth_rad) {
  return -towards_light({elevation_rad, azimuth_rad});
}

TEST(WrenchTable, BilinearFunctionsAreReproduced) {
  const auto bilinear = [](double p, double a) { return Vec3(1 + p, a, p * a - 2 * a); };
  const WrenchTable table = filled(
      make_wrench_table(tilt_heading, {0.1, 0.2, 0.5}, {-1.0, 0.0, 0.25}, {1, 2, 3}), bilinear);
  for (const double p : {0.1, 0.13, 0.2, 0.44, 0.5}) {
    for (const double a : {-1.0, -0.3, 0.0, 0.1, 0.25}) {
      const Wrench wrench = wrench_at(table, {p, a});
      EXPECT_LT((wrench.force_N - bilinear(p, a)).norm(), 1e-14);
      EXPECT_LT((wrench.torque_N_m - 2 * bilinear(p, a)).norm(), 1e-14);
      EXPECT_EQ(wrench.about_m, Vec3(1, 2, 3));
    }
  }
}

TEST(WrenchTable, HeadingsWrapWhetherOrNotTheLastRepeatsTheFirst) {
  const auto smooth = [](double p, double a) { return Vec3(p * std::cos(a), p * std::sin(a), 1); };
  const WrenchTable open =
      filled(make_wrench_table(tilt_heading, degrees(0, 30, 5), degrees(0, 350, 10)), smooth);
  const WrenchTable closed =
      filled(make_wrench_table(tilt_heading, degrees(0, 30, 5), degrees(-180, 180, 10)), smooth);
  for (double heading_deg = -725; heading_deg < 725; heading_deg += 12.5) {
    const TableAngles angles{0.3, heading_deg * degree_rad};
    const Wrench a = wrench_at(open, angles), b = wrench_at(closed, angles);
    EXPECT_LT((a.force_N - b.force_N).norm(), 1e-13) << heading_deg;
    // Linear interpolation over 10 deg errs by at most (10 deg)²/8 of the amplitude.
    EXPECT_LT((a.force_N - smooth(0.3, angles.around_rad)).norm(), 0.3 * 0.0039) << heading_deg;
  }
}

TEST(WrenchTable, OutsideIsAnErrorNotAGuess) {
  const auto one = [](double, double) { return Vec3(1, 1, 1); };
  const WrenchTable table =
      filled(make_wrench_table(tilt_heading, degrees(0, 30, 5), degrees(0, 90, 10)), one);
  EXPECT_NO_THROW(wrench_at(table, {30 * degree_rad + 1e-12, 0.5}));
  EXPECT_THROW(wrench_at(table, {30.001 * degree_rad, 0.5}), NumericalError);
  EXPECT_THROW(wrench_at(table, {0.2, 91 * degree_rad}), NumericalError);
  EXPECT_THROW(wrench_at(table, {0.2, 350 * degree_rad}), NumericalError);
  EXPECT_THROW(wrench_at(table, {std::nan(""), 0.5}), NumericalError);
  // Without tilt the heading means nothing.
  EXPECT_NO_THROW(wrench_at(table, {0.0, 350 * degree_rad}));
}

TEST(WrenchTable, ASingleHeadingIsGoodForItselfAlone) {
  const auto by_tilt = [](double p, double) { return Vec3(p, 0, 0); };
  const WrenchTable table =
      filled(make_wrench_table(tilt_heading, degrees(0, 30, 15), {0.5}), by_tilt);
  EXPECT_NEAR(wrench_at(table, {0.1, 0.5}).force_N.x(), 0.1, 1e-15);
  EXPECT_NEAR(wrench_at(table, {0.1, 0.5 - 2 * pi}).force_N.x(), 0.1, 1e-15);
  EXPECT_THROW(wrench_at(table, {0.1, 0.6}), NumericalError);
}

TEST(WrenchTable, RefusesAxesThatAreNotAscendingOrOutOfRange) {
  EXPECT_THROW(make_wrench_table(tilt_heading, {}, {0.0}), InputError);
  EXPECT_THROW(make_wrench_table(tilt_heading, {0.2, 0.1}, {0.0}), InputError);
  EXPECT_THROW(make_wrench_table(tilt_heading, {-0.1, 0.1}, {0.0}), InputError);
  EXPECT_THROW(make_wrench_table(tilt_heading, {0.1}, {0.0, 7.0}), InputError);
  EXPECT_THROW(make_wrench_table(azimuth_elevation, {0.0, 1.6}, {0.0}), InputError);
  EXPECT_NO_THROW(make_wrench_table(azimuth_elevation, {-pi / 2, pi / 2}, {-pi, pi}));
}

TEST(WrenchTable, AzimuthAndElevationOfTheAxes) {
  const auto expect = [](const Vec3& direction, double elevation_deg, double azimuth_deg) {
    const TableAngles angles = azimuth_and_elevation(3 * direction);
    EXPECT_NEAR(angles.polar_rad, elevation_deg * degree_rad, 1e-15);
    EXPECT_NEAR(angles.around_rad, azimuth_deg * degree_rad, 1e-15);
    EXPECT_LT((towards_light(angles) - direction).norm(), 1e-15);
  };
  expect({1, 0, 0}, 0, 0);
  expect({0, 1, 0}, 0, 90);
  expect({0, -1, 0}, 0, -90);
  expect({0, 0, 1}, 90, 0);
  expect(Vec3(1, 1, -std::sqrt(2.0)) / 2, -45, 45);
}

TEST(WrenchTable, SingleValuedAveragesNodesOfOneAttitude) {
  WrenchTable table =
      filled(make_wrench_table(azimuth_elevation, degrees(-90, 90, 30), degrees(-180, 180, 30)),
             sphere_force);
  for (size_t i = 0; i < table.nodes(); ++i) table.force_error_N[i] = Vec3(0.1, 0, 0);
  // Noise at the upper pole, different for the 13 azimuths: 0 … 12, mean 6.
  const size_t top = table.polar_rad.size() - 1;
  for (size_t a = 0; a < 13; ++a) {
    table.force_body_N[table.node(a, top)] = Vec3(0, 0, static_cast<double>(a));
  }
  const WrenchTable clean = single_valued(table);
  for (size_t a = 0; a < 13; ++a) {
    EXPECT_NEAR(clean.force_body_N[clean.node(a, top)].z(), 6.0, 1e-14);
    EXPECT_NEAR(clean.force_error_N[clean.node(a, top)].x(), 0.1, 1e-15);
  }
  // Azimuths −180 and 180 deg at elevation 0 are averaged, those between are left alone.
  EXPECT_NEAR(clean.force_error_N[clean.node(0, 3)].x(), 0.1, 1e-15);
  EXPECT_EQ(clean.force_error_N[clean.node(1, 3)].x(), 0.1);
  EXPECT_EQ(clean.force_body_N[clean.node(1, 3)], table.force_body_N[table.node(1, 3)]);
}

TEST(WrenchTable, APassiveBodyIsPushedAway) {
  const WrenchTable table =
      filled(make_wrench_table(azimuth_elevation, degrees(-90, 90, 5), degrees(-180, 180, 5)),
             sphere_force);
  EXPECT_NEAR(mean_push_N(table), 1.0, 1e-12);
  EXPECT_NEAR(mean_push_N(scaled(table, -3.0)), -3.0, 1e-12);
}

TEST(WrenchTable, NodesAreMovedToTheTablesPoint) {
  WrenchTable table = make_wrench_table(tilt_heading, {0.0}, {0.0}, {0, 0, 1});
  set_node(table, 0, {{{1, 0, 0}, {0, 0, 0}, Vec3::Zero(), Frame::body}, {}});
  // 1 N along x through the origin has −1 N m about y seen from a point 1 m above.
  EXPECT_EQ(table.torque_body_N_m[0], Vec3(0, -1, 0));
  EXPECT_EQ(table.force_body_N[0], Vec3(1, 0, 0));
}

}  // namespace

}  // namespace photorque
