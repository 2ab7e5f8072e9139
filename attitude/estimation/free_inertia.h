// The inertia tensor of a freely rotating body, up to a common factor, from its rates alone.
#pragma once

#include <optional>
#include <vector>

#include "attitude/observation/observation.h"

namespace photorque {

// Six numbers of an inertia tensor: Ixx, Iyy, Izz, Ixy, Ixz, Iyz.
using InertiaNumbers = Eigen::Matrix<double, 6, 1>;

struct FreeInertia {
  // Inertia in units of the mean moment, so that a third of the trace is one: torque-free motion
  // depends on the ratios only.
  InertiaNumbers value = InertiaNumbers::Zero();
  // Covariance of `value`; singular, because the trace is fixed.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  // Moments of inertia of the wheels about x, y and z in the same unit, with their standard errors;
  // zero if the speed was not measured. A negative value indicates the wrong sign of the speed.
  Vec3 wheel = Vec3::Zero(), wheel_sigma = Vec3::Zero();
  // The unexplained fraction: root mean square of the residual divided by that of the change of the
  // body's angular momentum in body axes. 0 for exact readings, about 1 or more if the rates do not
  // obey the law below.
  double left = 0.0;

  double sigma(int k) const { return std::sqrt(covariance(k, k)); }
};

// Whether a drag proportional to the square of the rate is fitted too, one coefficient per axis.
enum class FreeDrag { fitted, none };

// Fits the tensor to the segments of one recording, each with a separate angular momentum. The law
// is
//
//   I ω(t) + h(t) + ∫ ω × (I ω + h) dt + Σ_k d_k ∫ |ω| ω_k e_k dt = constant,
//
// with h = Σ_k J_k Ω_k(t) e_k, the momentum of the wheels whose speed was measured, and a quadratic
// drag d_k about each axis. It contains no derivatives, and all unknowns are linear (the moment
// with the largest column has the coefficient one). Standard errors follow from the residuals, of
// which one per correlation time is independent. Empty if a command acted, if no segment has 20
// complete readings, or if a moment is negative, which indicates an external torque.
std::optional<FreeInertia> free_inertia(const std::vector<Observation>& pieces,
                                        FreeDrag drag = FreeDrag::fitted);

}  // namespace photorque
