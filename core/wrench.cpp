#include "core/wrench.h"

namespace photorque {
namespace {

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

Mat3 cross_matrix(const Vec3& a) {
  Mat3 m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

}  // namespace

WrenchEstimate wrench_from_replicates(std::span<const WrenchComponents> replicates,
                                      const Vec3& about_m, Frame frame) {
  const double count = static_cast<double>(replicates.size());
  Vec6 mean = Vec6::Zero();
  for (const WrenchComponents& replicate : replicates) mean += Vec6(replicate.data()) / count;
  Mat6 covariance = Mat6::Zero();
  for (const WrenchComponents& replicate : replicates) {
    const Vec6 deviation = Vec6(replicate.data()) - mean;
    covariance += deviation * deviation.transpose() / (count * (count - 1.0));
  }
  return {{mean.head<3>(), mean.tail<3>(), about_m, frame}, covariance};
}

Wrench wrench_about(const Wrench& wrench, const Vec3& about_m) {
  Wrench moved = wrench;
  moved.torque_N_m += (wrench.about_m - about_m).cross(wrench.force_N);
  moved.about_m = about_m;
  return moved;
}

WrenchEstimate wrench_about(const WrenchEstimate& wrench, const Vec3& about_m) {
  Mat6 shift = Mat6::Identity();
  shift.bottomLeftCorner<3, 3>() = cross_matrix(wrench.mean.about_m - about_m);
  return {wrench_about(wrench.mean, about_m), shift * wrench.covariance * shift.transpose()};
}

Wrench wrench_in_lab(const Wrench& wrench, const RigidTransform& lab_from_body) {
  if (wrench.frame == Frame::lab) return wrench;
  return {lab_from_body.direction(wrench.force_N), lab_from_body.direction(wrench.torque_N_m),
          lab_from_body.point(wrench.about_m), Frame::lab};
}

WrenchEstimate wrench_in_lab(const WrenchEstimate& wrench, const RigidTransform& lab_from_body) {
  if (wrench.mean.frame == Frame::lab) return wrench;
  Mat6 turn = Mat6::Zero();
  turn.topLeftCorner<3, 3>() = lab_from_body.rotation.toRotationMatrix();
  turn.bottomRightCorner<3, 3>() = turn.topLeftCorner<3, 3>();
  return {wrench_in_lab(wrench.mean, lab_from_body), turn * wrench.covariance * turn.transpose()};
}

}  // namespace photorque
