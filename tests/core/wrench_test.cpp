#include "core/wrench.h"

#include <gtest/gtest.h>

#include "core/constants.h"

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

}  // namespace
}  // namespace photorque
