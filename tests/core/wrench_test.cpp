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

TEST(Wrench, InTheLabOfATiltedBody) {
  // Tilted by 30° about y: body x points to (cos 30°, 0, −sin 30°) in the lab.
  const RigidTransform lab_from_body = lab_from_body_at(30 * degree_rad, 0.0);
  WrenchEstimate body{{{2, 0, 0}, {0, 3, 0}, {0, 0, 1}, Frame::body}, {}};
  body.covariance(0, 0) = 4.0;
  body.covariance(4, 4) = 9.0;
  const WrenchEstimate lab = wrench_in_lab(body, lab_from_body);
  const double c = std::cos(30 * degree_rad), s = 0.5;
  EXPECT_LT((lab.mean.force_N - Vec3(2 * c, 0, -2 * s)).norm(), 1e-15);
  EXPECT_LT((lab.mean.torque_N_m - Vec3(0, 3, 0)).norm(), 1e-15);
  EXPECT_LT((lab.mean.about_m - Vec3(s, 0, c)).norm(), 1e-15);
  EXPECT_LT((lab.force_error_N() - Vec3(2 * c, 0, 2 * s)).norm(), 1e-14);
  EXPECT_LT((lab.torque_error_N_m() - Vec3(0, 3, 0)).norm(), 1e-14);
  EXPECT_EQ(lab.mean.frame, Frame::lab);
  EXPECT_EQ(wrench_in_lab(lab, lab_from_body).mean.force_N, lab.mean.force_N);
}

// An exact component that is turned is 0 but for rounding, on either side of it: its error is a
// number all the same.
TEST(Wrench, ErrorsOfExactComponentsAreNumbersAtEveryAttitude) {
  for (int i = 0; i < 1000; ++i) {
    WrenchEstimate body{{{2, 0, 0}, {0, 3, 0}, {0, 0, 1}, Frame::body}, {}};
    body.covariance(0, 0) = 4.0;
    body.covariance(4, 4) = 9.0;
    body.covariance(0, 4) = body.covariance(4, 0) = 6.0;
    const WrenchEstimate lab = wrench_in_lab(body, lab_from_body_at(0.003 * i, 0.01 * i));
    EXPECT_TRUE(lab.force_error_N().allFinite()) << i;
    EXPECT_TRUE(lab.torque_error_N_m().allFinite()) << i;
    EXPECT_NEAR(lab.force_error_N().norm(), 2.0, 1e-12);
  }
}

}  // namespace
}  // namespace photorque
