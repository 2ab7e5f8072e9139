// Force and torque on a body.
#pragma once

#include <array>
#include <span>

#include "core/transform.h"
#include "core/vector.h"

namespace photorque {

enum class Frame { body, lab };

// A force and its torque about the point `about_m`; all three are components in `frame`.
struct Wrench {
  Vec3 force_N = Vec3::Zero();
  Vec3 torque_N_m = Vec3::Zero();
  Vec3 about_m = Vec3::Zero();
  Frame frame = Frame::body;
};

// A wrench that was estimated. `covariance` is that of the mean, in the order (force, torque) and
// the units N², N² m, N² m²: errors of force and torque are correlated, and only the whole matrix
// can be moved to another point or frame.
struct WrenchEstimate {
  Wrench mean;
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();

  // One standard error per component, in the frame of `mean`. What is exact may be below 0 by
  // rounding once it is turned.
  Vec3 force_error_N() const { return covariance.diagonal().head<3>().cwiseMax(0.0).cwiseSqrt(); }
  Vec3 torque_error_N_m() const {
    return covariance.diagonal().tail<3>().cwiseMax(0.0).cwiseSqrt();
  }
};

// Force and torque (x, y, z each) as one row of numbers.
using WrenchComponents = std::array<double, 6>;

// Mean and covariance of the mean from independent, identically distributed replicates, at least
// two. With R replicates the covariance has rank ≤ R − 1.
WrenchEstimate wrench_from_replicates(std::span<const WrenchComponents> replicates,
                                      const Vec3& about_m, Frame frame = Frame::body);

// The same wrench with its torque about another point of the same frame:
// T(p') = T(p) + (p − p') × F.
Wrench wrench_about(const Wrench& wrench, const Vec3& about_m);
WrenchEstimate wrench_about(const WrenchEstimate& wrench, const Vec3& about_m);

// The same wrench about the same material point, expressed in the lab. A wrench that is in the lab
// already is returned as it is.
Wrench wrench_in_lab(const Wrench& wrench, const RigidTransform& lab_from_body);
WrenchEstimate wrench_in_lab(const WrenchEstimate& wrench, const RigidTransform& lab_from_body);

}  // namespace photorque
