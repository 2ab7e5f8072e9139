// The collocation equations of one step, differentiated: a linear system for changes of the stages.
//
// There are two uses. Newton's method finds the stages where fixed-point iteration does not
// converge. An example is a platform that sticks: its rate follows the torque within milliseconds,
// for minutes. The derivatives of such a step solve the same system.
//
//   z_ci − h b_i Σ_k ∂f_c/∂y_k(Y_i) Σ_j μ_ij z_kj = r_ci,     c, k components; i, j stages
//
// Source: E. Hairer, G. Wanner, "Solving Ordinary Differential Equations II", 2nd ed., IV.8.
#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "attitude/model/dynamics.h"

namespace photorque {

// ∂(dy_row/dt)/∂y_column at the eight stages.
struct RateDerivative {
  size_t row, column;
  Lanes value;
};

// The components of the state in blocks for Dynamics::derivatives.
std::vector<Dynamics::Block> state_blocks(const Dynamics& dynamics);

// Workspace for the derivatives of the rates, reused from step to step.
struct RateWorkspace {
  Dynamics::Workspace evaluation;
  std::vector<Lanes> partials;
  std::vector<RateDerivative> jacobian;
};

// Derivatives of the rates at the eight stages, without those that are zero at all of them. The
// result is stored in `room`.
const std::vector<RateDerivative>& rate_derivatives(const Dynamics& dynamics,
                                                    std::span<const Dynamics::Block> blocks,
                                                    const Lanes& times_s, const ZeroOrderHold& held,
                                                    const Lanes* stages, RateWorkspace& room);

// Upper bound on the rate of change of small deviations [1/s]: the largest row sum of |∂f/∂y| with
// each component in units of its scale. One fixed-point iteration with eight stages multiplies the
// error by about a tenth of (step length · this value).
double stiffness_1_s(std::span<const RateDerivative> jacobian, std::span<const double> scales);

class StageSystem {
 public:
  // `components`: number of components of the state. `h_s`: length of the step [s].
  StageSystem(size_t components, double h_s, std::span<const RateDerivative> jacobian);

  // Solves for `count` right-hand sides in place; component c of right-hand side v is x[c · count +
  // v].
  void solve(std::span<Lanes> x, size_t count) const;

 private:
  size_t components_;
  Eigen::PartialPivLU<Eigen::MatrixXd> factors_;
};

// Decides when an iteration ends: it has converged to the required accuracy or to rounding, or it
// has failed. judge() receives the size of one change after the other. Changes may rise once or
// twice even if the iteration converges, so a single rise is no failure.
class Settling {
 public:
  enum class Verdict { go_on, settled, failed };

  // The iteration has converged when the estimated remaining error is below `settled`, or when
  // changes below `rounding` stop falling. It has failed after `max_stalled_changes` changes in a
  // row without a new minimum.
  Settling(double settled, double rounding, int max_stalled_changes = 6)
      : settled_(settled), rounding_(rounding), max_stalled_changes_(max_stalled_changes) {}

  Verdict judge(double change) {
    if (!std::isfinite(change)) return Verdict::failed;
    const double contraction = std::min(change / previous_, 1.0);
    const double left = change * std::max(contraction, before_);
    if (change == 0.0 || left < settled_) return Verdict::settled;
    rises_ = change < best_ ? 0 : rises_ + 1;
    best_ = std::min(best_, change);
    if (rises_ >= 2 && change < rounding_) return Verdict::settled;
    if (rises_ >= max_stalled_changes_) return Verdict::failed;
    before_ = std::isfinite(previous_) ? contraction : 1.0;
    previous_ = change;
    return Verdict::go_on;
  }

 private:
  double settled_, rounding_;
  int max_stalled_changes_;
  double previous_ = std::numeric_limits<double>::infinity();
  double best_ = std::numeric_limits<double>::infinity();
  double before_ = 1.0;  // contraction factor of the previous change
  int rises_ = 0;
};

}  // namespace photorque
