// Names for the fixed-size linear algebra that the whole program shares.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace photorque {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Quat = Eigen::Quaterniond;  // Hamilton, (w, x, y, z)
using Affine = Eigen::Affine3d;   // any linear part, may be non-uniform or mirrored

}  // namespace photorque
