// The moments of inertia of a body that turns freely, up to their scale, from its rates alone.
#pragma once

#include <optional>
#include <vector>

#include "attitude/observation/observation.h"

namespace photorque {

// Six numbers of an inertia tensor: Ixx, Iyy, Izz, Ixy, Ixz, Iyz.
using InertiaNumbers = Eigen::Matrix<double, 6, 1>;

struct FreeInertia {
  // In units of the mean moment: a third of the trace is one, because torque-free motion is the
  // same for all bodies of equal ratios.
  InertiaNumbers value = InertiaNumbers::Zero();
  // Of the values; singular, because their trace is given.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  // Moments of the wheels about x, y and z in the same unit, with their errors; zero where none was
  // measured. A negative one means that the wheel's speed was read with the wrong sign.
  Vec3 wheel = Vec3::Zero(), wheel_sigma = Vec3::Zero();
  // The unexplained part: root mean square of the residual over that of the change of the body's
  // angular momentum in body axes. 0 for exact readings, about 1 and more where the rates follow no
  // such law.
  double left = 0.0;

  double sigma(int k) const { return std::sqrt(covariance(k, k)); }
};

// Whether a drag by the square of the rate about each axis is fitted beside the inertia.
enum class FreeDrag { fitted, none };

// From the pieces of one recording, each with its own angular momentum. With
//
//   I ω(t) + h(t) + ∫ ω × (I ω + h) dt + Σ_k d_k ∫ |ω| ω_k e_k dt = constant,
//
// h = Σ_k J_k Ω_k(t) e_k of the wheels whose speed was measured and d_k a drag by the square of the
// rate about each axis, nothing has to be differentiated and all unknowns enter linearly (the
// body's largest column is given the coefficient one). Standard errors follow from the residuals,
// which count once per correlation time. Nothing where a command acted, where an axis was not read
// in 20 rows at least, or where a negative moment comes out: then something else turns the body.
std::optional<FreeInertia> free_inertia(const std::vector<Observation>& pieces,
                                        FreeDrag drag = FreeDrag::fitted);

}  // namespace photorque
