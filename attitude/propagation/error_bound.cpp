#include "attitude/propagation/error_bound.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <limits>

namespace photorque {

double attitude_error_bound_rad(const Dynamics& dynamics, const PlatformState& initial,
                                double end_s, double torque_N_m, const PropagationOptions& options,
                                size_t intervals) {
  const auto tangents = static_cast<size_t>(dynamics.size() - 1);
  std::vector<Variable> variables;
  for (size_t k = 0; k < tangents; ++k) variables.push_back({static_cast<int>(k), 0, -1});
  std::vector<double> times_s;
  const double step_s = (end_s - initial.time_s) / static_cast<double>(intervals);
  for (size_t i = 0; i <= intervals; ++i) {
    times_s.push_back(initial.time_s + static_cast<double>(i) * step_s);
  }
  const Trajectory trajectory = propagate(dynamics, initial, times_s, options, variables);
  const auto n = static_cast<Eigen::Index>(tangents);
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto transition = [&](size_t i) {
    return Matrix(
        Eigen::Map<const Matrix>(trajectory.derivatives.data() + i * tangents * tangents, n, n));
  };
  const size_t last = trajectory.states.size() - 1;
  const Matrix to_end = transition(last);
  const Mat3 inverse_inertia = dynamics.model().platform.inertia_kg_m2.inverse();
  double integral = 0.0;
  for (size_t i = 0; i <= last; ++i) {
    // ∂end/∂state(s) = ∂end/∂start (∂state(s)/∂start)⁻¹; rows of the attitude, columns of the rate.
    const Eigen::FullPivLU<Matrix> lu(transition(i).transpose());
    if (!lu.isInvertible()) return std::numeric_limits<double>::quiet_NaN();
    const Matrix from_here = lu.solve(to_end.topRows(3).transpose()).transpose();
    const Mat3 by_torque = from_here.middleCols(3, 3) * inverse_inertia;
    const double size = by_torque.jacobiSvd().singularValues()[0];
    integral += (i == 0 || i == last ? 0.5 : 1.0) * size * step_s;
  }
  return torque_N_m * integral;
}

}  // namespace photorque
