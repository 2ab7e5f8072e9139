#include "diagnosis/guess/rates.h"

#include "core/numerics/linear.h"

namespace photorque {

bool has_no_mean_rate(const std::vector<Observation>& runs) {
  constexpr double none = 0.15;  // of the rms; tumbling bodies have 0.4 and more
  Vec3 sum = Vec3::Zero();
  double squares = 0.0, count = 0.0;
  for (const Observation& seen : runs) {
    for (const Vec3& rate : seen.gyro_rad_s) {
      if (!rate.allFinite()) continue;
      sum += rate;
      squares += rate.squaredNorm();
      ++count;
    }
  }
  return sum.squaredNorm() < none * none * squares * count;
}

std::optional<int> axis_of_swing(const std::vector<Observation>& runs, double across) {
  Mat3 squares = Mat3::Zero();
  for (const Observation& seen : runs) {
    for (const Vec3& rate : seen.gyro_rad_s) {
      if (rate.allFinite()) squares += rate * rate.transpose();
    }
  }
  const SymmetricEigen principal = symmetric_eigen(squares);
  if (!(principal.values.head(2).sum() < across * across * principal.values[2])) {
    return std::nullopt;
  }
  Eigen::Index largest = 0;
  principal.vectors.col(2).cwiseAbs().maxCoeff(&largest);
  return static_cast<int>(largest);
}

std::optional<int> only_axis(const std::vector<Observation>& runs) {
  Vec3 squares = Vec3::Zero();
  for (const Observation& seen : runs) {
    for (size_t i = 0; i < seen.blocks(); ++i) {
      if (seen.gyro_rad_s[i].allFinite()) squares += seen.gyro_rad_s[i].cwiseAbs2();
    }
  }
  int axis = 0;
  const double most = squares.maxCoeff(&axis);
  constexpr double across = 0.05;  // fraction of the rate: a slightly misaligned gyro
  if (squares.sum() - most > across * across * most) return std::nullopt;
  return axis;
}

}  // namespace photorque
